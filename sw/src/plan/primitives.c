#include "plan/primitives.h"

#include <math.h>
#include <string.h>

#include "common/numbers.h"
#include "plan/angles.h"

#define STEP_S 0.1
#define SUBSTEPS 2
#define VELOCITY_S 0.4 /* first order of the velocity */
#define JERK_M_S3 10.0 /* PX4 keeps to 8 unless it is told otherwise */
#define UPRIGHT_SHARE 0.6 /* of the acceleration, that is there for climbs and descents */
#define STILL_M_S 0.1
#define SWAY_S 1.4 /* period of the sway */
#define SWAY_TURNS_NS INT64_C(1400000000000) /* a whole number of them */
#define SWAY_M_S2 2.0 /* largest acceleration to a side: it leans by 12 degrees, and moves by 0.1 m */
#define SWAY_ENDS_S 0.8 /* after what it commits to, the sway dies out within this time */
#define YAW_RAD_S 0.8 /* PX4 turns by 45 degrees a second unless it is told otherwise */
#define WING_STEP_S 0.25
#define WING_SLOWEST_M_S 3.0 /* below it, there is no turn to fly */
#define TURN_RAD 6.283185307179586
#define GRAVITY_M_S2 9.80665
#define ROLL_RAD_S 1.0
#define BANK_PER_SINE 2.0 /* radians of bank for the sine of the angle to the direction that it turns to */
#define CLIMB_M_S2 2.0
#define LEVEL_MIN 0.01 /* of a direction, that a level part needs */

bool vista_plan_level(const double up[3], const double vector[3], double level[3]) {
  const double rise = vista_dot(up, vector);
  for (int i = 0; i < 3; ++i) level[i] = vector[i] - rise * up[i];
  const double length = vista_norm(level);
  if (!(length > LEVEL_MIN * vista_norm(vector))) return false;
  for (int i = 0; i < 3; ++i) level[i] /= length;
  return true;
}

double vista_plan_stop_m(const vista_plan_params *params, double speed_m_s) {
  const double a = params->acceleration_max_m_s2;
  return speed_m_s * (0.5 * a / JERK_M_S3 + 0.5 * VELOCITY_S) + vista_square(speed_m_s) / (2.0 * a);
}

/* A vector with its parts along `up` and level no longer than these. */
static void limit(const double up[3], double level_most, double upright_most, double vector[3]) {
  const double rise = vista_dot(up, vector);
  double level[3];
  for (int i = 0; i < 3; ++i) level[i] = vector[i] - rise * up[i];
  const double length = vista_norm(level), share = length > level_most ? level_most / length : 1.0;
  const double upright = fmin(fmax(rise, -upright_most), upright_most);
  for (int i = 0; i < 3; ++i) vector[i] = share * level[i] + upright * up[i];
}

static void lead(const vista_plan_params *params, const double up[3], const double wanted_m_s[3], double dt_s,
                 vista_plan_setpoint *now) {
  const double most = params->acceleration_max_m_s2;
  double change[3];
  for (int i = 0; i < 3; ++i) change[i] = (wanted_m_s[i] - now->velocity_m_s[i]) / VELOCITY_S;
  limit(up, most, UPRIGHT_SHARE * most, change);
  for (int i = 0; i < 3; ++i) change[i] -= now->acceleration_m_s2[i];
  limit(up, JERK_M_S3 * dt_s, JERK_M_S3 * dt_s, change);
  for (int i = 0; i < 3; ++i) {
    const double before_m_s = now->velocity_m_s[i];
    now->acceleration_m_s2[i] += change[i];
    now->velocity_m_s[i] += now->acceleration_m_s2[i] * dt_s;
    now->position_m[i] += 0.5 * (before_m_s + now->velocity_m_s[i]) * dt_s;
  }
}

/* Adds this share of the sway of a time to a point of a trajectory, to the sides of where it looks. */
static void sway(const double up[3], int64_t t_ns, double after_s, double share, vista_plan_setpoint *now) {
  double left[3], sine, cosine;
  const double rate = TURN_RAD / SWAY_S, most_m_s2 = share * SWAY_M_S2;
  vista_cross(up, now->heading, left);
  const double phase = rate * (fmod(1e-9 * (double)(t_ns % SWAY_TURNS_NS), SWAY_S) + after_s);
  vista_plan_sine_cosine(phase, &sine, &cosine);
  for (int i = 0; i < 3; ++i) {
    now->position_m[i] -= most_m_s2 / vista_square(rate) * sine * left[i];
    now->velocity_m_s[i] -= most_m_s2 / rate * cosine * left[i];
    now->acceleration_m_s2[i] += most_m_s2 * sine * left[i];
  }
}

/* Turns the heading towards another one, by a part of the step's tangent: no angle is ever needed. */
static void yaw(const double up[3], const double towards[3], double dt_s, vista_plan_setpoint *now) {
  double left[3];
  vista_cross(up, now->heading, left);
  const double ahead = vista_dot(now->heading, towards), aside = vista_dot(left, towards);
  const double most = YAW_RAD_S * dt_s;
  const double step = ahead > 0.0 ? fmin(fmax(aside / ahead, -most), most) : aside < 0.0 ? -most : most;
  const double length = sqrt(1.0 + step * step);
  for (int i = 0; i < 3; ++i) now->heading[i] = (now->heading[i] + step * left[i]) / length;
  now->yaw_rate_rad_s = step / dt_s;
}

static bool is_still(const vista_plan_setpoint *now) {
  return vista_norm(now->velocity_m_s) < STILL_M_S && vista_norm(now->acceleration_m_s2) < 10.0 * STILL_M_S;
}

static bool wanted_on(const vista_plan_visitor *visitor, bool ends) {
  return visitor == NULL || visitor->visit(visitor->context, ends);
}

bool vista_plan_multirotor(const vista_plan_params *params, const vista_plan_state *state, const double velocity_m_s[3],
                           bool sways, const vista_plan_visitor *visitor, vista_plan_decision *plan) {
  static const double stop[3] = {0.0, 0.0, 0.0};
  vista_plan_setpoint now = {0};
  memcpy(now.position_m, state->position_m, sizeof now.position_m);
  memcpy(now.velocity_m_s, state->velocity_m_s, sizeof now.velocity_m_s);
  memcpy(now.acceleration_m_s2, state->acceleration_m_s2, sizeof now.acceleration_m_s2);
  if (!vista_plan_level(state->up, state->heading, now.heading)) return false;
  limit(state->up, params->acceleration_max_m_s2, UPRIGHT_SHARE * params->acceleration_max_m_s2, now.acceleration_m_s2);
  plan->step_s = STEP_S;
  plan->escape_s = VISTA_PLAN_COMMIT_S;
  plan->circle_from = -1;
  plan->points[0] = now;
  if (sways) sway(state->up, state->t_ns, 0.0, -1.0, &now);
  for (plan->point_count = 1; plan->point_count < VISTA_PLAN_MOST_POINTS;) {
    const double after_s = STEP_S * plan->point_count;
    const double share = sways ? fmin(fmax(1.0 - (after_s - VISTA_PLAN_COMMIT_S) / SWAY_ENDS_S, 0.0), 1.0) : 0.0;
    const bool escapes = after_s >= VISTA_PLAN_COMMIT_S + 0.5 * STEP_S;
    const double *const wanted = escapes ? stop : velocity_m_s;
    for (int k = 0; k < SUBSTEPS; ++k) lead(params, state->up, wanted, STEP_S / SUBSTEPS, &now);
    const bool done = escapes && share == 0.0 && is_still(&now);
    if (done) memset(now.velocity_m_s, 0, sizeof now.velocity_m_s);
    if (done) memset(now.acceleration_m_s2, 0, sizeof now.acceleration_m_s2);
    plan->points[plan->point_count] = now;
    sway(state->up, state->t_ns, after_s, share, &plan->points[plan->point_count]);
    ++plan->point_count;
    if (!wanted_on(visitor, done)) return false;
    if (done) return true;
  }
  return false;
}

void vista_plan_turn(const vista_plan_state *state, const double towards[3], vista_plan_decision *plan) {
  vista_plan_setpoint now = plan->points[0];
  (void)vista_plan_level(state->up, state->heading, now.heading);
  for (int32_t k = 0; k < plan->point_count; ++k) {
    memcpy(plan->points[k].heading, now.heading, sizeof now.heading);
    yaw(state->up, towards, plan->step_s, &now);
    plan->points[k].yaw_rate_rad_s = now.yaw_rate_rad_s;
  }
}

/* ---- a fixed wing ---- */

typedef struct wing {
  const double *up;
  double speed_m_s, most_rad; /* level; of the bank */
  double bank_rad, climb_m_s; /* to the left positive */
  double turned_rad;          /* to the left, so far */
  double level[3];            /* of the flight */
  vista_plan_setpoint now;
} wing;

static void left_of(const wing *w, double left[3]) { vista_cross(w->up, w->level, left); }

/* Turns the direction of flight by an angle, and flies a step along the chord. */
static void turn_by(wing *w, double angle_rad, double dt_s) {
  double left[3], before[3], c, s;
  left_of(w, left);
  memcpy(before, w->level, sizeof before);
  vista_plan_sine_cosine(angle_rad, &s, &c);
  for (int i = 0; i < 3; ++i) w->level[i] = c * w->level[i] + s * left[i];
  left_of(w, left);
  for (int i = 0; i < 3; ++i) {
    w->now.position_m[i] += (0.5 * w->speed_m_s * (before[i] + w->level[i]) + w->climb_m_s * w->up[i]) * dt_s;
    w->now.velocity_m_s[i] = w->speed_m_s * w->level[i] + w->climb_m_s * w->up[i];
    w->now.acceleration_m_s2[i] = w->speed_m_s * angle_rad / dt_s * left[i];
    w->now.heading[i] = w->level[i];
  }
  w->now.yaw_rate_rad_s = angle_rad / dt_s;
  w->turned_rad += angle_rad;
}

static double within(double value, double most) { return fmin(fmax(value, -most), most); }

static void bank(wing *w, double wanted_rad, double climb_m_s, double dt_s) {
  w->bank_rad += within(within(wanted_rad, w->most_rad) - w->bank_rad, ROLL_RAD_S * dt_s);
  w->climb_m_s += within(climb_m_s - w->climb_m_s, CLIMB_M_S2 * dt_s);
  turn_by(w, GRAVITY_M_S2 * vista_plan_tangent(w->bank_rad) / w->speed_m_s * dt_s, dt_s);
}

static bool begin_wing(const vista_plan_params *params, const vista_plan_state *state, wing *w) {
  double left[3];
  *w = (wing){.up = state->up, .most_rad = params->bank_max_deg * VISTA_RADIANS_PER_DEGREE};
  if (!vista_plan_level(state->up, state->velocity_m_s, w->level)) return false;
  w->speed_m_s = vista_dot(w->level, state->velocity_m_s);
  w->climb_m_s = vista_dot(state->up, state->velocity_m_s);
  left_of(w, left);
  w->bank_rad = within(vista_plan_angle(vista_dot(left, state->acceleration_m_s2), GRAVITY_M_S2), w->most_rad);
  memcpy(w->now.position_m, state->position_m, sizeof w->now.position_m);
  memcpy(w->now.velocity_m_s, state->velocity_m_s, sizeof w->now.velocity_m_s);
  memcpy(w->now.heading, w->level, sizeof w->level);
  for (int i = 0; i < 3; ++i) w->now.acceleration_m_s2[i] = GRAVITY_M_S2 * vista_plan_tangent(w->bank_rad) * left[i];
  return w->speed_m_s > WING_SLOWEST_M_S;
}

/* A level circle that ends where it began, in whole steps. */
static bool circle(wing *w, int32_t side, const vista_plan_visitor *visitor, vista_plan_decision *plan) {
  const double rate_rad_s = GRAVITY_M_S2 * vista_plan_tangent(w->most_rad) / w->speed_m_s;
  const double steps = ceil(TURN_RAD / (rate_rad_s * WING_STEP_S));
  plan->circle_from = plan->point_count - 1;
  if (!(plan->point_count + steps <= VISTA_PLAN_MOST_POINTS)) return false;
  for (double k = 0.0; k < steps; ++k) {
    turn_by(w, side * TURN_RAD / steps, WING_STEP_S);
    plan->points[plan->point_count++] = w->now;
    if (!wanted_on(visitor, k + 1.0 == steps)) return false;
  }
  return true;
}

/* What is too slow to fly stays where it is: no decision is without a point. */
static void stand(const vista_plan_state *state, vista_plan_decision *plan) {
  vista_plan_setpoint now = {0};
  memcpy(now.position_m, state->position_m, sizeof now.position_m);
  (void)vista_plan_level(state->up, state->heading, now.heading);
  plan->step_s = WING_STEP_S;
  plan->escape_s = 0.0;
  plan->circle_from = -1;
  plan->points[0] = now;
  plan->point_count = 1;
}

bool vista_plan_fixed_wing(const vista_plan_params *params, const vista_plan_state *state,
                           const vista_plan_turning *turning, const vista_plan_visitor *visitor,
                           vista_plan_decision *plan) {
  wing w;
  if (!begin_wing(params, state, &w)) {
    stand(state, plan);
    return false;
  }
  plan->step_s = WING_STEP_S;
  plan->escape_s = turning->commit_s;
  plan->circle_from = VISTA_PLAN_MOST_POINTS; /* it will come, and whoever looks has to know */
  plan->points[0] = w.now;
  plan->point_count = 1;
  while (plan->point_count < VISTA_PLAN_MOST_POINTS / 2) {
    const bool escapes = WING_STEP_S * (plan->point_count - 1) >= plan->escape_s - 0.5 * WING_STEP_S;
    const bool is_back = turning->side * w.turned_rad >= 0.5 * TURN_RAD; /* flies back where it came from */
    const double wanted_rad = turning->side * w.most_rad;
    if (escapes && is_back && fabs(w.bank_rad - wanted_rad) < 1e-6 && fabs(w.climb_m_s) < 1e-6)
      return circle(&w, turning->side, visitor, plan);
    double left[3];
    left_of(&w, left);
    const double ahead = vista_dot(w.level, turning->level), aside = vista_dot(left, turning->level);
    const double sine = ahead > 0.0 ? aside : aside < 0.0 ? -1.0 : 1.0;
    if (escapes)
      bank(&w, wanted_rad, is_back ? 0.0 : params->climb_max_m_s, WING_STEP_S);
    else
      bank(&w, BANK_PER_SINE * sine, turning->climb_m_s, WING_STEP_S);
    plan->points[plan->point_count++] = w.now;
    if (!wanted_on(visitor, false)) return false;
  }
  plan->circle_from = -1;
  return false;
}
