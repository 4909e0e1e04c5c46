/* Places of obstacles, seen from the aircraft: in level sectors around it, and as points of the body frame. */
#ifndef VISTA_SRC_MAVLINK_SECTORS_H
#define VISTA_SRC_MAVLINK_SECTORS_H

#include <math.h>

#include "vista/mavlink.h"

/* The camera's rotation in the body, from its mount. */
void vista_mavlink_mount(const vista_mavlink_params *params, double body_from_camera[9]);

static inline int32_t vista_mavlink_sector_count(const vista_mavlink_params *params) {
  return params->sectors == VISTA_MAVLINK_SECTORS_36 ? 36 : 72;
}

static inline double vista_mavlink_sector_deg(const vista_mavlink_params *params) {
  return 360.0 / vista_mavlink_sector_count(params);
}

/* A sector that holds one more is clear. */
static inline uint16_t vista_mavlink_max_cm(const vista_mavlink_params *params) {
  return (uint16_t)lround(100.0 * params->max_distance_m);
}

/* Fills distances, points, and how far the collision misses by, of the link's state, from a frame. Returns whether
 * every number of it was finite; what was not is left out, and nothing is clear then. */
bool vista_mavlink_place(vista_mavlink *link, const vista_mavlink_frame *frame);

#endif
