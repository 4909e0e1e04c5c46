#include "plan/space.h"

#include <math.h>
#include <string.h>

#include "common/frame.h"
#include "common/numbers.h"
#include "follow/tracker.h"
#include "plan/surroundings.h"
#include "space/path_places.h"
#include "space/space_map.h"

#define AGREE_FRAMES 4 /* that have a place in view before it is free by what they see */
/* Of the radius: how far around a place out of view all has to be known to be free, and farther by what the vehicle is off
 * its trajectory. What stands that near is in the way of an escape, too. */
#define ROOM_SHARE 0.5
#define APART_SHARE 0.75 /* of the radius, from a place to the next */
#define SAME_SHARE 0.15 /* of the radius: a place so near to one that was asked for is the same */
#define WIDEST_M 4.0 /* of an obstacle: what is wider has its parts elsewhere, and the map tells of them */
#define SIGMAS 2.0 /* of an obstacle's position */
/* What is farther ahead on a circle than so long a flight is looked at again before the vehicle is there. */
#define CIRCLE_KNOWN_S 1.5

static const vista_track *track_of(const vista_plan_space *space, const vista_obstacle *obstacle) {
  for (int32_t k = 0; k < space->seen.track_count; ++k)
    if (space->seen.tracks[k].id == obstacle->id) return &space->seen.tracks[k];
  return NULL;
}

static double sigma_along_m(const double covariance_m2[9], const double axis[3]) {
  double variance = 0.0;
  for (int i = 0; i < 3; ++i) variance += axis[i] * vista_dot(covariance_m2 + 3 * i, axis);
  return sqrt(fmax(variance, 0.0));
}

static double half_width_m(const vista_face *face) { return fmin(face->half_m[0], 0.5 * WIDEST_M); }

/* The least depth of what stands for an obstacle, to both sides of its face. */
static double least_deep_m(const vista_face *face) { return 0.5 * half_width_m(face); }

/* From a point to what stands for an obstacle, squared: its face, no wider than WIDEST_M, moved by `moved_m` and wider by
 * `sigma_m`, and so deep to both sides. */
static double apart2_m2(const vista_face *face, const double moved_m[3], double sigma_m, double deep_m,
                        const double point_m[3]) {
  double apart_m[3];
  for (int i = 0; i < 3; ++i) apart_m[i] = point_m[i] - face->middle_m[i] - moved_m[i];
  const double x = fmax(fabs(vista_dot(apart_m, face->aside)) - half_width_m(face) - sigma_m, 0.0);
  const double y = fmax(fabs(vista_dot(apart_m, face->up)) - face->half_m[1] - sigma_m, 0.0);
  const double z = fmax(fabs(vista_dot(apart_m, face->sight)) - deep_m, 0.0);
  return x * x + y * y + z * z;
}

static const double unmoved_m[3] = {0.0, 0.0, 0.0};

_Static_assert(VISTA_PLAN_THINGS >= VISTA_TRACKER_MAX + VISTA_OBSTACLE_KIND_COUNT, "obstacles of a frame");

static bool moves(const vista_obstacle *o) { return o->world == VISTA_WORLD_MOVES; }

/* What stands for an obstacle is as deep as so many standard deviations of its position, but no deeper than what is
 * matched at its range may be off: what the map sees through before it is free, however little is known of how far the
 * obstacle is. */
static vista_plan_thing thing_of(const vista_plan_space *space, int32_t index) {
  const vista_face *const face = &space->seen.faces[index];
  const double off_m = vista_path_place_reach_m(space->seen.frame->camera, face->range_m);
  const double sigma_m = sigma_along_m(space->seen.obstacles[index].covariance_m2, face->sight);
  vista_plan_thing thing = {.index = index, .deep_m = fmax(fmin(SIGMAS * sigma_m, off_m), least_deep_m(face))};
  const double half_m[3] = {half_width_m(face), face->half_m[1], thing.deep_m};
  thing.near_m2 = (float)vista_square(1.001 * (vista_norm(half_m) + space->radius_m));
  thing.start2_m2 = apart2_m2(face, unmoved_m, 0.0, least_deep_m(face), space->start_m);
  return thing;
}

void vista_plan_take_obstacles(vista_plan_space *space) {
  space->thing_count = 0;
  for (int moving = 0; moving < 2; ++moving) {
    for (int32_t k = 0; k < space->seen.obstacle_count; ++k) {
      const vista_obstacle *const o = &space->seen.obstacles[k];
      if (!o->confirmed || o->kind == VISTA_OBSTACLE_PLACE || moves(o) != moving) continue;
      space->things[space->thing_count++] = thing_of(space, k);
    }
    if (!moving) space->still_count = space->thing_count;
  }
}

/* What stands at a point; null: nothing. */
static const vista_obstacle *still_at(const vista_plan_space *space, const double point_m[3]) {
  double middle_m[3];
  vista_middle(space->start_m, point_m, middle_m);
  for (int32_t k = 0; k < space->still_count; ++k) {
    const vista_plan_thing *const thing = &space->things[k];
    const vista_face *const face = &space->seen.faces[thing->index];
    if (!(vista_distance2(face->middle_m, point_m) < (double)thing->near_m2)) continue;
    if (!(apart2_m2(face, unmoved_m, 0.0, thing->deep_m, point_m) < vista_square(space->radius_m))) continue;
    if (apart2_m2(face, unmoved_m, 0.0, least_deep_m(face), middle_m) < thing->start2_m2)
      return &space->seen.obstacles[thing->index];
  }
  return NULL;
}

/* What moves and is at a point then; null: nothing. */
static const vista_obstacle *moving_at(const vista_plan_space *space, const double point_m[3], double after_s) {
  for (int32_t k = space->still_count; k < space->thing_count; ++k) {
    const vista_plan_thing *const thing = &space->things[k];
    const vista_obstacle *const o = &space->seen.obstacles[thing->index];
    double moved_m[3] = {0.0, 0.0, 0.0}, sigma_m = 0.0;
    const vista_track *const track = track_of(space, o);
    if (track != NULL) {
      const double later_s = after_s + space->late_s, *const c = track->covariance;
      for (int i = 0; i < 3; ++i) moved_m[i] = later_s * track->velocity_m_s[i];
      sigma_m = SIGMAS * later_s * sqrt(fmax((c[21] + c[28] + c[35]) / 3.0, 0.0));
    }
    const vista_face *const face = &space->seen.faces[thing->index];
    const double apart_m2 = apart2_m2(face, moved_m, fmin(sigma_m, WIDEST_M), thing->deep_m, point_m);
    if (apart_m2 < vista_square(space->radius_m)) return o;
  }
  return NULL;
}

/* What stands at a place, or is known of it. */
static vista_plan_place ask(const vista_plan_space *space, const double point_m[3]) {
  static const vista_plan_place is_free = {.ruling = VISTA_PLAN_CHOSEN};
  const vista_obstacle *const thing = still_at(space, point_m);
  vista_path_place place = {
      .shown = vista_space_map_look_around(space->seen.space, point_m, space->radius_m, space->start_m)};
  if (thing != NULL && thing->kind == VISTA_OBSTACLE_GROUND) place.ground = true;
  if (thing != NULL && thing->kind != VISTA_OBSTACLE_GROUND) place.thing = true;
  place.probability = vista_path_place_probability(&place);
  const int32_t frames = place.shown.frames;
  const bool occupied = vista_path_place_is_occupied(&place), free_now = vista_path_place_is_free_now(&place);
  const bool in_view = frames >= AGREE_FRAMES || (frames > 0 && !free_now); /* or else it has just come into view */
  const bool is_seen_free = in_view && free_now;
  const double range_m = vista_distance(point_m, space->seen.frame->motion.pose.translation_m);
  const bool is_matched = range_m - place.shown.radius_m > vista_plan_matched_from_m(space->seen.frame);
  const double room_m = ROOM_SHARE * space->radius_m + space->off_m;
  const double stands_m = in_view && is_matched ? INFINITY : vista_plan_stands_within(space, point_m, space->radius_m);
  if (stands_m < space->radius_m) {
    const bool touches = occupied || stands_m < room_m;
    if (thing != NULL) return (vista_plan_place){VISTA_PLAN_BY_OBSTACLE, thing->id, .occupied = touches};
    return (vista_plan_place){.ruling = VISTA_PLAN_BY_PLACE, .occupied = touches};
  }
  const bool was_free = !in_view && vista_plan_was_free(space, point_m, room_m);
  const bool stood = was_free || (!in_view && vista_plan_stood_at(space, point_m));
  if (is_seen_free || (was_free && place.shown.lines == 0)) return is_free;
  if (thing != NULL) return (vista_plan_place){VISTA_PLAN_BY_OBSTACLE, thing->id, occupied || !in_view, stood};
  if (occupied) return (vista_plan_place){.ruling = VISTA_PLAN_BY_PLACE, .occupied = true};
  return (vista_plan_place){.ruling = in_view ? VISTA_PLAN_BY_UNKNOWN : VISTA_PLAN_BY_VIEW, .stood = stood};
}

/* Most places are told apart by one coordinate. */
static bool is_same(const vista_plan_space *space, const double a_m[3], const double b_m[3]) {
  const double same_m = SAME_SHARE * space->radius_m;
  return fabs(a_m[0] - b_m[0]) <= same_m && vista_distance(a_m, b_m) <= same_m;
}

vista_plan_place vista_plan_look(vista_plan_space *space, const double point_m[3], double after_s) {
  const vista_obstacle *const mover = moving_at(space, point_m, after_s);
  if (mover != NULL)
    return (vista_plan_place){.ruling = VISTA_PLAN_BY_OBSTACLE, .obstacle_id = mover->id, .occupied = true};
  for (int32_t k = 0; k < space->looks; ++k)
    if (is_same(space, space->looked[k].point_m, point_m)) return space->looked[k].place;
  if (space->looks == VISTA_PLAN_LOOKS) return (vista_plan_place){.ruling = VISTA_PLAN_NOT_ASKED};
  vista_plan_looked *const looked = &space->looked[space->looks++];
  memcpy(looked->point_m, point_m, sizeof looked->point_m);
  looked->place = ask(space, point_m);
  return looked->place;
}

/* From one place to the next, where balls overlap and the map tells them apart. */
static double apart_m(const vista_plan_space *space, const double point_m[3]) {
  const double range_m = vista_distance(point_m, space->seen.frame->motion.pose.translation_m);
  return fmax(APART_SHARE * space->radius_m, VISTA_PLACE_STEP_SHARE * range_m);
}

/* Whether what is known of a place after so long lets the option pass. */
static bool lets_pass(const vista_plan_walk *walk, const vista_plan_place *place, double after_s, bool last) {
  vista_plan_decision *const plan = walk->plan;
  if (place->ruling == VISTA_PLAN_CHOSEN || (walk->occupied_alone && !place->occupied)) return true;
  const bool circles = plan->circle_from >= 0 && after_s > plan->escape_s;
  const bool later = place->ruling == VISTA_PLAN_BY_UNKNOWN && after_s > CIRCLE_KNOWN_S;
  if (circles && (later || place->ruling == VISTA_PLAN_BY_VIEW)) {
    plan->escape_seen = false;
    return true;
  }
  return place->stood && (!last || walk->option->primitive == VISTA_PLAN_STOP);
}

bool vista_plan_walk_on(vista_plan_walk *walk, bool ends) {
  const vista_plan_decision *const plan = walk->plan;
  double point_m[3];
  if (walk->next == 1) {
    walk->plan->escape_seen = true;
    memcpy(walk->last_m, plan->points[0].position_m, sizeof walk->last_m);
  }
  for (; walk->next < plan->point_count; ++walk->next) {
    const int32_t k = walk->next;
    const double *const from_m = plan->points[k - 1].position_m, *const to_m = plan->points[k].position_m;
    const double pieces = fmax(ceil(vista_distance(from_m, to_m) / apart_m(walk->space, to_m)), 1.0);
    for (double piece = 1.0; piece <= pieces; ++piece) {
      for (int i = 0; i < 3; ++i) point_m[i] = from_m[i] + piece / pieces * (to_m[i] - from_m[i]);
      const bool last = ends && k + 1 == plan->point_count && piece == pieces;
      if (!last && vista_distance(point_m, walk->last_m) < apart_m(walk->space, point_m) - 1e-9) continue;
      const double after_s = (k - 1 + piece / pieces) * plan->step_s;
      const vista_plan_place place = vista_plan_look(walk->space, point_m, after_s);
      memcpy(walk->last_m, point_m, sizeof walk->last_m);
      if (lets_pass(walk, &place, after_s, last)) continue;
      walk->option->ruling = place.ruling;
      walk->option->obstacle_id = place.obstacle_id;
      walk->option->after_s = after_s;
      memcpy(walk->option->where_m, point_m, sizeof walk->option->where_m);
      return false;
    }
  }
  return true;
}

bool vista_plan_check(vista_plan_space *space, vista_plan_decision *plan, bool occupied_alone,
                      vista_plan_option *option) {
  vista_plan_walk walk = {space, plan, option, occupied_alone, 1, {0}};
  return vista_plan_walk_on(&walk, true);
}
