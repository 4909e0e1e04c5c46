/* A link with any parameters, frames and clocks: no error of memory or arithmetic, and every message is a whole frame of
 * MAVLink 2 with distances that mean something. */
#include <math.h>
#include <stdbool.h>
#include <stdint.h>

#include "input.h"
#include "vista/vista.h"

#define OBSTACLES_MAX 40
#define STEPS_MAX 12
#define MESSAGES_MAX (VISTA_MAVLINK_POINTS + 5) /* at one time: points, sectors, collision, heartbeat, text */

static double number(fuzz_input *input) {
  return fuzz_byte(input) % 8 == 0 ? fuzz_double(input) : fuzz_between(input, -32768, 32767) / 256.0;
}

static vista_mavlink_params read_params(fuzz_input *input) {
  vista_parameters parameters = vista_parameters_default();
  for (int32_t k = 0; k < vista_parameter_count() && fuzz_byte(input) % 2 == 0; ++k) {
    static const char *const names[] = {"autopilot",      "mount_roll_deg", "mount_pitch_deg",  "mount_yaw_deg",
                                        "min_distance_m", "max_distance_m", "half_height_m",    "sectors",
                                        "stale_s",        "system_id",      "angle_offset_deg", "component_id"};
    char name[40] = "mavlink.";
    const char *const chosen = names[fuzz_byte(input) % (sizeof names / sizeof names[0])];
    memcpy(name + strlen(name), chosen, strlen(chosen) + 1);
    (void)vista_parameters_set(&parameters, name, number(input));
  }
  if (fuzz_byte(input) % 16 == 0) fuzz_take(input, &parameters.mavlink, sizeof parameters.mavlink);
  return parameters.mavlink;
}

static void update(fuzz_input *input, vista_mavlink *link, int64_t t_ns) {
  vista_mavlink_obstacle obstacles[OBSTACLES_MAX];
  const char reason[] = "no_contrast, and so on and on, longer than there is room";
  vista_mavlink_frame frame = {.t_ns = t_ns,
                               .health = (vista_health_state)(fuzz_byte(input) % 4),
                               .reason = fuzz_byte(input) % 4 == 0 ? NULL : reason + fuzz_byte(input) % 50,
                               .obstacles = obstacles,
                               .obstacle_count = fuzz_byte(input) % OBSTACLES_MAX};
  for (int32_t k = 0; k < frame.obstacle_count; ++k) {
    vista_mavlink_obstacle *const o = &obstacles[k];
    *o = (vista_mavlink_obstacle){.id = fuzz_int32(input), .width_m = number(input), .height_m = number(input)};
    for (int i = 0; i < 3; ++i) o->position_camera_m[i] = number(input);
  }
  frame.directions.up_known = fuzz_byte(input) % 2;
  frame.directions.up_camera[fuzz_byte(input) % 3] = fuzz_byte(input) % 4 == 0 ? number(input) : -1.0;
  const uint8_t free_from = fuzz_byte(input) % VISTA_DIRECTIONS;
  for (int k = free_from; k < VISTA_DIRECTIONS; ++k) frame.directions.free_m[k] = 655.0f;
  frame.directions.free_m[free_from] = (float)number(input);
  for (int k = fuzz_byte(input) % VISTA_DIRECTIONS; k < VISTA_DIRECTIONS; k += 1 + fuzz_byte(input) % 8)
    frame.directions.blocked_m[k] = (float)number(input);
  frame.collision.valid = fuzz_byte(input) % 2;
  frame.collision.time_s = number(input);
  for (int i = 0; i < 3; ++i) {
    frame.collision.position_camera_m[i] = number(input);
    frame.collision.velocity_camera_m_s[i] = number(input);
  }
  (void)vista_mavlink_update(link, &frame);
}

static void check(const vista_mavlink *link, const uint8_t *bytes, int32_t count) {
  if (count < 13 || count > VISTA_MAVLINK_BYTES || bytes[0] != 0xFD || bytes[1] + 12 != count) abort();
  const uint32_t id = bytes[7] | (uint32_t)bytes[8] << 8 | (uint32_t)bytes[9] << 16;
  if (id != 330) return; /* OBSTACLE_DISTANCE: distances follow the time */
  const long most = lround(100.0 * link->params.max_distance_m);
  for (int k = 0; k < VISTA_MAVLINK_MOST_SECTORS; ++k) {
    const long cm = bytes[18 + 2 * k] | bytes[19 + 2 * k] << 8;
    if (cm != VISTA_MAVLINK_UNKNOWN && (cm < 1 || cm > most + 1)) abort();
  }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  fuzz_input input = {data, size};
  const vista_mavlink_params params = read_params(&input);
  vista_mavlink link;
  if (vista_mavlink_start(&link, &params) != VISTA_OK) return 0;
  int64_t now_ns = 0;
  for (int step = 0; step < STEPS_MAX && input.size > 0; ++step) {
    int64_t passed_ns = fuzz_between(&input, 0, 60000) * INT64_C(20000);
    if (fuzz_byte(&input) % 16 == 0) fuzz_take(&input, &passed_ns, sizeof passed_ns);
    now_ns = (int64_t)((uint64_t)now_ns + (uint64_t)passed_ns);
    if (fuzz_byte(&input) % 4 != 0) update(&input, &link, now_ns);
    uint8_t *const bytes = fuzz_allocate(VISTA_MAVLINK_BYTES);
    int32_t count = 1;
    for (int k = 0; count > 0; ++k) {
      if (vista_mavlink_next(&link, now_ns, bytes, VISTA_MAVLINK_BYTES, &count) != VISTA_OK) break;
      if (k > MESSAGES_MAX) abort();
      if (count > 0) check(&link, bytes, count);
    }
    free(bytes);
  }
  return 0;
}
