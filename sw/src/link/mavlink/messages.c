#include "link/mavlink/messages.h"

#include <math.h>
#include <string.h>

#include "link/mavlink/frame.h"
#include "link/mavlink/sectors.h"
#include "link/mavlink/wire.h"

#define HIGH_THREAT_S 5.0
#define ID_UNKNOWN 65535

/* Packs and closes a message of the dialect. */
#define WRITE(link, NAME, name, message, bytes)                    \
  (wire_##name##_pack(&(message), (bytes) + VISTA_MAVLINK_HEADER), \
   close(link, WIRE_##NAME##_ID, WIRE_##NAME##_CRC_EXTRA, WIRE_##NAME##_BYTES, bytes))

_Static_assert(VISTA_MAVLINK_HEADER + WIRE_PAYLOAD_MAX + 2 <= VISTA_MAVLINK_BYTES, "the longest message has room");

static int32_t close(vista_mavlink *link, uint32_t id, uint8_t crc_extra, int32_t payload_bytes, uint8_t *bytes) {
  const vista_mavlink_sender sender = {(uint8_t)link->params.system_id, (uint8_t)link->params.component_id,
                                       link->sequence++};
  return vista_mavlink_close(&sender, id, crc_extra, payload_bytes, bytes);
}

int32_t vista_mavlink_write_heartbeat(vista_mavlink *link, vista_mavlink_condition condition, uint8_t *bytes) {
  const bool works = condition == CONDITION_HEALTHY || condition == CONDITION_DEGRADED;
  const wire_heartbeat message = {
      .type = MAV_TYPE_ONBOARD_CONTROLLER,
      .autopilot = MAV_AUTOPILOT_INVALID,
      .system_status = condition == CONDITION_NONE ? MAV_STATE_BOOT
                       : works                     ? MAV_STATE_ACTIVE
                                                   : MAV_STATE_CRITICAL,
      .mavlink_version = 3,
  };
  return WRITE(link, HEARTBEAT, heartbeat, message, bytes);
}

static void append(char *text, size_t room, const char *more) {
  const size_t used = strlen(text), left = room - used, wanted = strlen(more);
  memcpy(text + used, more, wanted < left ? wanted : left);
}

int32_t vista_mavlink_write_text(vista_mavlink *link, vista_mavlink_condition condition, uint8_t *bytes) {
  static const char *const words[] = {[CONDITION_NONE] = "VISTA waits for frames",
                                      [CONDITION_HEALTHY] = "VISTA healthy",
                                      [CONDITION_DEGRADED] = "VISTA degraded",
                                      [CONDITION_BLIND] = "VISTA blind",
                                      [CONDITION_LOST] = "VISTA lost: no frames"};
  wire_statustext message = {.severity = condition == CONDITION_DEGRADED ? MAV_SEVERITY_WARNING
                                         : condition >= CONDITION_BLIND  ? MAV_SEVERITY_ERROR
                                                                         : MAV_SEVERITY_INFO};
  char text[sizeof message.text + 1] = {0};
  append(text, sizeof message.text, words[condition]);
  const bool explains = condition == CONDITION_DEGRADED || condition == CONDITION_BLIND;
  if (explains && link->state.reason[0] != '\0') {
    append(text, sizeof message.text, ": ");
    append(text, sizeof message.text, link->state.reason);
  }
  memcpy(message.text, text, sizeof message.text);
  return WRITE(link, STATUSTEXT, statustext, message, bytes);
}

/* Shortens an id: where one of 32 bits has no room, it comes round; 0 stays, and what has no track otherwise has no number. */
static uint16_t short_id(int32_t id) {
  return id < 0 ? ID_UNKNOWN : id == 0 ? 0 : (uint16_t)(1 + (id - 1) % (ID_UNKNOWN - 1));
}

int32_t vista_mavlink_write_collision(vista_mavlink *link, uint8_t *bytes) {
  const vista_mavlink_state *const s = &link->state;
  const double time_s = fmax(s->collision.time_s - 1e-9 * ((double)link->now_ns - (double)s->t_ns), 0.0);
  const wire_collision message = {
      .src = MAV_COLLISION_SRC_MAVLINK_GPS_GLOBAL_INT, /* not an aircraft that reports itself */
      .id = short_id(s->collision.id),
      .action = MAV_COLLISION_ACTION_REPORT,
      .threat_level = time_s < HIGH_THREAT_S ? MAV_COLLISION_THREAT_LEVEL_HIGH : MAV_COLLISION_THREAT_LEVEL_LOW,
      .time_to_minimum_delta = (float)time_s,
      .altitude_minimum_delta = (float)s->miss_vertical_m,
      .horizontal_minimum_delta = (float)s->miss_horizontal_m,
  };
  return WRITE(link, COLLISION, collision, message, bytes);
}

int32_t vista_mavlink_write_sectors(vista_mavlink *link, bool counts, uint8_t *bytes) {
  const vista_mavlink_params *const c = &link->params;
  wire_obstacle_distance message = {
      .time_usec = (uint64_t)((counts ? link->state.t_ns : link->now_ns) / 1000),
      .sensor_type = MAV_DISTANCE_SENSOR_UNKNOWN,
      .increment = (uint8_t)lround(vista_mavlink_sector_deg(c)),
      .min_distance = (uint16_t)lround(100.0 * c->min_distance_m),
      .max_distance = vista_mavlink_max_cm(c),
      .angle_offset = (float)c->angle_offset_deg,
      .frame = MAV_FRAME_BODY_FRD,
  };
  for (int k = 0; k < VISTA_MAVLINK_MOST_SECTORS; ++k)
    message.distances[k] = counts ? link->state.distance_cm[k] : VISTA_MAVLINK_UNKNOWN;
  return WRITE(link, OBSTACLE_DISTANCE, obstacle_distance, message, bytes);
}

int32_t vista_mavlink_write_point(vista_mavlink *link, int32_t number, uint8_t *bytes) {
  const vista_mavlink_state *const s = &link->state;
  const bool nothing = number >= s->point_count;
  const double beyond_m[3] = {link->params.max_distance_m + 1.0, 0.0, 0.0};
  const double *const point_m = nothing ? beyond_m : s->points_body_m[number];
  const wire_obstacle_distance_3d message = {
      .time_boot_ms = link->boot_ms,
      .sensor_type = MAV_DISTANCE_SENSOR_UNKNOWN,
      .frame = MAV_FRAME_BODY_FRD,
      .obstacle_id = nothing ? ID_UNKNOWN : short_id(s->point_ids[number]),
      .x = (float)point_m[0],
      .y = (float)point_m[1],
      .z = (float)point_m[2],
      .min_distance = (float)(0.99 * link->params.min_distance_m), /* a point at it is not below it, rounded */
      .max_distance = (float)link->params.max_distance_m,
  };
  return WRITE(link, OBSTACLE_DISTANCE_3D, obstacle_distance_3d, message, bytes);
}

int32_t vista_mavlink_write_setpoint(vista_mavlink *link, uint8_t *bytes) {
  vista_plan_setpoint s;
  vista_plan_at(&link->plan, 1e-9 * (double)(link->now_ns - link->plan_ns), &s);
  const wire_set_position_target_local_ned message = {
      .time_boot_ms = (uint32_t)((uint64_t)link->now_ns / 1000000u),
      .target_system = (uint8_t)link->params.system_id,
      .target_component = MAV_COMP_ID_AUTOPILOT1,
      .coordinate_frame = MAV_FRAME_LOCAL_NED,
      .type_mask = 0, /* all of it counts */
      .x = (float)s.position_m[0],
      .y = (float)s.position_m[1],
      .z = (float)s.position_m[2],
      .vx = (float)s.velocity_m_s[0],
      .vy = (float)s.velocity_m_s[1],
      .vz = (float)s.velocity_m_s[2],
      .afx = (float)s.acceleration_m_s2[0],
      .afy = (float)s.acceleration_m_s2[1],
      .afz = (float)s.acceleration_m_s2[2],
      .yaw = (float)atan2(s.heading[1], s.heading[0]),
      .yaw_rate = (float)-s.yaw_rate_rad_s, /* to the right */
  };
  return WRITE(link, SET_POSITION_TARGET_LOCAL_NED, set_position_target_local_ned, message, bytes);
}

int32_t vista_mavlink_write_plan_text(vista_mavlink *link, uint8_t *bytes) {
  static const struct {
    const char *text;
    uint8_t severity;
  } words[VISTA_PLAN_ACTION_COUNT] = {
      [VISTA_PLAN_PROCEEDS] = {"VISTA flies", MAV_SEVERITY_INFO},
      [VISTA_PLAN_EVADES] = {"VISTA flies", MAV_SEVERITY_INFO},
      [VISTA_PLAN_ESCAPES] = {"VISTA ends its way: none is free", MAV_SEVERITY_WARNING},
      [VISTA_PLAN_HOLDS] = {"VISTA holds: no way is free", MAV_SEVERITY_WARNING},
      [VISTA_PLAN_ARRIVED] = {"VISTA has arrived", MAV_SEVERITY_INFO},
      [VISTA_PLAN_HELPLESS] = {"VISTA has no safe way", MAV_SEVERITY_CRITICAL},
  };
  wire_statustext message = {.severity = words[link->plan.action].severity};
  append(message.text, sizeof message.text, words[link->plan.action].text);
  return WRITE(link, STATUSTEXT, statustext, message, bytes);
}
