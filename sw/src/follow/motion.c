#include "follow/motion.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#include "common/frame.h"
#include "common/numbers.h"

#define JUMP_M 2.0 /* by which a navigation filter may correct itself at once */
#define ACCELERATION_MAX_M_S2 50.0
#define RESTART_POSES 3 /* as many refused ones in a row that agree with each other are believed */
/* The path bends by what turns faster: nobody keeps to a straight line better than this. */
#define PATH_TURN_MIN_DEG_S 1.0
/* Share by which the curvature of what is flown next may differ: it bounds the length of the arc. */
#define PATH_UNCERTAINTY 0.25
#define PATH_S 1.0 /* the slower time constant, that tells whether the velocity turns, and of long turns how fast */
#define NOISE_SIGMAS 3.0
#define PATH_SWAY 2.2 /* measured on 35 sampled flights */
#define PATH_SIGMA_MIN_DEG 0.1
#define UNSEEN_SWAY_DEG 0.8 /* of the direction, before any of it is seen: measured on 56 sampled flights */
#define UNSEEN_SWAY_S 1.5   /* in which most of it has shown */
#define FEWEST 4 /* differences that tell their own scatter */
#define DOUBT_SHARE 0.5 /* of a turn that may be noise: anything between none and all of it, in the mean */
#define STRAIGHT_RAD_S 1e-6
#define REPEATED_S 1.0 /* for which a pose that stays the same counts as an old one */
#define QUARTER_RAD 1.57079632679489661923
#define FARTHEST_M 1e8 /* from the origin: beyond it a double no longer tells what lies beside the camera */

static const char *const source_names[VISTA_MOTION_SOURCE_COUNT] = {
    [VISTA_MOTION_UNTOLD] = "UNTOLD",         [VISTA_MOTION_POSE] = "POSE",       [VISTA_MOTION_STANDS] = "STANDS",
    [VISTA_MOTION_CARRIED_ON] = "CARRIED_ON", [VISTA_MOTION_REFUSED] = "REFUSED",
};

const char *vista_motion_source_name(vista_motion_source source) {
  return (unsigned)source < VISTA_MOTION_SOURCE_COUNT ? source_names[source] : "UNKNOWN";
}

static vista_status check(const vista_motion_params *p, const vista_motion_input *in, const vista_motion_state *s) {
  if (s->started && in->t_ns <= s->t_ns) return VISTA_ERROR_ORDER;
  if (in->velocity_m_s != NULL) {
    const double speed_m_s = vista_norm(in->velocity_m_s);
    if (!isfinite(speed_m_s)) return VISTA_ERROR_NUMBER;
    if (speed_m_s > p->speed_max_m_s) return VISTA_ERROR_RANGE;
  }
  return in->pose != NULL ? vista_frame_check_pose(in->pose) : VISTA_OK;
}

static bool reachable(const vista_motion_params *p, const vista_pose *from, int64_t from_ns, const vista_pose *to,
                      int64_t to_ns) {
  double step_m[3];
  for (int i = 0; i < 3; ++i) step_m[i] = to->translation_m[i] - from->translation_m[i];
  return vista_norm(step_m) <= p->speed_max_m_s * vista_seconds_between(from_ns, to_ns);
}

/* Whether the pose follows on the last one: as fast as a vehicle flies, and, once its velocity is known, with no more of
 * an acceleration than one has. */
static bool follows(const vista_motion_params *p, const vista_pose *pose, int64_t t_ns, const vista_motion_state *s) {
  if (!reachable(p, &s->posed_at, s->posed_t_ns, pose, t_ns)) return false;
  if (!s->rates_known || s->differences < FEWEST) return true;
  const double dt_s = vista_seconds_between(s->posed_t_ns, t_ns);
  const double scatter_m = NOISE_SIGMAS * sqrt(s->velocity_variance) * dt_s;
  double off_m[3];
  for (int i = 0; i < 3; ++i)
    off_m[i] = pose->translation_m[i] - s->posed_at.translation_m[i] - s->velocity_m_s[i] * dt_s;
  return vista_norm(off_m) <= JUMP_M + scatter_m + 0.5 * ACCELERATION_MAX_M_S2 * vista_square(dt_s);
}

static bool imaginable(const vista_pose *pose) { return vista_norm(pose->translation_m) <= FARTHEST_M; }

static bool same(const vista_pose *a, const vista_pose *b) {
  bool all = true;
  for (int i = 0; i < 3; ++i) all &= a->translation_m[i] == b->translation_m[i];
  for (int i = 0; i < 9; ++i) all &= a->rotation[i] == b->rotation[i];
  return all;
}

/* Whether this is the last pose once more, while the vehicle moves. */
static bool is_old(const vista_pose *pose, int64_t t_ns, const vista_motion_state *s) {
  if (!s->posed || !s->rates_known || s->repeats || !same(pose, &s->posed_at)) return false;
  return vista_norm(s->velocity_m_s) > VISTA_SPEED_MIN_M_S && vista_seconds_between(s->posed_t_ns, t_ns) <= REPEATED_S;
}

/* The rotation from one attitude to another: axis times angle, in world. */
static void rotation_between(const double from[9], const double to[9], double vector[3]) {
  double r[9];
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) r[3 * i + j] = vista_dot(to + 3 * i, from + 3 * j);
  const double twice_sine[3] = {r[7] - r[5], r[2] - r[6], r[3] - r[1]};
  const double sine = 0.5 * vista_norm(twice_sine), cosine = 0.5 * (r[0] + r[4] + r[8] - 1.0);
  const double scale = sine > 1e-12 ? 0.5 * atan2(sine, cosine) / sine : 0.0;
  for (int i = 0; i < 3; ++i) vector[i] = scale * twice_sine[i];
}

/* Rodrigues: R = I + sin [k] + (1 - cos) [k]^2, applied from the left. */
static void turn(double rotation[9], const double rate_rad_s[3], double dt_s) {
  const double rate = vista_norm(rate_rad_s);
  if (!(rate > 0.0)) return;
  const double k[3] = {rate_rad_s[0] / rate, rate_rad_s[1] / rate, rate_rad_s[2] / rate};
  const double sine = sin(rate * dt_s), versine = 1.0 - cos(rate * dt_s);
  for (int column = 0; column < 3; ++column) {
    const double x[3] = {rotation[column], rotation[3 + column], rotation[6 + column]};
    const double cross[3] = {k[1] * x[2] - k[2] * x[1], k[2] * x[0] - k[0] * x[2], k[0] * x[1] - k[1] * x[0]};
    const double along = vista_dot(k, x);
    for (int i = 0; i < 3; ++i) rotation[3 * i + column] = x[i] + sine * cross[i] + versine * (along * k[i] - x[i]);
  }
}

static double weight_of(double dt_s, double tau_s) { return tau_s > 0.0 ? 1.0 - exp(-dt_s / tau_s) : 1.0; }

/* v += (1 - exp(-dt / tau)) (dp / dt - v), and the turn rate likewise. */
static void follow(const vista_motion_params *p, const vista_pose *pose, int64_t t_ns, vista_motion_state *s) {
  s->repeats = s->posed && same(pose, &s->posed_at);
  if (s->posed) {
    const double dt_s = vista_seconds_between(s->posed_t_ns, t_ns), tau_s = p->velocity_smoothing_s;
    const double weight = s->rates_known ? weight_of(dt_s, tau_s) : 1.0;
    const double slowly = s->rates_known ? weight_of(dt_s, fmax(PATH_S, tau_s)) : 1.0;
    double rotation[3], velocity2 = 0.0, turn2 = 0.0;
    rotation_between(s->posed_at.rotation, pose->rotation, rotation);
    for (int i = 0; i < 3; ++i) {
      const double difference = (pose->translation_m[i] - s->posed_at.translation_m[i]) / dt_s;
      s->velocity_m_s[i] += weight * (difference - s->velocity_m_s[i]);
      s->turn_rate_rad_s[i] += weight * (rotation[i] / dt_s - s->turn_rate_rad_s[i]);
      s->slow_velocity_m_s[i] += slowly * (difference - s->slow_velocity_m_s[i]);
      s->slow_turn_rate_rad_s[i] += slowly * (rotation[i] / dt_s - s->slow_turn_rate_rad_s[i]);
      velocity2 += vista_square(difference - s->velocity_m_s[i]) / 3.0;
      turn2 += vista_square(rotation[i] / dt_s - s->turn_rate_rad_s[i]) / 3.0;
    }
    /* The smoothed value holds a share `weight` of the difference itself. */
    const double own = fmax(vista_square(1.0 - weight), 1e-3);
    if (s->rates_known) { /* one difference alone shows no scatter */
      const double share = fmax(slowly, 1.0 / s->differences);
      s->velocity_variance += share * (velocity2 / own - s->velocity_variance);
      s->turn_variance += share * (turn2 / own - s->turn_variance);
    }
    s->lag_s = (1.0 - weight) * (s->lag_s + dt_s);
    s->slow_lag_s = (1.0 - slowly) * (s->slow_lag_s + dt_s);
    s->averaged = vista_square(1.0 - weight) * s->averaged + vista_square(weight);
    s->slow_averaged = vista_square(1.0 - slowly) * s->slow_averaged + vista_square(slowly);
    s->last_dt_s = dt_s;
    s->known_s += dt_s;
    s->differences += s->differences < INT32_MAX;
    s->rates_known = true;
  }
  s->posed = true;
  s->posed_t_ns = t_ns;
  s->pose = s->posed_at = *pose;
  s->refused_count = 0;
}

/* Whether the poses that were refused agree with each other, this one included, for long enough. */
static bool means_it(const vista_motion_params *p, const vista_pose *pose, int64_t t_ns, vista_motion_state *s) {
  if (!imaginable(pose)) return false;
  const bool agrees = s->refused_count > 0 && reachable(p, &s->refused_at, s->refused_t_ns, pose, t_ns);
  s->refused_count = agrees ? s->refused_count + 1 : 1;
  s->refused_at = *pose;
  s->refused_t_ns = t_ns;
  return s->refused_count >= RESTART_POSES;
}

static void carry_on(const double velocity_m_s[3], double dt_s, vista_motion_state *s) {
  for (int i = 0; i < 3; ++i) s->pose.translation_m[i] += velocity_m_s[i] * dt_s;
  turn(s->pose.rotation, s->turn_rate_rad_s, dt_s);
}

/* The part of a turn rate of the camera that is orthogonal to `direction`, as far as the turn `path` of the velocity
 * allows for it, less what may be noise; `averaged`: its variance over that of a single difference. */
static void likely_turn(const vista_motion_state *s, const vista_motion *motion, const double rate_rad_s[3],
                        double averaged, const double path[3], double slack, double turn[3]) {
  const double along_rad_s = vista_dot(rate_rad_s, motion->direction);
  double beyond[3];
  for (int i = 0; i < 3; ++i) {
    turn[i] = rate_rad_s[i] - along_rad_s * motion->direction[i];
    beyond[i] = turn[i] - path[i];
  }
  const double of_camera_rad_s = vista_norm(turn);
  const double excess = fmax(0.0, 1.0 - slack / fmax(vista_norm(beyond), STRAIGHT_RAD_S));
  for (int i = 0; i < 3; ++i) turn[i] -= excess * beyond[i];
  const double noise =
      fmax(NOISE_SIGMAS * sqrt(s->turn_variance * averaged), PATH_TURN_MIN_DEG_S * VISTA_RADIANS_PER_DEGREE);
  /* A velocity that sways where the camera does not turn bends no path. */
  const double told_rad_s = fmax(fmin(of_camera_rad_s, vista_norm(turn)), STRAIGHT_RAD_S);
  const double kept = fmax(0.0, 1.0 - vista_square(noise / told_rad_s));
  for (int i = 0; i < 3; ++i) turn[i] *= kept;
}

/* How much of the slower turn rate of the camera is confirmed by the turn of the velocity and is not in `turn`: it may
 * be noise, or a turn that has just begun. */
static double doubtful_turn(const vista_motion_state *s, const vista_motion *motion, const double path[3],
                            const double turn[3]) {
  double slow[3];
  const double along_rad_s = vista_dot(s->slow_turn_rate_rad_s, motion->direction);
  for (int i = 0; i < 3; ++i) slow[i] = s->slow_turn_rate_rad_s[i] - along_rad_s * motion->direction[i];
  const double slow_rad_s = fmax(vista_norm(slow), STRAIGHT_RAD_S);
  return fmax(fmin(slow_rad_s, vista_dot(path, slow) / slow_rad_s) - vista_norm(turn), 0.0);
}

/* How the path turns, rad/s, orthogonal to `direction`: as the camera does. What turns slowly and for long is told by
 * the slower mean, of which the camera's own sway is a smaller part. Returns by how much more it may turn, which does
 * not stand out from noise. */
static double path_turn_rate(const vista_motion_state *s, const vista_motion *motion, double turn[3]) {
  const double apart_s = s->slow_lag_s - s->lag_s;
  const double slow_m_s = vista_norm(s->slow_velocity_m_s), fast_m_s = vista_norm(s->velocity_m_s);
  memset(turn, 0, 3 * sizeof *turn);
  if (!(apart_s > 0.0) || !(fmin(slow_m_s, fast_m_s) > 0.0) || s->differences < FEWEST) return 0.0;
  double path[3], slow[3];
  vista_cross(s->slow_velocity_m_s, s->velocity_m_s, path);
  for (int i = 0; i < 3; ++i) path[i] /= slow_m_s * fast_m_s * apart_s;
  const double slack = NOISE_SIGMAS * sqrt(s->velocity_variance * s->averaged) / (fast_m_s * apart_s);
  likely_turn(s, motion, s->turn_rate_rad_s, s->averaged, path, slack, turn);
  likely_turn(s, motion, s->slow_turn_rate_rad_s, s->slow_averaged, path, slack, slow);
  if (vista_norm(slow) > vista_norm(turn)) memcpy(turn, slow, sizeof slow);
  return doubtful_turn(s, motion, path, turn);
}

/* What the velocity of the last moments is off its mean over a longer time, and no turn of the path explains. */
static void follow_sway(const vista_motion *motion, double dt_s, vista_motion_state *s) {
  const double slow_m_s = vista_norm(s->slow_velocity_m_s), fast_m_s = vista_norm(s->velocity_m_s);
  if (s->differences < FEWEST || !(fmin(slow_m_s, fast_m_s) > 0.0)) return;
  double turn[3], bend[3], off2 = 0.0;
  (void)path_turn_rate(s, motion, turn);
  vista_cross(turn, motion->direction, bend);
  const double agreement = vista_dot(s->slow_velocity_m_s, s->velocity_m_s) / (slow_m_s * fast_m_s);
  for (int i = 0; i < 3; ++i) {
    const double aside = agreement * s->velocity_m_s[i] / fast_m_s - s->slow_velocity_m_s[i] / slow_m_s;
    off2 += 0.5 * vista_square(aside - (s->slow_lag_s - s->lag_s) * bend[i]);
  }
  s->sway2 += fmax(weight_of(dt_s, PATH_S), 1.0 / (s->differences - FEWEST + 1)) * (off2 - s->sway2);
}

vista_status vista_motion_update(const vista_motion_params *params, const vista_motion_input *input,
                                 vista_motion_state *state, vista_motion *motion) {
  const vista_status status = check(params, input, state);
  if (status != VISTA_OK) return status;
  static const double still[3] = {0.0, 0.0, 0.0};
  vista_motion_state *const s = state;
  vista_motion m = {.source = VISTA_MOTION_POSE};
  const double dt_s = s->started ? vista_seconds_between(s->t_ns, input->t_ns) : 0.0;
  if (!s->started) s->pose = vista_frame_still;
  const bool old = input->pose != NULL && is_old(input->pose, input->t_ns, s);
  const vista_pose *const pose = old ? NULL : input->pose;
  if (pose == NULL)
    m.source = input->stationary ? VISTA_MOTION_STANDS : s->posed ? VISTA_MOTION_CARRIED_ON : VISTA_MOTION_UNTOLD;
  else if (!imaginable(pose) || (s->posed && !follows(params, pose, input->t_ns, s)))
    m.source = VISTA_MOTION_REFUSED;
  if (m.source == VISTA_MOTION_REFUSED && means_it(params, pose, input->t_ns, s)) {
    *s = (vista_motion_state){0};
    m.source = VISTA_MOTION_POSE;
    m.restarted = true;
  }
  const double *velocity_m_s = s->velocity_m_s;
  if (m.source == VISTA_MOTION_POSE)
    follow(params, pose, input->t_ns, s);
  else if (m.source == VISTA_MOTION_STANDS)
    velocity_m_s = still;
  if (input->velocity_m_s != NULL) velocity_m_s = input->velocity_m_s;
  m.known = m.source == VISTA_MOTION_POSE || m.source == VISTA_MOTION_STANDS;
  if (!m.known) {
    carry_on(velocity_m_s, dt_s, s);
    m.drift_m = m.source == VISTA_MOTION_UNTOLD ? 0.0 : params->drift_m_s * dt_s;
  }
  s->started = true;
  s->t_ns = input->t_ns;
  m.velocity_known = input->velocity_m_s != NULL || m.source == VISTA_MOTION_STANDS || (m.known && s->rates_known);
  m.pose = s->pose;
  memcpy(m.velocity_m_s, velocity_m_s, sizeof m.velocity_m_s);
  if (m.source != VISTA_MOTION_STANDS) memcpy(m.turn_rate_rad_s, s->turn_rate_rad_s, sizeof m.turn_rate_rad_s);
  m.speed_m_s = vista_norm(velocity_m_s);
  const bool moves = m.speed_m_s > 0.0 && m.speed_m_s >= VISTA_SPEED_MIN_M_S;
  for (int i = 0; i < 3; ++i) /* below the smallest speed the velocity is mostly noise; z: optical axis */
    m.direction[i] = moves ? velocity_m_s[i] / m.speed_m_s : m.pose.rotation[3 * i + 2];
  if (m.source == VISTA_MOTION_POSE && moves) follow_sway(&m, dt_s, s);
  *motion = m;
  return VISTA_OK;
}

vista_flight_path vista_motion_path(const vista_motion_state *state, const vista_motion *motion, double length_m,
                                    double radius_m) {
  vista_flight_path path = {.length_m = length_m};
  memcpy(path.start_m, motion->pose.translation_m, sizeof path.start_m);
  memcpy(path.direction, motion->direction, sizeof path.direction);
  path.sigma_rad = fmax(PATH_SWAY * sqrt(state->sway2), PATH_SIGMA_MIN_DEG * VISTA_RADIANS_PER_DEGREE);
  if (!state->rates_known || !(motion->speed_m_s > 0.0) || motion->speed_m_s < VISTA_SPEED_MIN_M_S ||
      motion->source == VISTA_MOTION_STANDS)
    return path;
  /* Who has been watched for a moment only may sway by more than has been seen. */
  const double unseen_deg = UNSEEN_SWAY_DEG * exp(-state->known_s / UNSEEN_SWAY_S);
  path.sigma_rad = hypot(path.sigma_rad, unseen_deg * VISTA_RADIANS_PER_DEGREE);
  double turn[3], normal[3];
  const double doubt_1_m = path_turn_rate(state, motion, turn) / motion->speed_m_s;
  if (doubt_1_m > 0.0) path.length_m = fmin(length_m, sqrt(2.0 * radius_m / (DOUBT_SHARE * doubt_1_m)));
  vista_cross(turn, motion->direction, normal);
  const double rate = vista_norm(normal);
  if (!(rate > STRAIGHT_RAD_S)) return path;
  /* What is smoothed lags behind: the direction is that of a moment ago. */
  const double lag_rad = rate * (state->lag_s + 0.5 * state->last_dt_s);
  for (int i = 0; i < 3; ++i) {
    normal[i] /= rate;
    path.direction[i] = cos(lag_rad) * motion->direction[i] + sin(lag_rad) * normal[i];
    path.normal[i] = cos(lag_rad) * normal[i] - sin(lag_rad) * motion->direction[i];
  }
  path.curvature_1_m = rate / motion->speed_m_s;
  const double believed_m = sqrt(2.0 * radius_m / (PATH_UNCERTAINTY * path.curvature_1_m));
  path.length_m = fmin(path.length_m, fmin(believed_m, QUARTER_RAD / path.curvature_1_m));
  return path;
}
