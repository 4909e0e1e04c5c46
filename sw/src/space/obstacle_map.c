#include "space/obstacle_map.h"

#include <stdbool.h>
#include <stddef.h>

#include "perceive/terrain/terrain_obstacle.h"
#include "space/nearest_collision.h"
#include "space/track_obstacle.h"

static const char *const kind_names[VISTA_OBSTACLE_KIND_COUNT] = {
    [VISTA_OBSTACLE_THING] = "thing",
    [VISTA_OBSTACLE_TOO_NEAR] = "too_near",
    [VISTA_OBSTACLE_GROUND] = "ground",
};

const char *vista_obstacle_kind_name(vista_obstacle_kind kind) {
  return (unsigned)kind < VISTA_OBSTACLE_KIND_COUNT ? kind_names[kind] : "unknown";
}

struct vista_obstacle_map {
  int32_t max_tracks;
  int32_t count;
  vista_nearest_collision nearest;
  vista_obstacle *obstacles;
};

vista_status vista_obstacle_map_layout(int32_t max_tracks, vista_arena *arena, vista_obstacle_map **map) {
  *map = NULL;
  if (max_tracks < 1 || max_tracks > VISTA_TRACKER_MAX) return VISTA_ERROR_RANGE;
  vista_obstacle_map *made = vista_arena_take(arena, 1, sizeof *made);
  vista_obstacle *obstacles =
      vista_arena_take(arena, (size_t)max_tracks + VISTA_OBSTACLE_KIND_COUNT - 1, sizeof *obstacles);
  if (arena->base == NULL) return VISTA_OK;
  if (arena->used > arena->size) return VISTA_ERROR_MEMORY;
  made->max_tracks = max_tracks;
  made->obstacles = obstacles;
  *map = made;
  return VISTA_OK;
}

void vista_obstacle_map_reset(vista_obstacle_map *map) {
  map->count = 0;
  map->nearest = (vista_nearest_collision){.valid = false};
}

const vista_obstacle *vista_obstacle_map_obstacles(const vista_obstacle_map *map, int32_t *count) {
  *count = map->count;
  return map->obstacles;
}

vista_nearest_collision vista_obstacle_map_nearest(const vista_obstacle_map *map) { return map->nearest; }

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
  const double radius_px = params->collision_radius_m * camera->focal_px / range_m;
  vista_obstacle obstacle = {.id = VISTA_ID_TOO_NEAR,
                             .kind = VISTA_OBSTACLE_TOO_NEAR,
                             .confirmed = true,
                             .in_blind_zone = true,
                             .age_frames = 1,
                             .distance_m = range_m,
                             .extent_m = {2.0 * params->collision_radius_m, 2.0 * params->collision_radius_m},
                             .ellipse = {camera->center_u_px, camera->center_v_px, radius_px, radius_px, 0.0},
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
  return obstacle;
}

void vista_obstacle_map_update(vista_obstacle_map *map, const vista_frame_view *frame, const vista_map_input *input) {
  const vista_terrain *const terrain = input->terrain;
  vista_obstacle_map_reset(map);
  vista_obstacle ground;
  const bool ahead = terrain != NULL && terrain->ahead && vista_terrain_obstacle(frame, terrain, &ground);
  const bool warned = ahead && ground.confirmed && ground.in_collision_volume;
  if (ahead) insert(map, &ground);
  if (warned) map->nearest = vista_nearest_collision_with(frame, &ground, NULL);
  bool shown = warned && !ground.coasting; /* by the nearest collision: it is seen, beyond what would hide it */
  for (int32_t i = 0; i < input->track_count; ++i) {
    const vista_track *const track = &input->tracks[i];
    vista_obstacle obstacle;
    if (!vista_track_obstacle(frame, track, &obstacle)) continue;
    if (warned && (vista_terrain_bears(terrain, &obstacle, obstacle.position_m) ||
                   (vista_track_is_touched(frame, track) && vista_terrain_bears(terrain, &obstacle, track->met_m))))
      obstacle.in_collision_volume = false; /* what is met of it is said */
    insert(map, &obstacle);
    if (!obstacle.confirmed || !obstacle.in_collision_volume) continue;
    shown |= !obstacle.coasting;
    const vista_nearest_collision met = vista_nearest_collision_with(frame, &obstacle, track);
    if (!map->nearest.valid || met.distance_m < map->nearest.distance_m) map->nearest = met;
  }
  vista_nearest_collision_allow_for_parts(&frame->motion.pose, map->obstacles, map->count, &map->nearest);
  if (input->blind_zone == NULL || !input->blind_zone->occupied) return;
  const vista_obstacle obstacle = too_near(frame, input->blind_zone->range_m);
  insert(map, &obstacle);
  if (!shown && !(map->nearest.valid && map->nearest.distance_m < obstacle.distance_m))
    map->nearest = vista_nearest_collision_with(frame, &obstacle, NULL);
}
