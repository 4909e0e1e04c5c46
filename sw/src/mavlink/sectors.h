/* Where obstacles are, seen from the aircraft: in level sectors around it, and as points of the body frame. */
#ifndef VISTA_SRC_MAVLINK_SECTORS_H
#define VISTA_SRC_MAVLINK_SECTORS_H

#include "vista/mavlink.h"

/* Fills distances, points, and how far the collision misses by, of the state, from a frame. Returns whether every
 * number of it was finite; what was not is left out. */
bool vista_mavlink_place(const vista_mavlink_config *config, const vista_mavlink_frame *frame,
                         vista_mavlink_state *state);

#endif
