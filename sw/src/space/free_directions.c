#include "space/free_directions.h"

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include "common/frame.h"
#include "common/numbers.h"
#include "space/path_places.h"

#define FRAMES 3 /* that are looked through: the newest */
#define LEVEL_MIN 0.2 /* sine of camera axis and vertical: a camera that looks up or down sees no level direction */

typedef struct view {
  const vista_frame_view *frame;
  const vista_space_map *map;
  double ahead[3], right[3], up[3]; /* level axes, in the camera */
  double up_world[3], half_m;
  int32_t frames;
  /* Level distance of the nearest confirmed obstacle in each direction, and of ground; INFINITY: none. */
  double thing_m[VISTA_DIRECTIONS], ground_m[VISTA_DIRECTIONS];
} view;

static bool make_axes(view *v, const double up[3]) {
  if (!(sqrt(1.0 - up[2] * up[2]) >= LEVEL_MIN)) return false;
  memcpy(v->up, up, sizeof v->up);
  vista_frame_level_axes(up, v->ahead, v->right);
  return true;
}

static double azimuth_deg(const view *v, const vista_face *face, double aside_m) {
  double world_m[3], camera_m[3];
  for (int i = 0; i < 3; ++i) world_m[i] = face->middle_m[i] + aside_m * face->aside[i];
  vista_frame_to_camera(&v->frame->motion.pose, world_m, camera_m);
  return VISTA_DEGREES_PER_RADIAN * atan2(vista_dot(camera_m, v->right), vista_dot(camera_m, v->ahead));
}

static void tell(view *v, const vista_obstacle *obstacle, const vista_face *face) {
  if (!obstacle->confirmed) return;
  double camera_m[3];
  vista_frame_to_camera(&v->frame->motion.pose, face->middle_m, camera_m);
  if (!(fabs(vista_dot(camera_m, v->up)) < v->half_m + face->half_m[1])) return;
  const double distance_m = hypot(vista_dot(camera_m, v->ahead), vista_dot(camera_m, v->right));
  double *const told_m = obstacle->kind == VISTA_OBSTACLE_GROUND ? v->ground_m : v->thing_m;
  const double first_deg = azimuth_deg(v, face, -face->half_m[0]), last_deg = azimuth_deg(v, face, face->half_m[0]);
  const double first = fmax(floor(first_deg - VISTA_DIRECTIONS_FIRST_DEG), 0.0);
  const double last = fmin(floor(last_deg - VISTA_DIRECTIONS_FIRST_DEG), VISTA_DIRECTIONS - 1.0);
  for (double k = first; k <= last; ++k) told_m[(int)k] = fmin(told_m[(int)k], distance_m);
}

/* Level distance of what is matched at a place. */
static double matched_m(const view *v, const vista_place_evidence *shown) {
  double world_m[3], now_m[3];
  vista_space_map_matched(v->map, shown, world_m);
  vista_frame_to_camera(&v->frame->motion.pose, world_m, now_m);
  return hypot(vista_dot(now_m, v->ahead), vista_dot(now_m, v->right));
}

static bool look(const view *v, const double direction[3], int32_t column, double along_m, vista_path_place *place) {
  const vista_pose *const pose = &v->frame->motion.pose;
  *place = (vista_path_place){.along_m = along_m, .reach_m = vista_path_place_reach_m(v->frame->camera, along_m)};
  vista_upright line = {.half_m = v->half_m};
  for (int i = 0; i < 3; ++i) line.middle_m[i] = pose->translation_m[i] + along_m * direction[i];
  memcpy(line.up, v->up_world, sizeof line.up);
  vista_place_evidence *const shown = &place->shown;
  *shown = vista_space_map_look_upright(v->map, &line, v->frames);
  if (shown->frames > 0) { /* the odds ask for votes of all frames that the map has */
    shown->votes = shown->votes * VISTA_SPACE_FRAMES / shown->frames;
    shown->feet = shown->feet * VISTA_SPACE_FRAMES / shown->frames;
  }
  place->thing = v->thing_m[column] <= along_m + place->reach_m;
  place->ground = v->ground_m[column] <= along_m + place->reach_m;
  place->probability = vista_path_place_probability(place);
  return vista_path_place_is_free_now(place);
}

static double block_m(const view *v, int32_t column, const vista_path_place *place) {
  if (!vista_path_place_is_occupied(place)) return 0.0;
  if (place->shown.disparity_px > 0.0) return matched_m(v, &place->shown);
  return place->thing ? v->thing_m[column] : place->ground ? v->ground_m[column] : 0.0;
}

void vista_free_directions(const vista_frame_view *frame, const vista_space_map *map, const vista_obstacle *obstacles,
                           const vista_face *faces, int32_t count, vista_directions *directions) {
  const vista_obstacle_map_params *const params = &frame->params->obstacle_map;
  *directions = (vista_directions){.up_known = frame->up_known};
  memcpy(directions->up_camera, frame->up_camera, sizeof directions->up_camera);
  view v = {.frame = frame,
            .map = map,
            .half_m = VISTA_PLACE_RADIUS_SHARE * params->collision_radius_m,
            .frames = frame->motion.known ? FRAMES : 1};
  if (!make_axes(&v, directions->up_camera)) return;
  vista_frame_direction_to_world(&frame->motion.pose, v.up, v.up_world);
  for (int k = 0; k < VISTA_DIRECTIONS; ++k) v.thing_m[k] = v.ground_m[k] = INFINITY;
  for (int32_t k = 0; k < count; ++k) tell(&v, &obstacles[k], &faces[k]);
  const vista_camera *const camera = frame->camera;
  const double first_m = fmax(camera->focal_px * camera->baseline_m / frame->matched.disparity_max_px, 1.1 * v.half_m);
  const double last_m = vista_path_places_farthest_m(frame, params->collision_length_m);
  for (int32_t column = 0; column < VISTA_DIRECTIONS; ++column) {
    const double azimuth = (VISTA_DIRECTIONS_FIRST_DEG + column + 0.5) * VISTA_RADIANS_PER_DEGREE;
    double level[3], direction[3];
    for (int i = 0; i < 3; ++i) level[i] = cos(azimuth) * v.ahead[i] + sin(azimuth) * v.right[i];
    vista_frame_direction_to_world(&frame->motion.pose, level, direction);
    if (!(level[2] > 0.1)) continue;
    double along_m = fmin(first_m / level[2], last_m);
    vista_path_place place;
    while (look(&v, direction, column, along_m, &place)) {
      directions->free_m[column] = (float)along_m;
      if (along_m >= last_m) break;
      along_m = fmin(along_m + VISTA_PLACE_STEP_SHARE * along_m, last_m);
    }
    if (!vista_path_place_is_free(&place)) directions->blocked_m[column] = (float)block_m(&v, column, &place);
  }
}
