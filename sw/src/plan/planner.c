#include "plan/planner.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#include "common/numbers.h"
#include "common/parameters_check.h"
#include "plan/choice.h"
#include "plan/primitives.h"
#include "plan/space.h"
#include "plan/surroundings.h"
#include "plan/way_field.h"

#define SIGMAS 2.0 /* of the position's error, by which the vehicle is wider */
#define STILL_M_S 0.5
#define MOST 1e6 /* metres, or metres a second: cells are counted in 32 bits */
#define ARRIVED_M 0.5 /* of a multirotor, from the goal; */
#define ARRIVED_S 2.0 /* of a fixed wing, which has to be nearer than so long a flight */
#define OFF_SHARE 0.5 /* of the radius: a vehicle that is farther off its plan does not fly it */
#define OFF_M_S 2.0
#define SIDE_MIN 0.15 /* sine of the angle from the aim that counts as a side */
#define HELPLESS_MOST 24 /* manoeuvres that are asked for when nothing is free */
#define LOOK_ASIDE 0.42 /* sine of the angle by which a vehicle that flies looks aside of its way at most, */
#define LOOK_AHEAD 0.91 /* and its cosine, */
#define TURN_S 3.0    /* to turn the camera round, once the vehicle stands */
#define LOOKED 0.98 /* cosine of the angle to a direction that is looked at already */
#define LOOK_SHARE 0.45 /* unless it is slower than this share of the goal's speed */

vista_status vista_planner_start(vista_planner *planner, const vista_parameters *parameters) {
  if (planner == NULL || parameters == NULL) return VISTA_ERROR_ARGUMENT;
  const vista_status status = vista_parameters_check(parameters, NULL);
  if (status != VISTA_OK) return status;
  const vista_parameters own = vista_parameters_own(parameters);
  planner->params = own.plan;
  planner->radius_m = own.obstacle_map.collision_radius_m;
  vista_planner_reset(planner);
  return VISTA_OK;
}

void vista_planner_reset(vista_planner *planner) {
  const vista_plan_params params = planner->params;
  const double radius_m = planner->radius_m;
  memset(planner, 0, sizeof *planner);
  planner->params = params;
  planner->radius_m = radius_m;
}

/* ---- what is given ---- */

static bool is_unit(const double vector[3]) { return fabs(vista_dot(vector, vector) - 1.0) < 1e-3; }

static vista_status check(const vista_planner *planner, const vista_pipeline_stages *seen,
                          const vista_plan_state *state, const vista_plan_goal *goal) {
  double sum = state->position_sigma_m + goal->speed_m_s, most = fmax(state->position_sigma_m, goal->speed_m_s);
  for (int i = 0; i < 3; ++i) {
    const double given[] = {state->position_m[i], state->velocity_m_s[i], state->acceleration_m_s2[i],
                            goal->from_m[i],      goal->to_m[i],          seen->frame->motion.pose.translation_m[i]};
    sum += state->up[i] + state->heading[i];
    for (size_t k = 0; k < sizeof given / sizeof given[0]; ++k) {
      sum += given[k];
      most = fmax(most, fabs(given[k]));
    }
  }
  double level[3];
  if (!isfinite(sum)) return VISTA_ERROR_NUMBER;
  if (!is_unit(state->up) || !is_unit(state->heading) || !vista_plan_level(state->up, state->heading, level) ||
      !(goal->speed_m_s > 0.0) || !(state->position_sigma_m >= 0.0) || !(most <= MOST))
    return VISTA_ERROR_RANGE;
  return planner->began && state->t_ns < planner->t_ns ? VISTA_ERROR_ORDER : VISTA_OK;
}

/* What the next trajectory begins with: the one that is flown, as long as the vehicle is on it. A controller corrects the
 * errors of a trajectory that goes on; of one that begins anew with each error it would never correct any. False: the
 * vehicle flies none, or has left it. */
static bool goes_on(const vista_planner *p, const vista_plan_state *state, vista_plan_state *from) {
  *from = *state;
  if (!p->committed) return false;
  vista_plan_setpoint told;
  vista_plan_at(&p->plan, vista_seconds_between(p->plan.t_ns, state->t_ns), &told);
  /* What was measured would be fed back, and lags behind a bank. */
  memcpy(from->acceleration_m_s2, told.acceleration_m_s2, sizeof from->acceleration_m_s2);
  if (!(vista_distance(told.position_m, state->position_m) < OFF_SHARE * p->radius_m) ||
      !(vista_distance(told.velocity_m_s, state->velocity_m_s) < OFF_M_S))
    return false;
  memcpy(from->position_m, told.position_m, sizeof from->position_m);
  memcpy(from->velocity_m_s, told.velocity_m_s, sizeof from->velocity_m_s);
  return true;
}

/* ---- one decision ---- */

typedef struct work {
  vista_planner *planner;
  vista_plan_space space;
  const vista_plan_state *state; /* that the trajectory begins with */
  bool goes_on, brakes; /* the one that is flown goes on; a new one brakes, whatever is there */
  vista_plan_aim aim;
  bool arrived, sways;
  vista_plan_decision *decision;
} work;

static bool circles(const work *w) { return w->planner->params.vehicle == VISTA_PLAN_VEHICLE_FIXED_WING; }

static bool walk_on(void *walk, bool ends) { return vista_plan_walk_on(walk, ends); }

/* For so long a fixed wing flies a manoeuvre before it turns back, the shortest that passes: between two trees it can only
 * fly on, as far as that is seen to be free. */
static const double commits_s[] = {0.75, 1.5, 3.0};
#define COMMITS ((int)(sizeof commits_s / sizeof commits_s[0]))

/* The trajectory of an option, in the points of the decision. side: of the circle of a fixed wing. walk: looks along it;
 * null: nobody does. */
static bool fly_along(const work *w, const vista_plan_option *option, int32_t side, double commit_s,
                      vista_plan_walk *walk) {
  const vista_plan_visitor looks = {walk_on, walk}, *const visitor = walk == NULL ? NULL : &looks;
  double velocity_m_s[3];
  vista_plan_velocity(option, velocity_m_s);
  if (!circles(w))
    return vista_plan_multirotor(&w->planner->params, w->state, velocity_m_s, w->sways, visitor, w->decision);
  vista_plan_turning turning = {.side = side, .climb_m_s = vista_dot(w->state->up, velocity_m_s)};
  if (vista_plan_level(w->state->up, option->direction, turning.level)) turning.commit_s = commit_s;
  return vista_plan_fixed_wing(&w->planner->params, w->state, &turning, visitor, w->decision);
}

static bool fly(const work *w, const vista_plan_option *option, int32_t side) {
  return fly_along(w, option, side, commits_s[0], NULL);
}

/* The side to which the circle is tried first: on with the turn. */
static int32_t circle_side(const work *w, const vista_plan_option *option) {
  double left[3];
  vista_cross(w->state->up, w->aim.level, left);
  const double aside = vista_dot(left, option->direction);
  return fabs(aside) > SIDE_MIN ? (aside > 0.0 ? 1 : -1) : w->planner->side != 0 ? w->planner->side : 1;
}

static bool passes(work *w, vista_plan_option *option) {
  const int32_t side = circle_side(w, option);
  const int32_t turns = !circles(w) ? 1 : option->speed_m_s > 0.0 ? 2 * COMMITS : 2; /* a loiter turns at once */
  for (int32_t k = 0; k < turns; ++k) {
    vista_plan_walk walk = {.space = &w->space, .plan = w->decision, .option = option, .next = 1};
    option->ruling = VISTA_PLAN_BY_DYNAMICS;
    if (fly_along(w, option, k % 2 == 0 ? side : -side, commits_s[k / 2], &walk)) {
      option->ruling = VISTA_PLAN_CHOSEN;
      return true;
    }
    if (option->ruling == VISTA_PLAN_BY_DYNAMICS) return false;
    if (option->after_s <= w->decision->escape_s)
      return false; /* before a circle begins: in the way of the other, too */
  }
  return false;
}

/* What a way costs that is flown once the vehicle stands and has turned to it. INFINITY: it looks there already. */
static double looked_at_s(const work *w, const vista_plan_option *option) {
  double wanted[3];
  if (option->ruling != VISTA_PLAN_BY_VIEW || !vista_plan_level(w->state->up, option->direction, wanted))
    return INFINITY;
  const double likeness = vista_dot(wanted, w->state->heading);
  if (likeness > LOOKED) return INFINITY;
  return option->cost_s + vista_norm(w->state->velocity_m_s) / w->planner->params.acceleration_max_m_s2 +
         TURN_S * 0.5 * (1.0 - likeness);
}

/* The cheapest manoeuvre that passes; -1: none. To stop and look where a cheaper way may be is one of them. */
static int32_t first_that_passes(work *w) {
  vista_plan_option *const options = w->decision->options;
  double look_s = INFINITY;
  int32_t last = w->decision->option_count - 1; /* the stop */
  for (int32_t k = 0; k <= last && w->space.looks < VISTA_PLAN_LOOKS; ++k) {
    if (look_s < options[k].cost_s && passes(w, &options[last])) return last;
    if (passes(w, &options[k])) return k;
    look_s = fmin(look_s, looked_at_s(w, &options[k]));
  }
  return -1;
}

/* The same, swaying, or where that lets nothing pass but to stay, without: beside what stands near there may be no room
 * to sway. */
static int32_t choose(work *w) {
  const int32_t stay = w->decision->option_count - 1, swaying = first_that_passes(w);
  if (!w->sways || (swaying >= 0 && swaying != stay)) return swaying;
  w->sways = false;
  w->space.looks = 0; /* places that were asked for are not those without */
  const int32_t still = first_that_passes(w);
  if (swaying < 0 || (still >= 0 && still != stay)) return still;
  w->sways = true; /* it passed */
  w->decision->options[stay].ruling = VISTA_PLAN_CHOSEN;
  (void)fly(w, &w->decision->options[stay], circle_side(w, &w->decision->options[stay]));
  return stay;
}

/* The rest of the plan that was committed to. False: there is none, or the vehicle has left it. */
static bool fly_on(const work *w) {
  const vista_plan_decision *const plan = &w->planner->plan;
  vista_plan_decision *const d = w->decision;
  if (!w->goes_on) return false;
  const double after_s = vista_seconds_between(plan->t_ns, w->state->t_ns), done = after_s / plan->step_s;
  const double last = plan->point_count - 1, circle = plan->circle_from >= 0 ? last - plan->circle_from : 0.0;
  const double left = fmax(ceil(last - circle - done - 1e-6), 0.0); /* steps before the circle or the stop */
  d->step_s = plan->step_s;
  d->escape_s = fmax(plan->escape_s - after_s, 0.0);
  d->circle_from = plan->circle_from >= 0 ? (int32_t)left : -1;
  d->point_count = (int32_t)(left + circle) + 1;
  for (int32_t k = 0; k < d->point_count; ++k) vista_plan_at(plan, after_s + k * plan->step_s, &d->points[k]);
  return true;
}

static const vista_plan_option stop = {.primitive = VISTA_PLAN_STOP};

/* The manoeuvre that is free for longest: the stop, or one that is free for longer. *for_s: for so long. */
static int32_t free_longest(work *w, double *for_s) {
  const int32_t last = w->decision->option_count - 1; /* the stop */
  int32_t best = last;
  *for_s = -1.0;
  for (int32_t i = 0; i <= last && i <= HELPLESS_MOST; ++i) {
    const int32_t k = i == 0 ? last : i - 1;
    vista_plan_option found = w->decision->options[k];
    if (!fly(w, &found, circle_side(w, &found))) continue;
    (void)vista_plan_check(&w->space, w->decision, false, &found);
    if (!(found.after_s > *for_s)) continue;
    best = k;
    *for_s = found.after_s;
  }
  return best;
}

/* Where the camera is turned to: where the vehicle flies, or to the cheapest way of which it is not known what is there. */
static void look_for(const work *w, double heading[3]) {
  const vista_plan_decision *const d = w->decision;
  const vista_plan_option *const chosen = d->chosen >= 0 ? &d->options[d->chosen] : &stop;
  double flown[3];
  const bool flies = chosen->speed_m_s > STILL_M_S && vista_plan_level(w->state->up, chosen->direction, flown);
  if (!vista_plan_level(w->state->up, w->state->heading, heading)) return;
  if (flies) memcpy(heading, flown, sizeof flown);
  for (int32_t k = 0; k < d->option_count && k != d->chosen; ++k) {
    const vista_plan_option *const o = &d->options[k];
    double wanted[3];
    const bool unseen = o->ruling == VISTA_PLAN_BY_VIEW || o->ruling == VISTA_PLAN_BY_UNKNOWN;
    if (!unseen || !vista_plan_level(w->state->up, o->direction, wanted)) continue;
    if (vista_dot(wanted, w->state->heading) > LOOKED) continue;
    memcpy(heading, wanted, sizeof wanted);
    break;
  }
  if (!flies || chosen->speed_m_s < LOOK_SHARE * w->aim.speed_m_s) return;
  double left[3];
  vista_cross(w->state->up, flown, left);
  const double aside = vista_dot(left, heading);
  if (vista_dot(flown, heading) >= LOOK_AHEAD) return;
  for (int i = 0; i < 3; ++i) heading[i] = LOOK_AHEAD * flown[i] + (aside < 0.0 ? -LOOK_ASIDE : LOOK_ASIDE) * left[i];
  const double length = vista_norm(heading);
  for (int i = 0; i < 3; ++i) heading[i] /= length;
}

static void keep_side(const work *w) {
  const vista_plan_decision *const d = w->decision;
  double left[3];
  vista_cross(w->state->up, w->aim.level, left);
  const double aside = d->chosen >= 0 ? vista_dot(left, d->options[d->chosen].direction) : 0.0;
  if (fabs(aside) > SIDE_MIN) w->planner->side = aside > 0.0 ? 1 : -1;
}

static void commit(const work *w) {
  vista_planner *const p = w->planner;
  const vista_plan_decision *const d = w->decision;
  memset(p->wanted, 0, sizeof p->wanted);
  if (d->chosen >= 0) vista_plan_velocity(&d->options[d->chosen], p->wanted);
  if (d->chosen < 0 && !w->brakes) return;
  p->plan = *d;
  p->committed = true;
}

static bool stands(const work *w) { return !circles(w) && vista_norm(w->state->velocity_m_s) < STILL_M_S; }

/* Whether it stops within what counts as the place where it is: another manoeuvre would be no safer. */
static bool stops_here(const work *w) {
  const double stop_m = vista_plan_stop_m(&w->planner->params, vista_norm(w->state->velocity_m_s));
  return !circles(w) && stop_m < OFF_SHARE * w->planner->radius_m;
}

/* Whether something keeps the vehicle from flying straight on, as fast as it is to: that is ruled out, or its way is not
 * free to its end. Near the goal another manoeuvre may be the cheaper one, and nothing is in the way. */
static bool is_kept_off(const vista_plan_option *straight) {
  const bool ruled_out = straight->ruling != VISTA_PLAN_NOT_ASKED && straight->ruling != VISTA_PLAN_BY_DYNAMICS;
  return ruled_out || straight->ends != VISTA_PLAN_CHOSEN;
}

/* It evades from where it is kept off, until it flies straight on again. */
static bool evades(const work *w) {
  const vista_plan_decision *const d = w->decision;
  const bool evaded = w->planner->committed && w->planner->plan.action != VISTA_PLAN_PROCEEDS;
  for (int32_t k = 0; k < d->option_count; ++k) {
    const vista_plan_option *const o = &d->options[k];
    if (o->primitive == VISTA_PLAN_STRAIGHT && o->speed_m_s >= 0.99 * w->aim.speed_m_s)
      return k != d->chosen && (evaded || is_kept_off(o));
  }
  return true;
}

static vista_plan_action action_of(const work *w) {
  const vista_plan_option *const chosen = &w->decision->options[w->decision->chosen];
  if (chosen->primitive == VISTA_PLAN_STOP || chosen->primitive == VISTA_PLAN_LOITER)
    return w->arrived ? VISTA_PLAN_ARRIVED : VISTA_PLAN_HOLDS;
  return evades(w) ? VISTA_PLAN_EVADES : VISTA_PLAN_PROCEEDS;
}

/* Flies what was committed to, or brakes. */
static void end_plan(work *w) {
  w->brakes = !fly_on(w);
  if (w->brakes) (void)fly(w, &stop, circle_side(w, &stop));
}

/* Turns at once, to the side that is free for longer, if that is longer than so long. Whatever a fixed wing flies before
 * it turns puts the turn off, and the next decision would put it off again. So would a turn to the other side: once it
 * turns away, it changes sides only for one that is free to its end. */
static void turn_away(work *w, double best_s) {
  const int32_t first = circle_side(w, &stop);
  const bool turns = w->planner->committed && w->planner->plan.chosen < 0;
  int32_t best = 0;
  w->space.looks = 0;
  for (int32_t k = 0; k < 2 && best_s < INFINITY; ++k) {
    const int32_t side = k == 0 ? first : -first;
    vista_plan_option found = stop;
    if (!fly(w, &found, side)) continue;
    if (vista_plan_check(&w->space, w->decision, true, &found)) found.after_s = INFINITY;
    if (!(found.after_s > best_s) || (turns && side != first && found.after_s < INFINITY)) continue;
    best = side;
    best_s = found.after_s;
  }
  if (best == 0) {
    end_plan(w);
    return;
  }
  w->brakes = true;
  w->planner->side = best;
  (void)fly(w, &stop, best);
  if (!(best_s < INFINITY)) w->decision->action = VISTA_PLAN_ESCAPES;
}

/* For how long nothing is in the way of the plan in the decision; known: for how long it is known to be free. INFINITY: to
 * its end. */
static double free_s(work *w, bool known) {
  vista_plan_option found = stop;
  return vista_plan_check(&w->space, w->decision, !known, &found) ? INFINITY : found.after_s;
}

/* Stops at once, unless the rest of the plan that was committed to is free for longer: before it stops it may fly on for a
 * while, and faster. Returns for how long nothing is in the way. */
static double stop_or_fly_on(work *w) {
  vista_plan_decision *const d = w->decision;
  const double on_s = free_s(w, false);
  if (circles(w) || w->brakes) return on_s;
  const double on_known_s = free_s(w, true);
  d->chosen = d->option_count - 1; /* the stop */
  (void)fly(w, &d->options[d->chosen], 0);
  const double stop_s = free_s(w, false);
  if (stop_s > on_s || (stop_s >= on_s && free_s(w, true) >= on_known_s)) return stop_s;
  d->chosen = -1;
  end_plan(w);
  return on_s;
}

/* No manoeuvre passes. What is in the way of the escape as well may yet be met later on another way. */
static void escape(work *w) {
  vista_plan_decision *const d = w->decision;
  end_plan(w);
  d->action = stands(w) ? VISTA_PLAN_HOLDS : VISTA_PLAN_ESCAPES;
  w->space.looks = 0; /* the manoeuvres may have left none, and what is not asked for is not in the way */
  if (stops_here(w)) return;
  const double on_s = stop_or_fly_on(w);
  if (!(on_s < INFINITY)) return;
  d->action = VISTA_PLAN_HELPLESS;
  if (circles(w)) {
    turn_away(w, on_s);
    return;
  }
  /* Where the stop is free for as long as what was committed to, it is the better end: the vehicle is slower there. */
  double longest_s;
  const int32_t longest = free_longest(w, &longest_s);
  d->chosen = longest_s >= on_s ? longest : -1;
  if (d->chosen < 0)
    end_plan(w);
  else
    (void)fly(w, &d->options[d->chosen], circle_side(w, &d->options[d->chosen]));
}

static void decide(work *w) {
  vista_plan_decision *const d = w->decision;
  vista_plan_list(w->planner, &w->space, w->state, &w->aim, d);
  if (w->arrived) { /* a stop or a circle is all that is wanted */
    d->options[0] = stop;
    if (circles(w)) d->options[0].primitive = VISTA_PLAN_LOITER;
    d->option_count = 1;
  }
  w->sways = !w->arrived && !circles(w);
  d->chosen = choose(w);
  if (d->chosen >= 0) {
    d->action = action_of(w);
  } else {
    escape(w);
    d->escape_seen = false;
  }
  double heading[3];
  look_for(w, heading);
  if (!circles(w)) vista_plan_turn(w->state, heading, d);
  d->looks = w->space.looks;
  vista_plan_at(d, VISTA_PLAN_AHEAD_S, &d->setpoint);
  keep_side(w);
  commit(w);
}

vista_status vista_planner_decide_in(vista_planner *planner, const vista_pipeline_stages *seen,
                                     const vista_directions *directions, const vista_plan_state *state,
                                     const vista_plan_goal *goal, vista_plan_decision *decision) {
  const vista_status status = check(planner, seen, state, goal);
  if (status != VISTA_OK) return status;
  if (seen->frame->motion.restarted) vista_planner_reset(planner);
  planner->began = true;
  planner->t_ns = state->t_ns;
  memset(decision, 0, sizeof *decision); /* what is between its members, too: equal decisions are equal bytes */
  decision->t_ns = state->t_ns;
  decision->chosen = -1;
  vista_plan_state from;
  work w = {.planner = planner, .state = &from, .decision = decision};
  w.goes_on = goes_on(planner, state, &from);
  w.space.seen = *seen;
  vista_plan_take_directions(&w.space, directions);
  w.space.planner = planner;
  w.space.t_ns = state->t_ns;
  memcpy(w.space.start_m, state->position_m, sizeof w.space.start_m);
  w.space.radius_m = planner->radius_m + SIGMAS * state->position_sigma_m;
  w.space.off_m = vista_distance(state->position_m, from.position_m);
  const int64_t seen_ns = seen->frame->t_ns;
  w.space.late_s = state->t_ns > seen_ns ? vista_seconds_between(seen_ns, state->t_ns) : 0.0;
  w.aim = vista_plan_aim_at(planner, &from, goal);
  /* What a few directions lack for a moment is no reason to begin along another way than straight on. */
  const bool begins = !planner->committed && vista_norm(state->velocity_m_s) < STILL_M_S;
  for (int i = 0; i < 3 && begins; ++i) planner->wanted[i] = w.aim.speed_m_s * w.aim.level[i];
  w.arrived = !goal->passed && w.aim.distance_m < (circles(&w) ? ARRIVED_S * goal->speed_m_s : ARRIVED_M);
  vista_plan_take_obstacles(&w.space);
  vista_plan_take_surroundings(&w.space);
  vista_plan_keep(planner, &w.space, state);
  vista_plan_spread(planner, &from, w.aim.point_m);
  decide(&w);
  return VISTA_OK;
}

vista_status vista_planner_decide(vista_planner *planner, const vista_detector *detector, const vista_plan_state *state,
                                  const vista_plan_goal *goal, vista_plan_decision *decision) {
  if (planner == NULL || detector == NULL || state == NULL || goal == NULL || decision == NULL)
    return VISTA_ERROR_ARGUMENT;
  const vista_detector_seen *const last = vista_detector_look(detector);
  if (last->pipeline == NULL) return VISTA_ERROR_ARGUMENT;
  const vista_pipeline_stages seen = vista_pipeline_look(last->pipeline);
  return vista_planner_decide_in(planner, &seen, &last->directions, state, goal, decision);
}
