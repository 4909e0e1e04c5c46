#include "vista/line.h"

#include <ctype.h>
#include <math.h>
#include <string.h>

#include "common/frame.h"
#include "link/line/json.h"

/* Digits behind the point: below what the measurements carry. */
#define METRES 3
#define SQUARE_METRES 6
#define PIXELS 2
#define DISPARITY_PX 3
#define DEGREES 1
#define SECONDS 2
#define UNIT 5
#define SHARE 4
#define MILLISECONDS 3

void vista_line_health_add(vista_line_health *found, vista_health_state state, const char *reason) {
  for (int32_t k = 0; k < found->reason_count; ++k)
    if (strcmp(found->reasons[k], reason) == 0) return;
  if (state > found->state) found->state = state;
  if (found->reason_count < VISTA_LINE_REASONS) found->reasons[found->reason_count++] = reason;
}

static void put_key(vista_json *json, const char *name) {
  vista_json_put(json, ", ");
  vista_json_put_name(json, name);
  vista_json_put(json, ": ");
}

static void put_pair(vista_json *json, double first, double second, int digits) {
  vista_json_put_numbers(json, (const double[]){first, second}, 2, digits);
}

/* position_m, position_camera_m, covariance_m2 and distance_m, which obstacles and the nearest collision have alike. */
static void put_place(vista_json *json, const vista_pose *pose, const double position_m[3],
                      const double covariance_m2[9], double distance_m) {
  double position_camera_m[3];
  vista_frame_to_camera(pose, position_m, position_camera_m);
  put_key(json, "position_m");
  vista_json_put_numbers(json, position_m, 3, METRES);
  put_key(json, "position_camera_m");
  vista_json_put_numbers(json, position_camera_m, 3, METRES);
  put_key(json, "covariance_m2");
  for (int row = 0; row < 3; ++row) {
    vista_json_put(json, row == 0 ? "[" : ", ");
    vista_json_put_numbers(json, covariance_m2 + (ptrdiff_t)3 * row, 3, SQUARE_METRES);
  }
  vista_json_put(json, "]");
  put_key(json, "distance_m");
  vista_json_put_number(json, distance_m, METRES);
}

static void put_lower(vista_json *json, const char *name) {
  char lower[32];
  size_t length = 0;
  for (; name[length] != '\0' && length + 1 < sizeof lower; ++length)
    lower[length] = (char)tolower((unsigned char)name[length]);
  lower[length] = '\0';
  vista_json_put_name(json, lower);
}

static void put_obstacle(vista_json *json, const vista_pose *pose, const vista_obstacle *o) {
  vista_json_put(json, "{\"id\": ");
  vista_json_put_integer(json, o->id);
  put_key(json, "confirmed");
  vista_json_put_bool(json, o->confirmed);
  put_key(json, "age_frames");
  vista_json_put_integer(json, o->age_frames);
  put_place(json, pose, o->position_m, o->covariance_m2, o->distance_m);
  put_key(json, "extent_m");
  vista_json_put_numbers(json, o->extent_m, 2, METRES);
  put_key(json, "ellipse_px");
  vista_json_put(json, "{\"center\": ");
  put_pair(json, o->ellipse.center_u_px, o->ellipse.center_v_px, PIXELS);
  put_key(json, "axes");
  put_pair(json, o->ellipse.axis_a_px, o->ellipse.axis_b_px, PIXELS);
  put_key(json, "angle_deg");
  vista_json_put_number(json, o->ellipse.angle_deg, DEGREES);
  vista_json_put(json, "}");
  put_key(json, "disparity_px");
  vista_json_put_number(json, o->disparity_px, DISPARITY_PX);
  put_key(json, "in_collision_volume");
  vista_json_put_bool(json, o->in_collision_volume);
  put_key(json, "coasting");
  vista_json_put_bool(json, o->coasting);
  put_key(json, "world");
  put_lower(json, vista_world_verdict_name(o->world));
  put_key(json, "kind");
  vista_json_put_name(json, vista_obstacle_kind_name(o->kind));
  vista_json_put(json, "}");
}

static void put_health(vista_json *json, const vista_line_health *health) {
  put_key(json, "health");
  vista_json_put(json, "{\"state\": ");
  vista_json_put_name(json, vista_health_state_name(health->state));
  put_key(json, "reasons");
  vista_json_put(json, "[");
  for (int32_t k = 0; k < health->reason_count; ++k) {
    if (k > 0) vista_json_put(json, ", ");
    vista_json_put_name(json, health->reasons[k]);
  }
  vista_json_put(json, "]}");
}

static void put_obstacles(vista_json *json, const vista_pose *pose, const vista_result *result, bool all_tracks) {
  put_key(json, "obstacles");
  vista_json_put(json, "[");
  bool first = true;
  for (int32_t k = 0; k < result->obstacle_count; ++k) {
    const vista_obstacle *const o = vista_result_obstacle(result, k);
    if (!o->confirmed && !all_tracks) continue;
    if (!first) vista_json_put(json, ", ");
    put_obstacle(json, pose, o);
    first = false;
  }
  vista_json_put(json, "]");
}

static void put_nearest(vista_json *json, const vista_pose *pose, const vista_result *result) {
  const vista_nearest_collision *const nearest = &result->nearest_collision;
  put_key(json, "nearest_collision");
  if (!nearest->valid) {
    vista_json_put(json, "null");
    return;
  }
  vista_json_put(json, "{\"id\": ");
  vista_json_put_integer(json, nearest->id);
  put_place(json, pose, nearest->position_m, nearest->covariance_m2, nearest->distance_m);
  put_key(json, "time_to_collision_s");
  vista_json_put_number(json, nearest->time_to_collision_s, SECONDS);
  put_key(json, "probability");
  vista_json_put_number(json, result->collision_probability, SHARE);
  vista_json_put(json, "}");
}

static void put_velocity(vista_json *json, const vista_motion *motion) {
  double velocity_camera_m_s[3];
  put_key(json, "velocity_camera_m_s");
  if (!motion->velocity_known) {
    vista_json_put(json, "null");
    return;
  }
  vista_frame_direction_to_camera(&motion->pose, motion->velocity_m_s, velocity_camera_m_s);
  vista_json_put_numbers(json, velocity_camera_m_s, 3, METRES);
}

static void put_columns(vista_json *json, const char *key, const float *metres, int32_t first, int32_t end) {
  put_key(json, key);
  vista_json_put(json, "[");
  for (int32_t k = first; k < end; ++k) {
    if (k > first) vista_json_put(json, ", ");
    vista_json_put_number(json, (double)metres[k], METRES);
  }
  vista_json_put(json, "]");
}

static bool tells_nothing(const vista_directions *directions, int32_t column) {
  return directions->free_m[column] == 0.0F && directions->blocked_m[column] == 0.0F;
}

/* Writes the directions without the columns at both ends of which nothing is known. */
static void put_directions(vista_json *json, const vista_directions *directions) {
  int32_t first = 0, end = VISTA_DIRECTIONS;
  put_key(json, "directions");
  if (directions == NULL) {
    vista_json_put(json, "null");
    return;
  }
  while (first < end && tells_nothing(directions, first)) ++first;
  while (end > first && tells_nothing(directions, end - 1)) --end;
  if (first == end) first = end = 0;
  vista_json_put(json, "{\"up_camera\": ");
  if (directions->up_known)
    vista_json_put_numbers(json, directions->up_camera, 3, UNIT);
  else
    vista_json_put(json, "null");
  put_key(json, "first_deg");
  vista_json_put_integer(json, VISTA_DIRECTIONS_FIRST_DEG + first);
  put_columns(json, "free_m", directions->free_m, first, end);
  put_columns(json, "blocked_m", directions->blocked_m, first, end);
  vista_json_put(json, "}");
}

vista_status vista_line_write(const vista_result *result, const vista_directions *directions,
                              const vista_line_health *health, int64_t frame, int64_t t_ns, bool all_tracks, char *text,
                              size_t capacity, size_t *length) {
  if (result == NULL || health == NULL || text == NULL || length == NULL) return VISTA_ERROR_ARGUMENT;
  if (capacity == 0) return VISTA_ERROR_MEMORY;
  vista_json json = {text, capacity, 0, false};
  const vista_pose *const pose =
      result->motion.source == VISTA_MOTION_UNTOLD ? &vista_frame_still : &result->motion.pose;
  vista_json_put(&json, "{\"version\": ");
  vista_json_put_integer(&json, VISTA_LINE_VERSION);
  put_key(&json, "frame");
  vista_json_put_integer(&json, frame);
  put_key(&json, "t_ns");
  vista_json_put_integer(&json, t_ns);
  put_key(&json, "processing_ms");
  vista_json_put_number(&json, result->host_ms, MILLISECONDS);
  put_key(&json, "regions");
  vista_json_put_integer(&json, result->region_count);
  put_key(&json, "valid_fraction");
  vista_json_put_number(&json, result->valid_fraction, SHARE);
  put_key(&json, "motion");
  vista_json_put_name(&json, result->motion.known ? "known" : "unknown");
  put_health(&json, health);
  put_obstacles(&json, pose, result, all_tracks);
  put_nearest(&json, pose, result);
  put_key(&json, "path_seen_m");
  vista_json_put_number(&json, result->path_seen_m, METRES);
  put_velocity(&json, &result->motion);
  put_directions(&json, directions);
  vista_json_put(&json, "}\n");
  *length = json.length;
  return json.full ? VISTA_ERROR_MEMORY : VISTA_OK;
}
