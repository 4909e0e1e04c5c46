#include "space/obstacle_map.h"

#include <math.h>
#include <stdbool.h>
#include <stddef.h>

#include "common/frame.h"
#include "common/numbers.h"
#include "perceive/terrain/terrain.h"
#include "space/nearest_collision.h"
#include "space/track_obstacle.h"

#define PLACE_SIGMA_PX 0.25 /* least standard deviation of the disparity of what no track has followed */

static const char *const kind_names[VISTA_OBSTACLE_KIND_COUNT] = {
    [VISTA_OBSTACLE_THING] = "thing",
    [VISTA_OBSTACLE_TOO_NEAR] = "too_near",
    [VISTA_OBSTACLE_GROUND] = "ground",
    [VISTA_OBSTACLE_PLACE] = "place",
};

const char *vista_obstacle_kind_name(vista_obstacle_kind kind) {
  return (unsigned)kind < VISTA_OBSTACLE_KIND_COUNT ? kind_names[kind] : "unknown";
}

struct vista_obstacle_map {
  int32_t max_tracks;
  int32_t count;
  vista_nearest_collision nearest;
  vista_obstacle *obstacles;
  vista_face *faces;
  double free_m;
  bool *entering; /* a track: it is told as in the volume because it soon will be */
};

vista_status vista_obstacle_map_layout(int32_t max_tracks, vista_arena *arena, vista_obstacle_map **map) {
  *map = NULL;
  if (max_tracks < 1 || max_tracks > VISTA_TRACKER_MAX) return VISTA_ERROR_RANGE;
  vista_obstacle_map *made = vista_arena_take(arena, 1, sizeof *made);
  const size_t most = (size_t)max_tracks + VISTA_OBSTACLE_KIND_COUNT - 1;
  vista_obstacle *obstacles = vista_arena_take(arena, most, sizeof *obstacles);
  vista_face *faces = vista_arena_take(arena, most, sizeof *faces);
  bool *entering = vista_arena_take(arena, (size_t)max_tracks, sizeof *entering);
  if (arena->base == NULL) return VISTA_OK;
  if (arena->used > arena->size) return VISTA_ERROR_MEMORY;
  made->max_tracks = max_tracks;
  made->obstacles = obstacles;
  made->faces = faces;
  made->entering = entering;
  *map = made;
  return VISTA_OK;
}

void vista_obstacle_map_reset(vista_obstacle_map *map) {
  map->count = 0;
  map->nearest = (vista_nearest_collision){.valid = false};
  map->free_m = 0.0;
}

const vista_obstacle *vista_obstacle_map_obstacles(const vista_obstacle_map *map, int32_t *count) {
  *count = map->count;
  return map->obstacles;
}

const vista_face *vista_obstacle_map_faces(const vista_obstacle_map *map) { return map->faces; }

vista_nearest_collision vista_obstacle_map_nearest(const vista_obstacle_map *map) { return map->nearest; }

double vista_obstacle_map_free_m(const vista_obstacle_map *map) { return map->free_m; }

/* Keeps the list sorted by distance, then id; lists are short. */
static void insert(vista_obstacle_map *map, const vista_obstacle *obstacle) {
  int32_t i = map->count++;
  for (; i > 0; --i) {
    const vista_obstacle *before = &map->obstacles[i - 1];
    if (before->distance_m < obstacle->distance_m ||
        (before->distance_m == obstacle->distance_m && before->id < obstacle->id))
      break;
    map->obstacles[i] = *before;
  }
  map->obstacles[i] = *obstacle;
}

/* Across: the volume; along: anywhere up to range_m, given at its end with that as standard deviation. */
static vista_obstacle too_near(const vista_frame_view *frame, double range_m) {
  const vista_obstacle_map_params *const params = &frame->params->obstacle_map;
  const vista_camera *const camera = frame->camera;
  const vista_flight_path *const path = &frame->path;
  const double disparity_px = camera->focal_px * camera->baseline_m / range_m;
  vista_obstacle obstacle = {.id = VISTA_ID_TOO_NEAR,
                             .kind = VISTA_OBSTACLE_TOO_NEAR,
                             .confirmed = true,
                             .in_blind_zone = true,
                             .age_frames = 1,
                             .distance_m = range_m,
                             .extent_m = {2.0 * params->collision_radius_m, 2.0 * params->collision_radius_m},
                             .disparity_px = disparity_px,
                             .in_collision_volume = true};
  for (int i = 0; i < 3; ++i) {
    obstacle.position_m[i] = path->start_m[i] + range_m * path->direction[i];
    for (int j = 0; j < 3; ++j) {
      const double along2 = path->direction[i] * path->direction[j];
      obstacle.covariance_m2[3 * i + j] =
          range_m * range_m * along2 + params->collision_radius_m * params->collision_radius_m * ((i == j) - along2);
    }
  }
  double camera_m[3], seen_px[3];
  vista_frame_to_camera(&frame->motion.pose, obstacle.position_m, camera_m);
  camera_m[2] = fmax(camera_m[2], VISTA_DEPTH_MIN_M);
  vista_frame_measure(camera, camera_m, seen_px, NULL);
  const double radius_px = params->collision_radius_m * camera->focal_px / camera_m[2];
  obstacle.ellipse = (vista_ellipse){seen_px[0], seen_px[1], radius_px, radius_px, 0.0};
  return obstacle;
}

/* Something is in the way that no track stands for: where the frame that saw it last matched it, as wide as the volume.
 * False: no frame has matched anything there, or it lies behind the camera by now. */
static bool at_place(const vista_frame_view *frame, const vista_space_map *space, const vista_path_place *place,
                     vista_obstacle *obstacle) {
  const vista_camera *const camera = frame->camera;
  const vista_place_evidence *const shown = &place->shown;
  if (!(shown->disparity_px > 0.0)) return false;
  const vista_pose *const seen_from = &vista_space_map_frame(space, shown->age)->pose;
  const double width_m = 2.0 * frame->params->obstacle_map.collision_radius_m;
  const double depth_m = camera->focal_px * camera->baseline_m / shown->disparity_px;
  const double ray[3] = {(shown->u_px - camera->center_u_px) / camera->focal_px,
                         (shown->v_px - camera->center_v_px) / camera->focal_px, 1.0};
  const double camera_m[3] = {depth_m * ray[0], depth_m * ray[1], depth_m};
  const double along_m = depth_m / shown->disparity_px * fmax(shown->spread_px, PLACE_SIGMA_PX);
  const double across_m = 0.5 * width_m / VISTA_SQRT_3;
  double in_camera[9], now_m[3], measured_px[3];
  for (int i = 0; i < 9; ++i)
    in_camera[i] = along_m * along_m * ray[i / 3] * ray[i % 3] + (i == 0 || i == 4 ? across_m * across_m : 0.0);
  *obstacle = (vista_obstacle){.id = VISTA_ID_PLACE,
                               .kind = VISTA_OBSTACLE_PLACE,
                               .confirmed = true,
                               .coasting = shown->age > 0,
                               .age_frames = shown->frames,
                               .extent_m = {width_m, width_m},
                               .in_collision_volume = true};
  vista_frame_to_world(seen_from, camera_m, obstacle->position_m);
  vista_frame_covariance_to_world(seen_from, in_camera, obstacle->covariance_m2);
  vista_frame_to_camera(&frame->motion.pose, obstacle->position_m, now_m);
  if (!(now_m[2] > 0.0)) return false;
  vista_frame_measure(camera, now_m, measured_px, NULL);
  const double radius_px = 0.5 * width_m * camera->focal_px / now_m[2];
  obstacle->distance_m = vista_norm(now_m);
  obstacle->disparity_px = measured_px[2];
  obstacle->ellipse = (vista_ellipse){measured_px[0], measured_px[1], radius_px, radius_px, 0.0};
  return true;
}

static const vista_track *track_of(const vista_map_input *input, int32_t id) {
  for (int32_t i = 0; i < input->track_count; ++i)
    if (input->tracks[i].id == id) return &input->tracks[i];
  return NULL;
}

/* The distance of an obstacle; of a large one, of the point where its own pixels show that the path meets it: a wall at
 * an angle is nearer there. */
static double met_at_m(const vista_frame_view *frame, const vista_map_input *input, const vista_obstacle *obstacle) {
  const vista_track *const track = obstacle->kind == VISTA_OBSTACLE_THING ? track_of(input, obstacle->id) : NULL;
  if (track == NULL || !vista_track_is_touched(frame, track)) return obstacle->distance_m;
  double met_m[3];
  vista_frame_to_camera(&frame->motion.pose, track->met_m, met_m);
  return vista_norm(met_m);
}

/* Whether an obstacle that is in the way stands where something was matched. One beside the path does not count: it may
 * be another thing, or none. */
static bool is_told(const vista_obstacle_map *map, const vista_frame_view *frame, const vista_map_input *input,
                    double distance_m, double reach_m) {
  for (int32_t i = 0; i < map->count; ++i) {
    const vista_obstacle *const o = &map->obstacles[i];
    if (o->confirmed && o->in_collision_volume && fabs(met_at_m(frame, input, o) - distance_m) <= reach_m) return true;
  }
  return false;
}

/* What stands in the way is what the places on the path bear out. What moves is not where the frames saw it. */
static void ask_places(vista_obstacle_map *map, const vista_frame_view *frame, const vista_map_input *input) {
  vista_path_places *const places = input->places;
  vista_path_places_judge(map->obstacles, map->count, places);
  for (int32_t i = 0; i < map->count; ++i) {
    vista_obstacle *const o = &map->obstacles[i];
    if (o->kind != VISTA_OBSTACLE_THING || !o->in_collision_volume || o->world == VISTA_WORLD_MOVES) continue;
    const vista_track *const track = track_of(input, o->id);
    if (track == NULL || map->entering[track - input->tracks]) continue;
    o->in_collision_volume = vista_path_places_bear_out(places, o->distance_m);
  }
  const vista_path_place *const contact = vista_path_places_contact(places);
  if (contact == NULL || contact->thing || contact->ground) return;
  vista_obstacle obstacle;
  if (at_place(frame, input->space, contact, &obstacle) &&
      !is_told(map, frame, input, obstacle.distance_m, contact->reach_m))
    insert(map, &obstacle);
}

/* Takes out what lies on ground that is warned of: where that is met is said already. */
static void leave_to_ground(vista_obstacle_map *map, const vista_frame_view *frame, const vista_map_input *input) {
  for (int32_t i = 0; i < map->count; ++i) {
    vista_obstacle *const o = &map->obstacles[i];
    const vista_track *const track = o->kind == VISTA_OBSTACLE_THING ? track_of(input, o->id) : NULL;
    if (track == NULL) continue;
    if (vista_terrain_bears(input->terrain, o, o->position_m) ||
        (vista_track_is_touched(frame, track) && vista_terrain_bears(input->terrain, o, track->met_m)))
      o->in_collision_volume = false;
  }
}

/* What flies may be in the way where it is not yet. */
static double free_m(const vista_obstacle_map *map, const vista_frame_view *frame, const vista_map_input *input) {
  double free_m = vista_path_places_free_m(frame, input->space, input->places);
  if (map->nearest.valid) free_m = fmin(free_m, map->nearest.distance_m);
  for (int32_t i = 0; i < input->track_count; ++i) {
    const vista_track *const track = &input->tracks[i];
    if (!vista_track_may_enter(frame, track)) continue;
    free_m = fmin(free_m, fmax(vista_flight_path_along(&frame->path, track->position_m, NULL), 0.0));
  }
  return free_m;
}

static void find_nearest(vista_obstacle_map *map, const vista_frame_view *frame, const vista_map_input *input) {
  bool shown = false; /* by the nearest collision: it is seen, beyond what would hide it */
  for (int32_t i = 0; i < map->count; ++i) {
    const vista_obstacle *const o = &map->obstacles[i];
    if (!o->confirmed || !o->in_collision_volume) continue;
    shown |= !o->coasting;
    const vista_track *const track = o->kind == VISTA_OBSTACLE_THING ? track_of(input, o->id) : NULL;
    const vista_nearest_collision met = vista_nearest_collision_with(frame, o, track);
    if (!map->nearest.valid || met.distance_m < map->nearest.distance_m) map->nearest = met;
  }
  vista_nearest_collision_allow_for_parts(&frame->motion.pose, map->obstacles, map->count, &map->nearest);
  if (input->blind_zone == NULL || !input->blind_zone->occupied) return;
  const vista_obstacle obstacle = too_near(frame, input->blind_zone->range_m);
  insert(map, &obstacle);
  if (!shown && !(map->nearest.valid && map->nearest.distance_m < obstacle.distance_m))
    map->nearest = vista_nearest_collision_with(frame, &obstacle, NULL);
}

void vista_obstacle_map_update(vista_obstacle_map *map, const vista_frame_view *frame, const vista_map_input *input) {
  const vista_terrain *const terrain = input->terrain;
  vista_obstacle_map_reset(map);
  vista_obstacle ground;
  const bool ahead = terrain != NULL && terrain->ahead && vista_terrain_obstacle(frame, terrain, &ground);
  const bool warned = ahead && ground.confirmed && ground.in_collision_volume;
  if (ahead) insert(map, &ground);
  for (int32_t i = 0; i < input->track_count; ++i) {
    const vista_track *const track = &input->tracks[i];
    vista_obstacle obstacle;
    if (!vista_track_obstacle(frame, track, &obstacle)) continue;
    map->entering[i] = !obstacle.in_collision_volume && vista_track_enters(frame, track);
    obstacle.in_collision_volume |= map->entering[i];
    insert(map, &obstacle);
  }
  if (input->places != NULL) ask_places(map, frame, input);
  if (warned) leave_to_ground(map, frame, input);
  find_nearest(map, frame, input);
  for (int32_t i = 0; i < map->count; ++i) map->faces[i] = vista_face_of(frame, &map->obstacles[i]);
  if (input->places != NULL) map->free_m = free_m(map, frame, input);
}
