#include <math.h>
#include <string.h>

#include "common/frame.h"
#include "common/parameters_check.h"
#include "link/mavlink/messages.h"
#include "link/mavlink/sectors.h"
#include "vista/mavlink.h"

#define MS 1000000LL
#define SECOND (1000 * MS)
#define REPEAT_NS (80 * MS)  /* the same again, without a new frame: 10 Hz with time to spare */
#define LEAST_NS (30 * MS)   /* between distances: a frame that comes sooner waits, or gives way to the next */
#define SETPOINT_NS (50 * MS)
#define HELD_NS (2 * SECOND) /* after the end of a plan without a further decision */
#define TEXT_AGAIN_NS (10 * SECOND)
#define TEXT_LEAST_NS SECOND

vista_status vista_mavlink_start(vista_mavlink *link, const vista_mavlink_params *params) {
  if (link == NULL || params == NULL) return VISTA_ERROR_ARGUMENT;
  const vista_status status = VISTA_CHECK_SECTION(mavlink, params);
  if (status != VISTA_OK) return status;
  if (fmod(params->angle_offset_deg, vista_mavlink_sector_deg(params)) != 0.0) return VISTA_ERROR_RANGE;
  *link = (vista_mavlink){.params = *params};
  vista_mavlink_mount(params, link->body_from_camera);
  return VISTA_OK;
}

static void keep_reason(const char *reason, vista_mavlink_state *state) {
  const size_t length = reason != NULL ? strlen(reason) : 0, most = sizeof state->reason - 1;
  memset(state->reason, 0, sizeof state->reason);
  if (length > 0) memcpy(state->reason, reason, length < most ? length : most);
}

vista_status vista_mavlink_update(vista_mavlink *link, const vista_mavlink_frame *frame) {
  if (link == NULL || frame == NULL || (frame->obstacles == NULL && frame->obstacle_count > 0))
    return VISTA_ERROR_ARGUMENT;
  if (frame->t_ns < 0 || frame->obstacle_count < 0 || (int)frame->health < 0 ||
      frame->health >= VISTA_HEALTH_STATE_COUNT)
    return VISTA_ERROR_RANGE;
  if (link->has_frame && frame->t_ns <= link->state.t_ns) return VISTA_ERROR_ORDER;
  vista_mavlink_state *const s = &link->state;
  s->t_ns = frame->t_ns;
  s->health = frame->health;
  keep_reason(frame->reason, s);
  if (!vista_mavlink_place(link, frame) && s->health == VISTA_HEALTH_HEALTHY) {
    s->health = VISTA_HEALTH_DEGRADED;
    keep_reason("a number is not finite", s);
  }
  if (link->burst_next < link->burst_count) link->sent_any = false; /* the rest of it is gone: the new frame at once */
  link->burst_next = link->burst_count = 0;
  link->has_frame = link->fresh = true;
  link->collision_due = s->collision.valid && s->collision.time_s > 0.0;
  return VISTA_OK;
}

vista_status vista_mavlink_fly(vista_mavlink *link, const vista_plan_decision *decision, int64_t state_ns) {
  if (link == NULL) return VISTA_ERROR_ARGUMENT;
  if (state_ns < 0 || (decision != NULL && (unsigned)decision->action >= VISTA_PLAN_ACTION_COUNT))
    return VISTA_ERROR_RANGE;
  link->flies = decision != NULL;
  if (decision == NULL) return VISTA_OK;
  link->plan = *decision;
  link->plan_ns = state_ns;
  return VISTA_OK;
}

/* For so long after the last decision there are setpoints: a stop is held a while, a circle once. */
static int64_t plan_lasts_ns(const vista_plan_decision *plan) {
  return (int64_t)(1e9 * plan->step_s * (plan->point_count - 1)) + HELD_NS;
}

static bool setpoint_is_due(const vista_mavlink *link) {
  return link->flies && link->now_ns - link->setpoint_ns >= SETPOINT_NS &&
         link->now_ns - link->plan_ns <= plan_lasts_ns(&link->plan);
}

/* To evade is to fly: nobody is told of each bend. */
static vista_plan_action told_of(vista_plan_action action) {
  return action == VISTA_PLAN_EVADES ? VISTA_PLAN_PROCEEDS : action;
}

static bool plan_text_is_due(const vista_mavlink *link) {
  if (!link->flies || (link->plan_told && link->now_ns - link->plan_text_ns < TEXT_LEAST_NS)) return false;
  return !link->plan_told || told_of(link->plan.action) != link->action_told;
}

static vista_mavlink_condition condition_of(const vista_mavlink *link) {
  static const vista_mavlink_condition of_health[] = {[VISTA_HEALTH_HEALTHY] = CONDITION_HEALTHY,
                                                      [VISTA_HEALTH_DEGRADED] = CONDITION_DEGRADED,
                                                      [VISTA_HEALTH_BLIND] = CONDITION_BLIND};
  if (!link->has_frame) return CONDITION_NONE;
  if ((double)link->now_ns - (double)link->state.t_ns > 1e9 * link->params.stale_s) return CONDITION_LOST;
  return of_health[link->state.health];
}

/* All points of a frame in a row: ArduPilot takes those with one time_boot_ms, and within 50 ms, for one view. */
static int32_t begin_points(vista_mavlink *link, uint8_t *bytes) {
  const uint32_t boot_ms = (uint32_t)((uint64_t)link->state.t_ns / (uint64_t)MS);
  const bool later = !link->pointed || (int32_t)(boot_ms - link->boot_ms) > 0; /* it comes round after 49 days */
  if (link->fresh) link->boot_ms = later ? boot_ms : link->boot_ms + 1;
  link->pointed = true;
  link->burst_next = 1;
  link->burst_count = link->state.point_count;
  return vista_mavlink_write_point(link, 0, bytes);
}

static int32_t write_distances(vista_mavlink *link, vista_mavlink_condition condition, uint8_t *bytes) {
  const bool counts = condition == CONDITION_HEALTHY || condition == CONDITION_DEGRADED;
  const bool held = condition == CONDITION_BLIND && link->state.point_count > 0; /* tracks that are carried on */
  int32_t count = 0;
  if (link->params.autopilot == VISTA_MAVLINK_AUTOPILOT_PX4)
    count = vista_mavlink_write_sectors(link, counts, bytes);
  else if (counts || held)
    count = begin_points(link, bytes);
  link->sent_ns = link->now_ns;
  link->sent_any = true;
  link->fresh = false;
  return count;
}

static bool text_is_due(const vista_mavlink *link, vista_mavlink_condition condition) {
  const int64_t passed_ns = link->now_ns - link->text_ns;
  if (!link->told) return true;
  if (condition != (vista_mavlink_condition)link->condition_told) return passed_ns >= TEXT_LEAST_NS;
  return condition != CONDITION_HEALTHY && passed_ns >= TEXT_AGAIN_NS;
}

static int32_t write_next(vista_mavlink *link, uint8_t *bytes) {
  const vista_mavlink_condition condition = condition_of(link);
  if (setpoint_is_due(link)) {
    link->setpoint_ns = link->now_ns;
    return vista_mavlink_write_setpoint(link, bytes);
  }
  if (link->burst_next < link->burst_count) return vista_mavlink_write_point(link, link->burst_next++, bytes);
  const int64_t passed_ns = link->now_ns - link->sent_ns;
  if (!link->sent_any || passed_ns >= (link->fresh ? LEAST_NS : REPEAT_NS)) {
    const int32_t count = write_distances(link, condition, bytes);
    if (count > 0) return count;
  }
  if (link->collision_due) {
    link->collision_due = false;
    if (condition != CONDITION_LOST) return vista_mavlink_write_collision(link, bytes);
  }
  if (!link->alive || link->now_ns - link->heartbeat_ns >= SECOND) {
    link->alive = true;
    link->heartbeat_ns = link->now_ns;
    return vista_mavlink_write_heartbeat(link, condition, bytes);
  }
  if (plan_text_is_due(link)) {
    link->plan_told = true;
    link->plan_text_ns = link->now_ns;
    link->action_told = told_of(link->plan.action);
    return vista_mavlink_write_plan_text(link, bytes);
  }
  if (!text_is_due(link, condition)) return 0;
  link->told = true;
  link->text_ns = link->now_ns;
  link->condition_told = (int32_t)condition;
  return vista_mavlink_write_text(link, condition, bytes);
}

vista_status vista_mavlink_next(vista_mavlink *link, int64_t now_ns, uint8_t *bytes, int32_t capacity, int32_t *count) {
  if (link == NULL || bytes == NULL || count == NULL) return VISTA_ERROR_ARGUMENT;
  if (capacity < VISTA_MAVLINK_BYTES) return VISTA_ERROR_MEMORY;
  if (now_ns < link->now_ns) return VISTA_ERROR_ORDER;
  link->now_ns = now_ns;
  *count = write_next(link, bytes);
  return VISTA_OK;
}

vista_status vista_mavlink_frame_of(const vista_result *result, const vista_directions *directions, int64_t t_ns,
                                    vista_mavlink_obstacle *obstacles, int32_t capacity, vista_mavlink_frame *frame) {
  if (result == NULL || directions == NULL || frame == NULL || (obstacles == NULL && capacity > 0))
    return VISTA_ERROR_ARGUMENT;
  *frame = (vista_mavlink_frame){.t_ns = t_ns, .health = result->health.state, .obstacles = obstacles};
  frame->directions = *directions;
  for (uint32_t k = 0; k < VISTA_HEALTH_REASON_COUNT && frame->reason == NULL; ++k)
    if (result->health.reasons >> k & 1) frame->reason = vista_health_reason_name((vista_health_reason)k);
  for (int32_t k = 0; k < result->obstacle_count && frame->obstacle_count < capacity; ++k) {
    const vista_obstacle *const o = vista_result_obstacle(result, k);
    if (!o->confirmed) continue;
    vista_mavlink_obstacle *const to = &obstacles[frame->obstacle_count++];
    *to = (vista_mavlink_obstacle){.id = o->id, .width_m = o->extent_m[0], .height_m = o->extent_m[1]};
    vista_frame_to_camera(&result->motion.pose, o->position_m, to->position_camera_m);
  }
  const vista_nearest_collision *const n = &result->nearest_collision;
  vista_mavlink_collision *const c = &frame->collision;
  *c = (vista_mavlink_collision){.valid = n->valid, .id = n->id, .time_s = n->time_to_collision_s};
  vista_frame_to_camera(&result->motion.pose, n->position_m, c->position_camera_m);
  if (result->motion.velocity_known)
    vista_frame_direction_to_camera(&result->motion.pose, result->motion.velocity_m_s, c->velocity_camera_m_s);
  return VISTA_OK;
}
