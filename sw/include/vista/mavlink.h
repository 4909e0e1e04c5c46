/* What the autopilot is told, as MAVLink 2 messages: where obstacles are, where it is clear, and how far to trust that.
 *
 *   vista_parameters parameters = vista_parameters_default();
 *   vista_mavlink link;
 *   vista_mavlink_start(&link, &parameters.mavlink);
 *   for each frame:
 *     vista_mavlink_update(&link, &frame);
 *   every 10 ms:
 *     while (vista_mavlink_next(&link, now_ns, bytes, sizeof bytes, &count) == VISTA_OK && count > 0)
 *       send bytes[0 .. count - 1];
 *
 * The body frame is FRD: x forward, y to the right, z down. Sectors are level and turn with the heading; that number k
 * is a 72nd or a 36th of the circle wide, its middle angle_offset_deg + k * width to the right of forward. A sector holds
 * the distance of the nearest obstacle that reaches into it, within half_height_m of the camera's height; else it is
 * clear (max + 1) where the camera saw so up to max_distance_m in all of it, in a healthy frame; else unknown.
 *
 * PX4 is sent OBSTACLE_DISTANCE, and is told that all is unknown when the frame is blind or none came for stale_s.
 * ArduPilot is sent OBSTACLE_DISTANCE_3D; it has no word for unknown, and takes silence for it, so distances cease
 * then, except that a blind frame's obstacles are sent on: tracks that are held. Both are sent HEARTBEAT, COLLISION and
 * STATUSTEXT. doc/autopilot.md says more.
 *
 * With a planner, vista_mavlink_fly hands over each decision. Its trajectory is sent 20 times a second as
 * SET_POSITION_TARGET_LOCAL_NED, whose world has to be NED (vista/vehicle.h); an autopilot flies it in the modes OFFBOARD
 * (PX4) and GUIDED (ArduPilot), and does nothing with it in others. Without a further decision the trajectory is sent on
 * to its end, and its stop for a while; then setpoints cease, and the autopilot does what it is set up to do without. */
#ifndef VISTA_MAVLINK_H
#define VISTA_MAVLINK_H

#include <stdbool.h>
#include <stdint.h>

#include "vista/api.h"
#include "vista/directions.h"
#include "vista/obstacle.h"
#include "vista/parameters.h"
#include "vista/pipeline.h"
#include "vista/plan.h"
#include "vista/status.h"

VISTA_BEGIN

#define VISTA_MAVLINK_MOST_SECTORS 72
#define VISTA_MAVLINK_POINTS 32 /* of OBSTACLE_DISTANCE_3D in a frame */
#define VISTA_MAVLINK_BYTES 280 /* the longest frame of MAVLink 2 */
#define VISTA_MAVLINK_UNKNOWN 65535 /* in a sector; max_distance + 1 is clear */

/* An obstacle as the camera sees it: an upright board that faces the camera. */
typedef struct vista_mavlink_obstacle {
  int32_t id; /* as in vista_obstacle; VISTA_ID_TOO_NEAR is reported at min_distance_m */
  double position_camera_m[3]; /* of the middle */
  double width_m, height_m;
} vista_mavlink_obstacle;

/* The collision that is nearest. Its point counts as an obstacle, too: of a wall that is seen at an angle it is nearer
 * than the middle. */
typedef struct vista_mavlink_collision {
  bool valid;
  int32_t id;
  double position_camera_m[3]; /* the point that is met */
  double velocity_camera_m_s[3]; /* of the camera; zeros: not known */
  double time_s; /* to the collision, from the time of the frame; not above 0: not known */
} vista_mavlink_collision;

/* What one frame found. */
typedef struct vista_mavlink_frame {
  int64_t t_ns; /* of the exposure, on the clock of vista_mavlink_next */
  vista_health_state health;
  const char *reason; /* in a word, for the pilot; null: none */
  const vista_mavlink_obstacle *obstacles; /* confirmed ones, nearest first */
  int32_t obstacle_count;
  vista_directions directions;
  vista_mavlink_collision collision;
} vista_mavlink_frame;

/* What was taken over from a frame. */
typedef struct vista_mavlink_state {
  int64_t t_ns;
  vista_health_state health;
  char reason[32];
  uint16_t distance_cm[VISTA_MAVLINK_MOST_SECTORS];
  int32_t point_count;
  double points_body_m[VISTA_MAVLINK_POINTS][3];
  int32_t point_ids[VISTA_MAVLINK_POINTS];
  vista_mavlink_collision collision;
  double miss_horizontal_m, miss_vertical_m; /* of the collision, where it comes nearest */
} vista_mavlink_state;

/* A link to one autopilot, in memory of the caller. Its members are the library's own. */
typedef struct vista_mavlink {
  vista_mavlink_params params;
  double body_from_camera[9]; /* rotation, row-major */
  vista_mavlink_state state;
  bool has_frame, fresh, collision_due, sent_any, alive, told, pointed;
  uint8_t sequence;
  int64_t now_ns, sent_ns, heartbeat_ns, text_ns;
  int32_t burst_next, burst_count, condition_told;
  uint32_t boot_ms; /* of the frame that was last sent to ArduPilot */
  bool flies, plan_told; /* there is a plan; the pilot was told of its action */
  int64_t plan_ns, setpoint_ns, plan_text_ns; /* the time of its state; of the last setpoint, and text about it */
  vista_plan_action action_told;
  vista_plan_decision plan;
} vista_mavlink;

/* Begins a link. VISTA_ERROR_RANGE: a parameter, or angle_offset_deg is no multiple of a sector. */
VISTA_API vista_status vista_mavlink_start(vista_mavlink *link, const vista_mavlink_params *params);

/* Takes over what a frame found, and keeps no pointer into it. Obstacles with a number that is not finite are left out,
 * and the frame counts as degraded. VISTA_ERROR_ORDER: the time is not after that of the frame before;
 * VISTA_ERROR_RANGE: a negative time or count, or a health state that there is not. */
VISTA_API vista_status vista_mavlink_update(vista_mavlink *link, const vista_mavlink_frame *frame);

/* Writes the next message that is due, or none: *count is 0 then. Called until that, at least every 20 ms, it gives
 * distances at least 10 times a second. VISTA_ERROR_MEMORY: fewer than VISTA_MAVLINK_BYTES; VISTA_ERROR_ORDER: the
 * clock went back, or is below 0. */
VISTA_API vista_status vista_mavlink_next(vista_mavlink *link, int64_t now_ns, uint8_t *bytes, int32_t capacity,
                                          int32_t *count);

/* Takes over a decision, whose state was that of this time on the clock of vista_mavlink_next; null: setpoints cease.
 * VISTA_ERROR_RANGE: a negative time. */
VISTA_API vista_status vista_mavlink_fly(vista_mavlink *link, const vista_plan_decision *decision, int64_t state_ns);

/* Makes a frame of a result of the pipeline: its confirmed obstacles, of which `capacity` have room in `obstacles`,
 * nearest first. t_ns: see vista_mavlink_frame. */
VISTA_API vista_status vista_mavlink_frame_of(const vista_result *result, const vista_directions *directions,
                                              int64_t t_ns, vista_mavlink_obstacle *obstacles, int32_t capacity,
                                              vista_mavlink_frame *frame);

VISTA_END

#endif
