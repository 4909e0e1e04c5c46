#include "space/path_places.h"

#include <math.h>
#include <stddef.h>

#include "common/flight_path.h"
#include "common/numbers.h"
#include "space/space_odds.h"
#include "vista/parameters.h"

#define FIRST_RADII 2.0 /* of the volume, to the first place: a nearer one fills the view */
#define FRAMES_MIN 4 /* that have to agree to warn of what no track stands for */
#define FRAMES_FULL 5.0 /* more that agree tell no more */
#define DENY 0.3 /* A thing in the volume is not in the way if all places at its range are less likely occupied. */
#define REACH_SHARE 0.15 /* of the distance: where a place reaches farther, only a track tells of it */
#define FREE_SHARE 0.5
#define OVERHUNG_SHARE 0.2 /* of the lines of sight to a free place, at most, in the newest frame or the one before */
#define NOW_SHARE 0.25 /* of the lines of sight that go on beyond a free place in the newest frame */
/* A place that is more likely occupied is not free. Of places that are given as much, half are occupied on families held
 * back: what two frames of six see there is rarely nothing. */
#define FREE 0.3
#define OFF_PATH_SIGMAS 1.0 /* by which the aircraft may be off its path where that is called free */

/* Half of the two disparities by which a range may be wrong, no less than the places are apart. */
double vista_path_place_reach_m(const vista_camera *camera, double along_m) {
  const double dz_m = along_m * along_m / (camera->focal_px * camera->baseline_m);
  return fmax(0.5 * (fmax(2.0 * dz_m, 1.0) + 0.5), 0.5 * VISTA_PLACE_STEP_SHARE * along_m);
}

double vista_path_places_farthest_m(const vista_frame_view *frame, double length_m) {
  const vista_camera *const camera = frame->camera;
  const double range_m = camera->focal_px * camera->baseline_m / frame->params->region.min_disparity_px;
  return fmin(length_m, range_m);
}

/* How far around the path a place reaches: less by so many standard deviations of where the aircraft will be. */
static double radius_m(const vista_frame_view *frame, double along_m, double sigmas) {
  const double volume_m = VISTA_PLACE_RADIUS_SHARE * frame->params->obstacle_map.collision_radius_m;
  return vista_flight_path_likely_radius_m(&frame->path, along_m, volume_m, sigmas);
}

void vista_path_places_look(const vista_frame_view *frame, const vista_space_map *map, vista_path_places *places) {
  const vista_flight_path *const path = &frame->path;
  const vista_obstacle_map_params *const params = &frame->params->obstacle_map;
  places->count = 0;
  const double farthest_m = vista_path_places_farthest_m(frame, frame->path.length_m);
  for (double along_m = FIRST_RADII * params->collision_radius_m;
       along_m <= farthest_m && places->count < VISTA_PATH_PLACES_MAX; along_m += VISTA_PLACE_STEP_SHARE * along_m) {
    vista_path_place *const place = &places->items[places->count++];
    *place = (vista_path_place){.along_m = along_m, .reach_m = vista_path_place_reach_m(frame->camera, along_m)};
    vista_flight_path_point(path, along_m, place->point_m, NULL);
    place->shown = vista_space_map_look(map, place->point_m, radius_m(frame, along_m, params->path_sigmas));
  }
}

/* What an obstacle says of the places at its range. */
static void tell(const vista_obstacle *obstacle, vista_path_places *places) {
  if (!obstacle->confirmed || obstacle->kind == VISTA_OBSTACLE_TOO_NEAR) return;
  for (int32_t k = 0; k < places->count; ++k) {
    vista_path_place *const place = &places->items[k];
    if (fabs(place->along_m - obstacle->distance_m) > place->reach_m) continue;
    bool *const told = obstacle->kind == VISTA_OBSTACLE_GROUND ? &place->ground : &place->thing;
    *told |= obstacle->in_collision_volume;
  }
}

void vista_path_place_pieces(const vista_path_place *place, double pieces[VISTA_PIECE_COUNT]) {
  const vista_place_evidence *const shown = &place->shown;
  const double votes = fmin(fmax(shown->votes, shown->lines), FRAMES_FULL) / FRAMES_FULL,
               feet = fmin(shown->feet, FRAMES_FULL) / FRAMES_FULL;
  pieces[VISTA_PIECE_THING] = place->thing;
  pieces[VISTA_PIECE_GROUND] = place->ground;
  pieces[VISTA_PIECE_VOTES] = votes;
  pieces[VISTA_PIECE_FEET] = fmax(feet - votes, 0.0);
  pieces[VISTA_PIECE_NOT_BEYOND] = 1.0 - shown->beyond;
}

double vista_path_place_probability(const vista_path_place *place) {
  static const double weights[VISTA_PIECE_COUNT] = {[VISTA_PIECE_THING] = VISTA_ODDS_THING,
                                                    [VISTA_PIECE_GROUND] = VISTA_ODDS_GROUND,
                                                    [VISTA_PIECE_VOTES] = VISTA_ODDS_VOTES,
                                                    [VISTA_PIECE_FEET] = VISTA_ODDS_FEET,
                                                    [VISTA_PIECE_NOT_BEYOND] = VISTA_ODDS_NOT_BEYOND};
  double pieces[VISTA_PIECE_COUNT];
  vista_path_place_pieces(place, pieces);
  double sum = VISTA_ODDS_PRIOR;
  for (int k = 0; k < VISTA_PIECE_COUNT; ++k) sum += weights[k] * pieces[k];
  return 1.0 / (1.0 + exp(-sum));
}

void vista_path_places_judge(const vista_obstacle *obstacles, int32_t count, vista_path_places *places) {
  for (int32_t i = 0; i < count; ++i) tell(&obstacles[i], places);
  for (int32_t k = 0; k < places->count; ++k)
    places->items[k].probability = vista_path_place_probability(&places->items[k]);
}

bool vista_path_place_is_known(const vista_path_place *place) {
  const bool matched = place->shown.votes >= FRAMES_MIN || place->shown.feet >= FRAMES_MIN;
  return place->thing || place->ground || (matched && place->reach_m < REACH_SHARE * place->along_m);
}

static bool is_warned_of(const vista_path_place *place) {
  return vista_path_place_is_occupied(place) && vista_path_place_is_known(place);
}

const vista_path_place *vista_path_places_contact(const vista_path_places *places) {
  for (int32_t k = 0; k < places->count; ++k)
    if (is_warned_of(&places->items[k])) return &places->items[k];
  return NULL;
}

double vista_path_places_probability(const vista_path_places *places, double distance_m) {
  double most = NAN;
  for (int32_t k = 0; k < places->count; ++k) {
    const vista_path_place *const place = &places->items[k];
    if (fabs(place->along_m - distance_m) <= place->reach_m) most = fmax(most, place->probability);
  }
  return most;
}

bool vista_path_places_bear_out(const vista_path_places *places, double distance_m) {
  return !(vista_path_places_probability(places, distance_m) < DENY);
}

/* After a start there are too few frames for the odds: then it takes one that sees nothing there. */
bool vista_path_place_is_free(const vista_path_place *place) {
  const vista_place_evidence *const shown = &place->shown;
  const bool all_vote = shown->frames < FRAMES_MIN && shown->votes == shown->frames;
  const bool hangs = shown->overhung > OVERHUNG_SHARE;
  return shown->frames > 0 && !all_vote && !hangs && shown->beyond >= FREE_SHARE && place->probability < FREE;
}

bool vista_path_place_is_free_now(const vista_path_place *place) {
  return place->shown.beyond_newest >= NOW_SHARE && vista_path_place_is_free(place);
}

bool vista_path_place_is_occupied(const vista_path_place *place) { return place->probability >= VISTA_ODDS_WARN; }

/* Whether a place of the path is free as far around it as the aircraft may be off its path there. */
static bool is_free_around(const vista_frame_view *frame, const vista_space_map *map, const vista_path_place *place) {
  vista_path_place around = *place;
  around.shown = vista_space_map_look(map, place->point_m, radius_m(frame, place->along_m, -OFF_PATH_SIGMAS));
  around.probability = vista_path_place_probability(&around);
  return vista_path_place_is_free(&around);
}

double vista_path_places_free_m(const vista_frame_view *frame, const vista_space_map *map,
                                const vista_path_places *places) {
  double free_m = 0.0;
  for (int32_t k = 0; k < places->count; ++k) {
    const vista_path_place *const place = &places->items[k];
    if (!vista_path_place_is_free(place) || !is_free_around(frame, map, place)) return free_m;
    free_m = place->along_m;
  }
  return places->count > 0 && places->count < VISTA_PATH_PLACES_MAX
             ? vista_path_places_farthest_m(frame, frame->path.length_m)
             : free_m;
}
