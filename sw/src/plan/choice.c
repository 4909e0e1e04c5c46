#include "plan/choice.h"

#include <math.h>
#include <string.h>

#include "common/frame.h"
#include "common/numbers.h"
#include "plan/angles.h"
#include "plan/primitives.h"
#include "plan/way_field.h"

#define LOOK_AHEAD_S 5.0
#define LOOK_AHEAD_MIN_M 10.0
#define LOOK_AHEAD_MAX_M 50.0
#define SLOW_S 2.0     /* for so long a slower manoeuvre is slower */
#define ENDS_S 10.0    /* what a way costs that ends at once, at something or where nobody can tell, */
#define CHANGE_SHARE 0.6 /* of the time that a change of velocity takes */
#define CLIMB_S 0.3    /* for leaving the height: what is beside is seen better than what is above */
#define STOP_S 16.0
#define AWAY_RADII 3.0 /* A way that ends nearer, in radii of the vehicle, leads nowhere. */
#define ARRIVE_SHARE 0.5 /* of the acceleration, to stop at the goal with */
#define ARRIVE_S 1.0 /* and no faster than what is left of the way, over this */
#define BEGINS_S 1.2 /* A way that is weighed begins straight, at most for as far as is flown in this time, */
#define BEGINS_RADII 3.0 /* or for so many radii, whichever is longer. */
#define COLUMN_MARGIN 2 /* columns beside a direction that tell how far it is known to be free */
#define SLOPE_MAX 0.35  /* of climbs and descents: what is steeper is out of view */
#define UPRIGHT_LOOKS 3 /* places that are asked for on a way that climbs or descends */
#define WIDE_SHARE 1.2  /* of the radius, beside something on a way ahead */

/* Directions from that to the aim: cosine and sine of 0, 6, 12, 20, 30, 42, 56, 72, 90, 120, 150 and 180 degrees. */
#define ANGLES 12
#define STEEP_ANGLES 4 /* up to the one with this number, climbs and descents are weighed as well */
static const double turns[ANGLES][2] = {{1.0, 0.0},
                                        {0.99452189536827333, 0.10452846326765347},
                                        {0.97814760073380564, 0.20791169081775934},
                                        {0.93969262078590838, 0.34202014332566873},
                                        {0.86602540378443865, 0.5},
                                        {0.74314482547739423, 0.66913060635885822},
                                        {0.55919290347074683, 0.82903757255504174},
                                        {0.30901699437494742, 0.95105651629515357},
                                        {0.0, 1.0},
                                        {-0.5, 0.86602540378443865},
                                        {-0.86602540378443865, 0.5},
                                        {-1.0, 0.0}};
static const double speeds[] = {1.0, 0.7, 0.4, 0.2};
static const double climbs[] = {0.0, 1.0, -1.0}; /* of the greatest climb */
#define SPEEDS ((int)(sizeof speeds / sizeof speeds[0]))
#define CLIMBS ((int)(sizeof climbs / sizeof climbs[0]))

static double look_ahead_m(double speed_m_s) {
  return fmin(fmax(LOOK_AHEAD_S * speed_m_s, LOOK_AHEAD_MIN_M), LOOK_AHEAD_MAX_M);
}

vista_plan_aim vista_plan_aim_at(const vista_planner *planner, const vista_plan_state *state,
                                 const vista_plan_goal *goal) {
  vista_plan_aim aim = {0};
  double leg[3], to_goal[3], done[3];
  for (int i = 0; i < 3; ++i) {
    leg[i] = goal->to_m[i] - goal->from_m[i];
    to_goal[i] = goal->to_m[i] - state->position_m[i];
    done[i] = state->position_m[i] - goal->from_m[i];
  }
  const double length_m = vista_norm(leg), carrot_m = 1.5 * look_ahead_m(goal->speed_m_s);
  aim.distance_m = vista_norm(to_goal);
  memcpy(aim.point_m, goal->to_m, sizeof aim.point_m);
  if (length_m > 0.0) {
    const double along_m = fmax(vista_dot(done, leg) / length_m, 0.0) + carrot_m;
    for (int i = 0; i < 3 && along_m < length_m; ++i) aim.point_m[i] = goal->from_m[i] + along_m / length_m * leg[i];
  }
  double to_aim[3];
  for (int i = 0; i < 3; ++i) to_aim[i] = aim.point_m[i] - state->position_m[i];
  if (!vista_plan_level(state->up, to_aim, aim.level)) (void)vista_plan_level(state->up, state->heading, aim.level);
  aim.speed_m_s = goal->speed_m_s;
  if (!goal->passed && planner->params.vehicle == VISTA_PLAN_VEHICLE_MULTIROTOR) {
    const double most_m_s = sqrt(2.0 * ARRIVE_SHARE * planner->params.acceleration_max_m_s2 * aim.distance_m);
    aim.speed_m_s = fmin(aim.speed_m_s, fmin(most_m_s, aim.distance_m / ARRIVE_S));
  }
  const double rise_m = vista_dot(to_aim, state->up), level_m = vista_dot(to_aim, aim.level);
  const double time_s = fmax(level_m / goal->speed_m_s, 1.0), most_m_s = planner->params.climb_max_m_s;
  aim.climb_m_s = fmin(fmax(rise_m / time_s, -most_m_s), most_m_s);
  return aim;
}

/* ---- how far a direction is free ---- */

typedef struct freedom {
  double free_m;
  vista_plan_ruling ends; /* VISTA_PLAN_CHOSEN: nothing */
} freedom;

static double azimuth_deg(const vista_plan_space *space, const double direction[3]) {
  const vista_frame_view *const frame = space->seen.frame;
  double ahead[3], right[3], camera[3];
  vista_frame_level_axes(space->directions.up_camera, ahead, right);
  vista_frame_direction_to_camera(&frame->motion.pose, direction, camera);
  return VISTA_DEGREES_PER_RADIAN * vista_plan_angle(vista_dot(camera, right), vista_dot(camera, ahead));
}

static bool is_in_view(const vista_plan_space *space, double angle_deg) {
  const vista_camera *const camera = space->seen.frame->camera;
  if (!(fabs(angle_deg) < 89.0)) return false;
  const double u_px = camera->center_u_px + camera->focal_px * vista_plan_tangent(angle_deg * VISTA_RADIANS_PER_DEGREE);
  return u_px >= 0.0 && u_px <= camera->width_px - 1.0;
}

/* What the columns of the frame say of a level direction, as wide as the vehicle. False: it is out of view. */
static bool ask_columns(const vista_plan_space *space, double angle_deg, double most_m, freedom *found) {
  const vista_directions *const d = &space->directions;
  const int32_t middle = (int32_t)floor(angle_deg - VISTA_DIRECTIONS_FIRST_DEG);
  *found = (freedom){.free_m = most_m};
  if (!is_in_view(space, angle_deg)) return false;
  for (int32_t k = middle - COLUMN_MARGIN; k <= middle + COLUMN_MARGIN; ++k) {
    if (k < 0 || k >= VISTA_DIRECTIONS || !is_in_view(space, VISTA_DIRECTIONS_FIRST_DEG + k + 0.5)) continue;
    if (d->blocked_m[k] > 0.0f || d->free_m[k] >= found->free_m) continue;
    *found = (freedom){.free_m = d->free_m[k], .ends = VISTA_PLAN_BY_UNKNOWN};
  }
  double c, s;
  vista_plan_sine_cosine(angle_deg * VISTA_RADIANS_PER_DEGREE, &s, &c);
  for (int32_t k = 0; k < space->blocked_count; ++k) {
    const double *const at_m = space->blocked_m[k];
    const double along_m = c * at_m[0] + s * at_m[1], aside_m = c * at_m[1] - s * at_m[0];
    if (along_m > 0.0 && along_m < found->free_m && fabs(aside_m) < WIDE_SHARE * space->radius_m)
      *found = (freedom){.free_m = along_m, .ends = VISTA_PLAN_BY_PLACE};
  }
  return true;
}

void vista_plan_take_directions(vista_plan_space *space, const vista_directions *directions) {
  space->directions = *directions;
  space->blocked_count = 0;
  for (int32_t k = 0; k < VISTA_DIRECTIONS; ++k) {
    if (!(directions->blocked_m[k] > 0.0f)) continue;
    const double azimuth = (VISTA_DIRECTIONS_FIRST_DEG + k + 0.5) * VISTA_RADIANS_PER_DEGREE;
    double *const at_m = space->blocked_m[space->blocked_count++];
    vista_plan_sine_cosine(azimuth, &at_m[1], &at_m[0]);
    for (int i = 0; i < 2; ++i) at_m[i] *= directions->blocked_m[k];
  }
}

static freedom level_freedom(const vista_plan_space *space, const double level[3], double most_m) {
  freedom found;
  if (!ask_columns(space, azimuth_deg(space, level), most_m, &found)) found = (freedom){.ends = VISTA_PLAN_BY_VIEW};
  return found;
}

static freedom steep_freedom(vista_plan_space *space, const vista_plan_state *state, const double direction[3],
                             double most_m) {
  for (int k = 1; k <= UPRIGHT_LOOKS; ++k) {
    const double along_m = most_m * k / UPRIGHT_LOOKS;
    double point_m[3];
    for (int i = 0; i < 3; ++i) point_m[i] = state->position_m[i] + along_m * direction[i];
    const vista_plan_place place = vista_plan_look(space, point_m, 0.0);
    if (place.ruling != VISTA_PLAN_CHOSEN) return (freedom){most_m * (k - 1) / UPRIGHT_LOOKS, place.ruling};
  }
  return (freedom){.free_m = most_m};
}

/* ---- what it costs ---- */

static double detour_s(const vista_plan_state *state, const vista_plan_aim *aim, const double direction[3],
                       double ahead_m, double speed_m_s) {
  double rest[3], whole[3];
  for (int i = 0; i < 3; ++i) {
    whole[i] = aim->point_m[i] - state->position_m[i];
    rest[i] = whole[i] - ahead_m * direction[i];
  }
  return (ahead_m + vista_norm(rest) - vista_norm(whole)) / speed_m_s;
}

typedef struct list {
  const vista_planner *planner;
  vista_plan_space *space;
  const vista_plan_state *state;
  const vista_plan_aim *aim;
  vista_plan_decision *decision;
  double ahead_m;
} list;

static void add(const list *l, vista_plan_option option) {
  vista_plan_decision *const d = l->decision;
  if (d->option_count == VISTA_PLAN_MOST_OPTIONS) return;
  option.ruling = VISTA_PLAN_NOT_ASKED;
  int32_t at = d->option_count++;
  for (; at > 0 && d->options[at - 1].cost_s > option.cost_s; --at) d->options[at] = d->options[at - 1];
  d->options[at] = option;
}

void vista_plan_velocity(const vista_plan_option *option, double velocity_m_s[3]) {
  for (int i = 0; i < 3; ++i) velocity_m_s[i] = option->speed_m_s * option->direction[i];
}

static double change_s(const list *l, const double velocity_m_s[3]) {
  double change[3];
  for (int i = 0; i < 3; ++i) change[i] = velocity_m_s[i] - l->planner->wanted[i];
  return CHANGE_SHARE * vista_norm(change) / l->planner->params.acceleration_max_m_s2;
}

/* What a way along a level direction costs, past all that was seen, and the turn to where it goes on. */
static double level_s(const list *l, const double level[3], double speed_m_s) {
  const double begins_m = fmin(fmax(BEGINS_S * speed_m_s, BEGINS_RADII * l->planner->radius_m), l->aim->distance_m);
  const vista_plan_way way = vista_plan_way_along(l->planner, l->state->position_m, level, begins_m);
  const double more_m = way.length_m - vista_distance(l->aim->point_m, l->state->position_m);
  return more_m / l->aim->speed_m_s + CHANGE_SHARE * speed_m_s * way.turn / l->planner->params.acceleration_max_m_s2;
}

/* The same of one that climbs or descends: as long as it is free. */
static double steep_s(const list *l, const double direction[3], const freedom *ahead) {
  const double missing = ahead->ends == VISTA_PLAN_CHOSEN ? 0.0 : 1.0 - fmin(ahead->free_m / l->ahead_m, 1.0);
  return CLIMB_S + ENDS_S * missing +
         (missing > 0.0 && ahead->free_m < AWAY_RADII * l->planner->radius_m ? ENDS_S : 0.0) +
         detour_s(l->state, l->aim, direction, l->ahead_m, l->aim->speed_m_s);
}

/* The manoeuvres of one direction: at each speed. */
static void add_speeds(const list *l, const double level[3], int32_t side, double share, const freedom *ahead) {
  const vista_planner *const p = l->planner;
  const int count = p->params.vehicle == VISTA_PLAN_VEHICLE_FIXED_WING ? 1 : SPEEDS;
  for (int k = 0; k < count; ++k) {
    const double speed_m_s = speeds[k] * l->aim->speed_m_s;
    const double most_m_s = p->params.climb_max_m_s;
    const double rise_m_s =
        fmin(fmax(speeds[k] * l->aim->climb_m_s + share * fmin(most_m_s, SLOPE_MAX * speed_m_s), -most_m_s), most_m_s);
    vista_plan_option o = {.primitive = share > 0.0   ? VISTA_PLAN_CLIMB
                                        : share < 0.0 ? VISTA_PLAN_DESCENT
                                        : side != 0   ? VISTA_PLAN_ARC
                                                      : VISTA_PLAN_STRAIGHT};
    double velocity[3];
    for (int i = 0; i < 3; ++i) velocity[i] = speed_m_s * level[i] + rise_m_s * l->state->up[i];
    o.speed_m_s = vista_norm(velocity);
    for (int i = 0; i < 3; ++i) o.direction[i] = velocity[i] / o.speed_m_s;
    o.cost_s = SLOW_S * (1.0 - speeds[k]) + change_s(l, velocity) +
               (share != 0.0 ? steep_s(l, o.direction, ahead) : level_s(l, level, speed_m_s));
    o.free_m = ahead->free_m;
    o.ends = ahead->ends;
    add(l, o);
  }
}

static void turn(const double up[3], const double level[3], int angle, int side, double turned[3]) {
  double left[3];
  vista_cross(up, level, left);
  for (int i = 0; i < 3; ++i) turned[i] = turns[angle][0] * level[i] + side * turns[angle][1] * left[i];
}

static void add_direction(const list *l, int angle, int side) {
  double level[3];
  turn(l->state->up, l->aim->level, angle, side, level);
  const freedom ahead = level_freedom(l->space, level, l->ahead_m);
  const bool steep_too = angle <= STEEP_ANGLES && l->planner->params.climb_max_m_s > 0.0;
  for (int k = 0; k < CLIMBS; ++k) {
    if (climbs[k] != 0.0 && (!steep_too || ahead.ends == VISTA_PLAN_CHOSEN)) continue;
    freedom steep = ahead;
    if (climbs[k] != 0.0) {
      const double speed_m_s = l->aim->speed_m_s;
      const double slope = climbs[k] * fmin(l->planner->params.climb_max_m_s / speed_m_s, SLOPE_MAX);
      double direction[3];
      for (int i = 0; i < 3; ++i) direction[i] = (level[i] + slope * l->state->up[i]) / sqrt(1.0 + slope * slope);
      steep = steep_freedom(l->space, l->state, direction, l->ahead_m);
      if (steep.ends == VISTA_PLAN_BY_UNKNOWN || steep.ends == VISTA_PLAN_BY_VIEW)
        steep.ends = ahead.ends; /* what hides it is what ends the level way, and nobody looks up */
    }
    add_speeds(l, level, side, climbs[k], &steep);
  }
}

void vista_plan_list(const vista_planner *planner, vista_plan_space *space, const vista_plan_state *state,
                     const vista_plan_aim *aim, vista_plan_decision *decision) {
  const list l = {planner, space, state, aim, decision, fmin(look_ahead_m(aim->speed_m_s), fmax(aim->distance_m, 1.0))};
  decision->option_count = 0;
  for (int angle = 0; angle < ANGLES; ++angle)
    for (int side = -1; side <= 1; side += 2)
      if ((angle > 0 && angle < ANGLES - 1) || side > 0) add_direction(&l, angle, angle > 0 ? side : 0);
  const bool circles = planner->params.vehicle == VISTA_PLAN_VEHICLE_FIXED_WING;
  add(&l, (vista_plan_option){.primitive = circles ? VISTA_PLAN_LOITER : VISTA_PLAN_STOP, .cost_s = STOP_S});
}
