/* The messages of a link, each written as a whole frame. They return its length. */
#ifndef VISTA_SRC_MAVLINK_MESSAGES_H
#define VISTA_SRC_MAVLINK_MESSAGES_H

#include "vista/mavlink.h"

/* What the pilot is told of: the health of the last frame, or that there is none. */
typedef enum vista_mavlink_condition {
  CONDITION_NONE = 0, /* no frame so far */
  CONDITION_HEALTHY,
  CONDITION_DEGRADED,
  CONDITION_BLIND,
  CONDITION_LOST /* no frame for stale_s */
} vista_mavlink_condition;

int32_t vista_mavlink_write_heartbeat(vista_mavlink *link, vista_mavlink_condition condition, uint8_t *bytes);
int32_t vista_mavlink_write_text(vista_mavlink *link, vista_mavlink_condition condition, uint8_t *bytes);
int32_t vista_mavlink_write_collision(vista_mavlink *link, uint8_t *bytes);

/* All unknown unless the frame counts. */
int32_t vista_mavlink_write_sectors(vista_mavlink *link, bool counts, uint8_t *bytes);

/* One of the points; number point_count, of a frame without points, is beyond max_distance_m: nothing there. */
int32_t vista_mavlink_write_point(vista_mavlink *link, int32_t number, uint8_t *bytes);

/* What is flown now of the plan; and what the pilot is told of it. */
int32_t vista_mavlink_write_setpoint(vista_mavlink *link, uint8_t *bytes);
int32_t vista_mavlink_write_plan_text(vista_mavlink *link, uint8_t *bytes);

#endif
