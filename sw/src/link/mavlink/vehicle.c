#include "vista/vehicle.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "common/parameters_check.h"
#include "link/mavlink/receive.h"
#include "link/mavlink/sectors.h"
#include "link/mavlink/wire.h"

#define MS 1000000LL
#define SECOND (1000 * MS)
#define DRIFT_PPM 200 /* of one clock against the other, at most */
#define LEAP_NS SECOND /* a message that seems to have taken longer came from another clock */
#define GAP_NS (SECOND / 2)
#define BEYOND_NS (SECOND / 5)
#define UNIT_TOLERANCE 0.01
#define HEARTBEAT_NS (3 * SECOND) /* A mode is known for so long: of heartbeats, one a second, two may be lost. */
#define PX4_MAIN_MODE_OFFBOARD 6 /* of px4_custom_mode.h, in the third byte of custom_mode */
#define KEPT VISTA_VEHICLE_KEPT

vista_status vista_vehicle_start(vista_vehicle *vehicle, const vista_mavlink_params *params, int64_t delay_ns) {
  if (vehicle == NULL || params == NULL) return VISTA_ERROR_ARGUMENT;
  if (delay_ns < 0 || delay_ns > SECOND) return VISTA_ERROR_RANGE;
  const vista_status status = VISTA_CHECK_SECTION(mavlink, params);
  if (status != VISTA_OK) return status;
  *vehicle = (vista_vehicle){.system_id = params->system_id, .delay_ns = delay_ns};
  vista_mavlink_mount(params, vehicle->body_from_camera);
  return VISTA_OK;
}

/* ---- messages ---- */

/* Follows the least delay: the difference creeps up by what the clocks may drift, and falls at once. */
static void follow_clock(vista_vehicle *v, int64_t now_ns, int64_t boot_ns) {
  const int64_t offset_ns = now_ns - v->delay_ns - boot_ns;
  const int64_t crept_ns = v->offset_ns + (now_ns - v->offset_at_ns) / 1000000 * DRIFT_PPM;
  const bool leapt = !v->timed || llabs(offset_ns - crept_ns) > LEAP_NS;
  if (leapt) v->attitude_count = v->position_count = 0;
  v->offset_ns = leapt || offset_ns < crept_ns ? offset_ns : crept_ns;
  v->offset_at_ns = now_ns;
  v->timed = true;
}

static bool all_finite(const float *numbers, int count) {
  for (int k = 0; k < count; ++k)
    if (!isfinite(numbers[k])) return false;
  return true;
}

/* So that counts, which only grow, never overflow. */
static int32_t next_count(int32_t count) { return count < 1 << 30 ? count + 1 : count + 1 - (1 << 29); }

static void take_attitude(vista_vehicle *v, int64_t now_ns, const uint8_t *payload) {
  wire_attitude_quaternion m;
  wire_attitude_quaternion_unpack(payload, &m);
  const float numbers[] = {m.q1, m.q2, m.q3, m.q4, m.rollspeed, m.pitchspeed, m.yawspeed};
  if (!all_finite(numbers, 7)) return;
  const double length = sqrt((double)m.q1 * m.q1 + (double)m.q2 * m.q2 + (double)m.q3 * m.q3 + (double)m.q4 * m.q4);
  if (fabs(length - 1.0) > UNIT_TOLERANCE) return;
  const int64_t boot_ns = m.time_boot_ms * MS;
  follow_clock(v, now_ns, boot_ns);
  if (v->attitude_count > 0 && boot_ns <= v->attitudes[(v->attitude_count - 1) % KEPT].boot_ns) return;
  v->attitudes[v->attitude_count % KEPT] = (vista_vehicle_attitude){
      boot_ns, {m.q1 / length, m.q2 / length, m.q3 / length, m.q4 / length}, {m.rollspeed, m.pitchspeed, m.yawspeed}};
  v->attitude_count = next_count(v->attitude_count);
}

static void take_position(vista_vehicle *v, int64_t now_ns, const uint8_t *payload) {
  wire_local_position_ned m;
  wire_local_position_ned_unpack(payload, &m);
  if (!all_finite((const float[]){m.x, m.y, m.z, m.vx, m.vy, m.vz}, 6)) return;
  const int64_t boot_ns = m.time_boot_ms * MS;
  follow_clock(v, now_ns, boot_ns);
  if (v->position_count > 0 && boot_ns <= v->positions[(v->position_count - 1) % KEPT].boot_ns) return;
  v->positions[v->position_count % KEPT] = (vista_vehicle_position){boot_ns, {m.x, m.y, m.z}, {m.vx, m.vy, m.vz}};
  v->position_count = next_count(v->position_count);
}

static bool flies_setpoints(const wire_heartbeat *m) {
  if (!(m->base_mode & MAV_MODE_FLAG_SAFETY_ARMED)) return false;
  if (m->autopilot == MAV_AUTOPILOT_PX4) return (m->custom_mode >> 16 & 0xFF) == PX4_MAIN_MODE_OFFBOARD;
  if (m->autopilot != MAV_AUTOPILOT_ARDUPILOTMEGA) return false;
  return m->custom_mode == (m->type == MAV_TYPE_FIXED_WING ? PLANE_MODE_GUIDED : COPTER_MODE_GUIDED);
}

static void take_heartbeat(vista_vehicle *v, int64_t now_ns, const uint8_t *payload) {
  wire_heartbeat m;
  wire_heartbeat_unpack(payload, &m);
  v->offered = flies_setpoints(&m);
  v->offered_ns = now_ns;
}

bool vista_vehicle_follows(const vista_vehicle *vehicle, int64_t now_ns) {
  return vehicle->offered && now_ns - vehicle->offered_ns <= HEARTBEAT_NS;
}

/* Takes all frames that are whole. */
static void scan(vista_vehicle *v, int64_t now_ns) {
  int32_t at = 0;
  for (;;) {
    vista_mavlink_message message;
    bool there;
    const int32_t done = vista_mavlink_scan(v->bytes + at, v->used - at, &message, &there);
    if (done == 0) break;
    at += done;
    if (!there || message.system_id != v->system_id || message.component_id != MAV_COMP_ID_AUTOPILOT1) continue;
    if (message.id == WIRE_ATTITUDE_QUATERNION_ID) take_attitude(v, now_ns, message.payload);
    if (message.id == WIRE_HEARTBEAT_ID) take_heartbeat(v, now_ns, message.payload);
    if (message.id == WIRE_LOCAL_POSITION_NED_ID) take_position(v, now_ns, message.payload);
  }
  v->used -= at;
  memmove(v->bytes, v->bytes + at, (size_t)v->used);
}

vista_status vista_vehicle_receive(vista_vehicle *vehicle, int64_t now_ns, const uint8_t *bytes, int32_t count) {
  if (vehicle == NULL || count < 0 || (bytes == NULL && count > 0)) return VISTA_ERROR_ARGUMENT;
  while (count > 0) {
    const int32_t room = VISTA_VEHICLE_FRAME_BYTES - vehicle->used, taken = count < room ? count : room;
    memcpy(vehicle->bytes + vehicle->used, bytes, (size_t)taken);
    vehicle->used += taken;
    bytes += taken;
    count -= taken;
    scan(vehicle, now_ns); /* leaves less than a frame */
  }
  return VISTA_OK;
}

/* ---- the motion at one moment ---- */

/* q * the rotation by rate_rad_s for so long. */
static void turned(const double q[4], const double rate_rad_s[3], double seconds, double out[4]) {
  const double angle =
      0.5 * seconds *
      sqrt(rate_rad_s[0] * rate_rad_s[0] + rate_rad_s[1] * rate_rad_s[1] + rate_rad_s[2] * rate_rad_s[2]);
  const double scale = fabs(angle) < 1e-9 ? 0.5 * seconds : sin(angle) / angle * 0.5 * seconds;
  const double w = cos(angle), x = scale * rate_rad_s[0], y = scale * rate_rad_s[1], z = scale * rate_rad_s[2];
  out[0] = q[0] * w - q[1] * x - q[2] * y - q[3] * z;
  out[1] = q[0] * x + q[1] * w + q[2] * z - q[3] * y;
  out[2] = q[0] * y - q[1] * z + q[2] * w + q[3] * x;
  out[3] = q[0] * z + q[1] * y - q[2] * x + q[3] * w;
}

/* Interpolates on the shorter way from a to b (Shoemake 1985). */
static void slerp(const double a[4], const double b[4], double share, double out[4]) {
  double cosine = a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3], length = 0.0;
  const double sign = cosine < 0.0 ? -1.0 : 1.0;
  cosine = fmin(fabs(cosine), 1.0);
  const double angle = acos(cosine);
  const double from = angle < 1e-6 ? 1.0 - share : sin((1.0 - share) * angle) / sin(angle);
  const double to = angle < 1e-6 ? share : sin(share * angle) / sin(angle);
  for (int k = 0; k < 4; ++k) {
    out[k] = from * a[k] + sign * to * b[k];
    length += out[k] * out[k];
  }
  for (int k = 0; k < 4; ++k) out[k] /= sqrt(length);
}

/* The message before a moment, of `count` times that `boot_ns` tells by number; -1: none that is kept. */
static int32_t before(int64_t t_ns, int32_t count, int64_t (*boot_ns)(const vista_vehicle *, int32_t),
                      const vista_vehicle *v) {
  const int32_t first = count > KEPT ? count - KEPT : 0;
  for (int32_t k = count - 1; k >= first; --k)
    if (boot_ns(v, k) <= t_ns) return k;
  return -1;
}

static int64_t attitude_ns(const vista_vehicle *v, int32_t k) { return v->attitudes[k % KEPT].boot_ns; }
static int64_t position_ns(const vista_vehicle *v, int32_t k) { return v->positions[k % KEPT].boot_ns; }

static bool attitude_at(const vista_vehicle *v, int64_t t_ns, double q[4]) {
  const int32_t k = before(t_ns, v->attitude_count, attitude_ns, v);
  if (k < 0) return false;
  const vista_vehicle_attitude *const a = &v->attitudes[k % KEPT], *const b = &v->attitudes[(k + 1) % KEPT];
  const int64_t past_ns = t_ns - a->boot_ns;
  if (k + 1 == v->attitude_count) {
    turned(a->quaternion, a->rate_rad_s, 1e-9 * (double)past_ns, q);
    return past_ns <= BEYOND_NS;
  }
  const int64_t gap_ns = b->boot_ns - a->boot_ns;
  slerp(a->quaternion, b->quaternion, (double)past_ns / (double)gap_ns, q);
  return gap_ns <= GAP_NS;
}

/* Interpolates between two messages by the cubic that has their positions and velocities (Hermite). */
static bool position_at(const vista_vehicle *v, int64_t t_ns, double position_m[3], double velocity_m_s[3]) {
  const int32_t k = before(t_ns, v->position_count, position_ns, v);
  if (k < 0) return false;
  const vista_vehicle_position *const a = &v->positions[k % KEPT], *const b = &v->positions[(k + 1) % KEPT];
  const double past_s = 1e-9 * (double)(t_ns - a->boot_ns);
  if (k + 1 == v->position_count) {
    for (int i = 0; i < 3; ++i) position_m[i] = a->position_m[i] + past_s * a->velocity_m_s[i];
    memcpy(velocity_m_s, a->velocity_m_s, sizeof a->velocity_m_s);
    return t_ns - a->boot_ns <= BEYOND_NS;
  }
  const double gap_s = 1e-9 * (double)(b->boot_ns - a->boot_ns), s = past_s / gap_s, r = 1.0 - s;
  for (int i = 0; i < 3; ++i) {
    position_m[i] = r * r * (1.0 + 2.0 * s) * a->position_m[i] + s * s * (1.0 + 2.0 * r) * b->position_m[i] +
                    r * r * s * gap_s * a->velocity_m_s[i] - s * s * r * gap_s * b->velocity_m_s[i];
    velocity_m_s[i] = r * a->velocity_m_s[i] + s * b->velocity_m_s[i];
  }
  return b->boot_ns - a->boot_ns <= GAP_NS;
}

static void rotation_of(const double q[4], double rotation[9]) {
  const double w = q[0], x = q[1], y = q[2], z = q[3];
  const double values[9] = {1 - 2 * (y * y + z * z), 2 * (x * y - w * z),     2 * (x * z + w * y),
                            2 * (x * y + w * z),     1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
                            2 * (x * z - w * y),     2 * (y * z + w * x),     1 - 2 * (x * x + y * y)};
  memcpy(rotation, values, sizeof values);
}

vista_status vista_vehicle_at(const vista_vehicle *vehicle, int64_t t_ns, vista_vehicle_motion *motion) {
  if (vehicle == NULL || motion == NULL) return VISTA_ERROR_ARGUMENT;
  *motion = (vista_vehicle_motion){0};
  const int64_t boot_ns = t_ns - vehicle->offset_ns;
  double q[4], position_m[3], velocity_m_s[3], ned_from_body[9];
  if (!attitude_at(vehicle, boot_ns, q) || !position_at(vehicle, boot_ns, position_m, velocity_m_s)) return VISTA_OK;
  motion->pose_known = motion->velocity_known = motion->up_known = true;
  motion->up_world[2] = -1.0;
  rotation_of(q, ned_from_body);
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column)
      for (int k = 0; k < 3; ++k)
        motion->pose.rotation[3 * row + column] +=
            ned_from_body[3 * row + k] * vehicle->body_from_camera[3 * k + column];
  memcpy(motion->pose.translation_m, position_m, sizeof position_m);
  memcpy(motion->velocity_m_s, velocity_m_s, sizeof velocity_m_s);
  return VISTA_OK;
}
