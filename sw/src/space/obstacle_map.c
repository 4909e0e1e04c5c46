#include "space/obstacle_map.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#include "common/bits.h"
#include "common/disc.h"
#include "common/frame.h"
#include "common/numbers.h"
#include "common/parameters_check.h"
#include "perceive/terrain/terrain_obstacle.h"

#define LONG_RATIO 2.0 /* a side longer than this many times the other one is that of a long thing */
#define STEADY_MIN 0.25 /* the share of the variance that is left at least: more than ten hits tell no more */
#define ACROSS_M_S 0.5
#define ACROSS_SIGMAS 3.0
#define MISSES_MAX 2 /* misses in a row, with something else in its place, up to which a thing is warned of */
#define MEET_M_S 1.0
#define MEET_SIGMAS 5.0
#define MEET_HITS 6
#define MEET_STEPS 60
#define FOOT_HITS 2.5 /* hits in which a foot was looked for: fewer say nothing of whether the thing stands */
#define FOOT_STANDS 0.15
#define THICK_MAX_M 1.0 /* larger things are walls and the like, whose sides tell nothing of their depth */
#define COMPACT_M 3.0 /* sides up to this are met anywhere between their middle and the point closest to the path */
#define LARGE_M 4.5   /* sides from this on are met in that point */
#define END_SHARE 0.2 /* uncertainty of the end of a side, as a share of half the side */
#define RELIEF_M 0.1 /* unevenness of a surface */
#define SAME_RANGE_M 1.0 /* difference in range, beside three sigmas, up to which two obstacles may be one thing */
#define DEPTH_MIN_M 0.05 /* nearer along z: behind the camera */

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
  if (arena == NULL || map == NULL) return VISTA_ERROR_ARGUMENT;
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

/* From the surface that is seen to the middle of what is behind it: nothing for a board, half its width for a ball.
 * Seen from above, things are about as deep as they are wide, however low; but a beam is not as deep as it is long. */
static double thickness_m(const vista_obstacle_map_params *params, const vista_track *track) {
  const double half_m = 0.5 * fmin(fmin(track->extent_m[0], LONG_RATIO * track->extent_m[1]), THICK_MAX_M);
  return params->thickness_ratio * half_m;
}

/* Of the scatter, what noise does not explain: the region changes. */
static double excess_px2(const vista_track *track, int axis) {
  return fmax(track->scatter_px2[axis] - track->expected_px2[axis], 0.0);
}

/* Most things are seen more steadily than the noise that the worst ones need. As far as a track has shown that, its
 * covariance is smaller: T diag(share) T^-1 on both sides, T from along x, along y and along the ray to the camera. */
static void steady_covariance(const vista_track *track, const vista_pose *pose, const double camera_m[3],
                              double covariance_m2[9]) {
  double sigma[3];
  const double known = fmin(track->hits, VISTA_SCATTER_HITS) / VISTA_SCATTER_HITS;
  for (int i = 0; i < 3; ++i) {
    const double share = track->expected_px2[i] > 0.0 ? track->scatter_px2[i] / track->expected_px2[i] : 1.0;
    sigma[i] = sqrt(1.0 - known * (1.0 - fmin(fmax(share, STEADY_MIN), 1.0)));
  }
  const double in_camera[9] = {[0] = sigma[0],
                               [4] = sigma[1],
                               [8] = sigma[2],
                               [2] = (sigma[2] - sigma[0]) * camera_m[0] / camera_m[2],
                               [5] = (sigma[2] - sigma[1]) * camera_m[1] / camera_m[2]};
  double in_world[9] = {0}, from[9];
  const double *const r = pose->rotation;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      for (int k = 0; k < 9; ++k) in_world[3 * i + j] += r[3 * i + k / 3] * in_camera[k] * r[3 * j + k % 3];
  memcpy(from, covariance_m2, sizeof from);
  vista_frame_propagate(in_world, from, covariance_m2);
}

/* Of the errors that last: along the ray by disparity and depth, and by the foot of what is told by its outline; across
 * it by pixels and a share of the half extent. */
static void lasting_covariance(const vista_obstacle_map_params *params, const vista_camera *camera,
                               const vista_pose *pose, const vista_track *track, const double camera_m[3],
                               double covariance_m2[9]) {
  const double fb = camera->focal_px * camera->baseline_m, z = camera_m[2];
  const double share = vista_square(params->lasting_scatter);
  const double disparity_px = sqrt(vista_square(params->lasting_disparity_px) + share * excess_px2(track, 2) +
                                   fmax(track->lasting_px2[2], 0.0));
  const double own_m = hypot(z * z / fb * disparity_px, params->lasting_range_m + thickness_m(params, track));
  const double range_m = hypot(own_m, track->foot_sigma_m);
  const double ray[3] = {camera_m[0] / z, camera_m[1] / z, 1.0};
  double in_camera[9];
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) in_camera[3 * i + j] = range_m * range_m * ray[i] * ray[j];
  for (int i = 0; i < 2; ++i) {
    const double center_px =
        sqrt(vista_square(params->lasting_center_px) + share * excess_px2(track, i) + fmax(track->lasting_px2[i], 0.0));
    const double pixels_m = center_px * z / camera->focal_px;
    const double longer_m = fmax(track->extent_m[i] - LONG_RATIO * fmin(track->extent_m[0], track->extent_m[1]), 0.0);
    const double share_m = 0.5 * params->lasting_center_ratio * longer_m;
    in_camera[4 * i] += pixels_m * pixels_m + share_m * share_m;
  }
  vista_frame_covariance_to_world(pose, in_camera, covariance_m2);
}

/* Of the collision volume, where that is: as narrow as its pixels are asked for (collision_volume.h). */
static double likely_radius_m(const vista_obstacle_map_params *params, const vista_flight_path *path,
                              const double position_m[3]) {
  const double along_m = fmin(fmax(vista_flight_path_along(path, position_m, NULL), 0.0), path->length_m);
  return vista_flight_path_likely_radius_m(path, along_m, params->collision_radius_m, params->path_sigmas);
}

/* Facing the camera, half the extent inflated by the standard deviation of the bearing: sigma_u Z / f across. */
static vista_disc disc_of(const vista_obstacle_map_params *params, const vista_camera *camera, const vista_pose *pose,
                          const vista_track *track, const double covariance_px2[9], double depth_m) {
  const double inflation = params->inflation_sigma * depth_m / camera->focal_px;
  vista_disc disc = {.half_x_m = 0.5 * track->extent_m[0] + inflation * sqrt(covariance_px2[0]),
                     .half_y_m = 0.5 * track->extent_m[1] + inflation * sqrt(covariance_px2[4])};
  for (int i = 0; i < 3; ++i) {
    disc.center_m[i] = track->position_m[i];
    disc.axis_x[i] = pose->rotation[3 * i];
    disc.axis_y[i] = pose->rotation[3 * i + 1];
  }
  return disc;
}

/* The part of a track's velocity that is across a direction (of length 1), and its variance summed over the axes: the
 * trace of (I - d d^T) P (I - d d^T), with P the covariance of the velocity. */
static double velocity_across(const vista_track *track, const double direction[3], double across_m_s[3]) {
  const double *const p = track->covariance;
  const double along_m_s = vista_dot(track->velocity_m_s, direction);
  double variance = 0.0;
  for (int i = 0; i < 3; ++i) {
    across_m_s[i] = track->velocity_m_s[i] - along_m_s * direction[i];
    variance += p[7 * (i + 3)];
    for (int j = 0; j < 3; ++j) variance -= direction[i] * direction[j] * p[6 * (i + 3) + j + 3];
  }
  return variance;
}

/* Whether a thing that is seen to move across the path will soon be in the volume. The speed across is asked for as the
 * tracker asks for it: above what regions that change make up, and three standard deviations. */
static bool about_to_enter(const vista_obstacle_map_params *params, const vista_flight_path *path,
                           const vista_track *track, const vista_disc *disc) {
  double there[3], across[3];
  vista_flight_path_along(path, track->position_m, there);
  const double variance = velocity_across(track, there, across);
  const double speed2 = vista_dot(across, across);
  if (speed2 <= vista_square(ACROSS_M_S) || speed2 <= vista_square(ACROSS_SIGMAS) * variance) return false;
  vista_disc soon = *disc;
  for (int i = 0; i < 3; ++i) soon.center_m[i] += params->approach_s * across[i];
  return vista_flight_path_near_disc(path, &soon, params->collision_radius_m);
}

/* Whether the thing stands: the foot of its region was hardly ever seen to hang in the air. Nothing else tells as surely
 * that a thing flies. */
static bool seen_to_stand(const vista_track *track) {
  const vista_static_world *const w = &track->world;
  return w->foot_count >= FOOT_HITS && w->foot_share <= FOOT_STANDS * w->foot_count;
}

/* Whether a thing that flies and the aircraft will meet, both going on as they do. Of what may only seem to move more is
 * asked than of what is about to enter the volume: a faster and a more certain motion, more hits. Where both will be is
 * the less certain the later that is, so the volume is as much narrower. */
static bool will_meet(const vista_obstacle_map_params *params, const vista_flight_path *path, double speed_m_s,
                      const vista_track *track) {
  if (track->hits < MEET_HITS || track->plain || seen_to_stand(track)) return false;
  double ahead[3], across[3];
  (void)vista_flight_path_along(path, track->position_m, ahead);
  const double variance = velocity_across(track, ahead, across);
  const double speed2 = vista_dot(across, across);
  if (speed2 <= vista_square(MEET_M_S) || speed2 <= vista_square(MEET_SIGMAS) * variance) return false;
  for (int k = 0; k <= MEET_STEPS; ++k) {
    const double t_s = params->meet_s * k / MEET_STEPS, along_m = speed_m_s * t_s;
    if (along_m > path->length_m) return false;
    double there_m[3], off_m[3];
    vista_flight_path_point(path, along_m, there_m, NULL);
    for (int i = 0; i < 3; ++i) off_m[i] = track->position_m[i] + t_s * track->velocity_m_s[i] - there_m[i];
    const double doubt_m = params->path_sigmas * t_s * sqrt(0.5 * variance);
    const double likely_m =
        vista_flight_path_likely_radius_m(path, along_m, params->collision_radius_m, params->path_sigmas) - doubt_m;
    if (vista_norm(off_m) <= fmax(likely_m, VISTA_LIKELY_RADIUS_MIN * params->collision_radius_m)) return true;
  }
  return false;
}

/* A frame without a detection does not take back what was seen to move, nor do those in which nothing is matched where
 * it is. After more of them its velocity is a guess. */
static bool motion_is_seen(const vista_track *track) { return !track->edges_only && track->misses <= 1; }

/* Of a plain wall that fills the view, only the part in the image had a middle and an extent: while it is held, the
 * path meets it where it met it last, as long as it leads there. */
static bool still_met(const vista_obstacle_map_params *params, const vista_flight_path *path, const vista_track *track,
                      int32_t members) {
  if (!track->plain || !track->met || members < 2) return false;
  double there_m[3], off_m[3];
  vista_flight_path_nearest(path, track->met_m, there_m);
  for (int i = 0; i < 3; ++i) off_m[i] = track->met_m[i] - there_m[i];
  return vista_norm(off_m) <= params->collision_radius_m;
}

/* Without a detection: the last ellipse, moved to the predicted centre and scaled with the range. */
static vista_ellipse ellipse_of(const vista_track *track, const double measurement_px[3], double depth_m) {
  vista_ellipse ellipse = track->ellipse;
  if (!track->coasting && !track->followed) return ellipse;
  const double scale = track->ellipse_depth_m / depth_m;
  ellipse.center_u_px = measurement_px[0];
  ellipse.center_v_px = measurement_px[1];
  ellipse.axis_a_px *= scale;
  ellipse.axis_b_px *= scale;
  return ellipse;
}

/* False: behind the camera. */
static bool obstacle_of(const vista_obstacle_map_params *params, const vista_camera *camera, const vista_pose *pose,
                        const vista_flight_path *path, double speed_m_s, const vista_track *track,
                        vista_obstacle *obstacle) {
  double camera_m[3], measurement_px[3], jacobian_camera[9], jacobian[9], covariance_px2[9];
  vista_frame_to_camera(pose, track->position_m, camera_m);
  if (!(camera_m[2] > DEPTH_MIN_M)) return false;
  *obstacle = (vista_obstacle){.id = track->id,
                               .confirmed = track->confirmed && track->world.verdict != VISTA_WORLD_REFUTED,
                               .coasting = track->coasting,
                               .in_blind_zone = track->in_blind_zone,
                               .world = track->world.verdict,
                               .age_frames = track->age_frames,
                               .distance_m = vista_norm(camera_m),
                               .extent_m = {track->extent_m[0], track->extent_m[1]}};
  const double behind = thickness_m(params, track) / obstacle->distance_m;
  for (int i = 0; i < 3; ++i)
    obstacle->position_m[i] = track->position_m[i] + behind * (track->position_m[i] - pose->translation_m[i]);
  obstacle->distance_m *= 1.0 + behind;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) obstacle->covariance_m2[3 * i + j] = track->covariance[6 * i + j];
  vista_frame_measure(camera, camera_m, measurement_px, jacobian_camera);
  vista_frame_jacobian_to_world(pose, jacobian_camera, jacobian);
  vista_frame_propagate(jacobian, obstacle->covariance_m2, covariance_px2);
  steady_covariance(track, pose, camera_m, obstacle->covariance_m2);
  double lasting_m2[9];
  lasting_covariance(params, camera, pose, track, camera_m, lasting_m2);
  for (int i = 0; i < 9; ++i) obstacle->covariance_m2[i] += lasting_m2[i];
  obstacle->disparity_px = measurement_px[2];
  obstacle->ellipse = ellipse_of(track, measurement_px, camera_m[2]);
  const int32_t members = track->misses > MISSES_MAX ? 0 : vista_window_count(track->volume_window, 3);
  const bool undetected = (track->coasting || track->followed) && track->parts == 0;
  obstacle->in_collision_volume = track->credible && members >= (track->hits > 1 ? 2 : 1);
  const bool own_pixels = !undetected && !track->edges_only; /* tell whether it is a member; else its disc does */
  if (!track->credible || (own_pixels && obstacle->in_collision_volume)) return true;
  const vista_disc disc = disc_of(params, camera, pose, track, covariance_px2, camera_m[2]);
  obstacle->in_collision_volume =
      obstacle->in_collision_volume
          ? vista_flight_path_near_disc(path, &disc, likely_radius_m(params, path, disc.center_m)) ||
                still_met(params, path, track, members)
          : motion_is_seen(track) &&
                (about_to_enter(params, path, track, &disc) || will_meet(params, path, speed_m_s, track));
  return true;
}

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
static vista_obstacle too_near(const vista_obstacle_map_params *params, const vista_camera *camera,
                               const vista_flight_path *path, double range_m) {
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

/* Whether its own points have told where the path meets it, and it is so large that this counts: by its extent, or by
 * its last detection, which an extent that began as that of a part takes long to follow. */
static bool is_touched(const vista_camera *camera, const vista_track *track) {
  double half_px[2];
  vista_ellipse_half_box(&track->ellipse, &half_px[0], &half_px[1]);
  const double seen_m = 2.0 * fmax(half_px[0], half_px[1]) * track->ellipse_depth_m / camera->focal_px;
  return track->met && fmax(fmax(track->extent_m[0], track->extent_m[1]), seen_m) > COMPACT_M;
}

/* Share from 0, for what is met between its middle and its point closest to the path, to 1, for what is met in it. */
static double large(double extent_m) { return fmin(fmax((extent_m - COMPACT_M) / (LARGE_M - COMPACT_M), 0.0), 1.0); }

/* The volume is round: relief of a surface decides which of the points around the middle of the contact it touches
 * first. */
static double face_sigma_m(double half_m, double radius_m) {
  return fmin(half_m / VISTA_SQRT_3, sqrt(2.0 * radius_m * RELIEF_M));
}

/* The point of a thing that the path meets, where its own points have not told: of a rectangle of its extent that faces
 * the camera, and along both of its sides the standard deviation of which one that is. The path meets a wall where it
 * leads to; what it meets of a board whose post is not seen may be its middle, its edge or the post. */
static void move_to_path(const vista_pose *pose, const vista_flight_path *path, const double extent_m[2],
                         double radius_m, double position_m[3], double sigma_m[2]) {
  double there_m[3], offset_m[3];
  vista_flight_path_nearest(path, position_m, there_m);
  for (int i = 0; i < 3; ++i) offset_m[i] = there_m[i] - position_m[i];
  for (int axis = 0; axis < 2; ++axis) {
    const double half_m = 0.5 * extent_m[axis], share = 0.5 + 0.5 * large(extent_m[axis]);
    double aside_m = 0.0;
    for (int i = 0; i < 3; ++i) aside_m += offset_m[i] * pose->rotation[3 * i + axis];
    const double step_m = fmin(fmax(aside_m, -half_m), half_m);
    for (int i = 0; i < 3; ++i) position_m[i] += share * step_m * pose->rotation[3 * i + axis];
    const double end_m = fabs(aside_m) > half_m ? END_SHARE * half_m : 0.0;
    sigma_m[axis] =
        sqrt(vista_square((1.0 - share) * step_m) + vista_square(face_sigma_m(half_m, radius_m)) + vista_square(end_m));
  }
}

/* Adds what is uncertain along x and y of the camera. */
static void add_across(const vista_pose *pose, const double sigma_m[2], double covariance_m2[9]) {
  const double *const r = pose->rotation;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      for (int axis = 0; axis < 2; ++axis)
        covariance_m2[3 * i + j] += vista_square(sigma_m[axis]) * r[3 * i + axis] * r[3 * j + axis];
}

/* Replaces the variance along the line of sight by that of the range of the thing's own points. It is for things whose
 * points tell where they are met: the range then comes from these points, and not from the filter of the middle. */
static void set_along_sight(const vista_pose *pose, const double point_m[3], double sigma_m, double covariance_m2[9]) {
  double sight[3], from[9], across[9];
  for (int i = 0; i < 3; ++i) sight[i] = point_m[i] - pose->translation_m[i];
  const double range_m = vista_norm(sight);
  for (int i = 0; i < 3; ++i) sight[i] /= range_m;
  for (int i = 0; i < 9; ++i) across[i] = (i % 4 == 0) - sight[i / 3] * sight[i % 3];
  memcpy(from, covariance_m2, sizeof from);
  vista_frame_propagate(across, from, covariance_m2);
  for (int i = 0; i < 9; ++i) covariance_m2[i] += vista_square(sigma_m) * sight[i / 3] * sight[i % 3];
}

/* track: NULL for what has none and stands. What is large is met in its surface, not in the middle behind it. */
static vista_nearest_collision collision_with(const vista_obstacle_map_params *params, const vista_camera *camera,
                                              const vista_obstacle *obstacle, const vista_track *track,
                                              const vista_flight_path *path, const vista_motion *motion) {
  vista_nearest_collision nearest = {.valid = true, .id = obstacle->id};
  memcpy(nearest.position_m, obstacle->position_m, sizeof nearest.position_m);
  memcpy(nearest.covariance_m2, obstacle->covariance_m2, sizeof nearest.covariance_m2);
  double sigma_m[2];
  if (track != NULL && is_touched(camera, track)) {
    memcpy(nearest.position_m, track->met_m, sizeof nearest.position_m);
    if (!track->plain) set_along_sight(&motion->pose, track->met_m, track->met_sigma_m, nearest.covariance_m2);
    for (int i = 0; i < 2; ++i) sigma_m[i] = face_sigma_m(0.5 * obstacle->extent_m[i], params->collision_radius_m);
  } else if (track != NULL) {
    const double surface = large(fmax(obstacle->extent_m[0], obstacle->extent_m[1]));
    for (int i = 0; i < 3; ++i) nearest.position_m[i] += surface * (track->position_m[i] - obstacle->position_m[i]);
    move_to_path(&motion->pose, path, obstacle->extent_m, params->collision_radius_m, nearest.position_m, sigma_m);
  }
  if (track != NULL) add_across(&motion->pose, sigma_m, nearest.covariance_m2);
  double there[3], from_camera_m[3];
  for (int i = 0; i < 3; ++i) from_camera_m[i] = nearest.position_m[i] - motion->pose.translation_m[i];
  nearest.distance_m = track != NULL ? vista_norm(from_camera_m) : obstacle->distance_m;
  const double along_m = vista_flight_path_along(path, nearest.position_m, there);
  double closing_m_s = vista_dot(motion->velocity_m_s, motion->direction);
  if (track != NULL) closing_m_s -= vista_dot(track->velocity_m_s, there);
  nearest.time_to_collision_s = closing_m_s > params->closing_min_m_s ? fmax(0.0, along_m) / closing_m_s : NAN;
  return nearest;
}

/* What is in the way at the same range may be another part of one thing, such as the posts of a fence or of a sign:
 * which of them is met first is as uncertain as they are apart. */
static void allow_for_parts(const vista_pose *pose, const vista_obstacle *obstacles, int32_t count,
                            vista_nearest_collision *nearest) {
  if (!nearest->valid || nearest->id <= 0) return;
  double from_camera_m[3], sigma_m[2] = {0.0, 0.0}, along2 = 0.0;
  for (int i = 0; i < 3; ++i) from_camera_m[i] = nearest->position_m[i] - pose->translation_m[i];
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) along2 += from_camera_m[i] * nearest->covariance_m2[3 * i + j] * from_camera_m[j];
  const double reach_m = SAME_RANGE_M + 3.0 * sqrt(along2) / nearest->distance_m;
  for (int32_t k = 0; k < count; ++k) {
    const vista_obstacle *const o = &obstacles[k];
    if (o->id <= 0 || o->id == nearest->id || !o->confirmed || !o->in_collision_volume ||
        fabs(o->distance_m - nearest->distance_m) > reach_m)
      continue;
    for (int axis = 0; axis < 2; ++axis) {
      double apart_m = 0.0;
      for (int i = 0; i < 3; ++i) apart_m += (o->position_m[i] - nearest->position_m[i]) * pose->rotation[3 * i + axis];
      sigma_m[axis] = fmax(sigma_m[axis], fabs(apart_m) / VISTA_SQRT_3);
    }
  }
  add_across(pose, sigma_m, nearest->covariance_m2);
}

static vista_status check(const vista_obstacle_map *map, const vista_obstacle_map_params *params,
                          const vista_camera *camera, const vista_motion *motion, const vista_track *tracks,
                          int32_t track_count) {
  if (track_count < 0) return VISTA_ERROR_SIZE;
  if (track_count > map->max_tracks) return VISTA_ERROR_CAPACITY;
  vista_status status = VISTA_CHECK_SECTION(obstacle_map, params);
  if (status == VISTA_OK) status = vista_frame_check_camera(camera);
  if (status == VISTA_OK) status = vista_frame_check_pose(&motion->pose);
  if (status != VISTA_OK) return status;
  if (!isfinite(vista_norm(motion->velocity_m_s) + vista_norm(motion->direction))) return VISTA_ERROR_NUMBER;
  for (int32_t i = 0; i < track_count; ++i)
    if (!isfinite(vista_norm(tracks[i].position_m))) return VISTA_ERROR_NUMBER;
  return VISTA_OK;
}

vista_status vista_obstacle_map_update(vista_obstacle_map *map, const vista_obstacle_map_params *params,
                                       const vista_camera *camera, const vista_motion *motion,
                                       const vista_flight_path *path, const vista_blind_zone *blind_zone,
                                       const vista_terrain *terrain, const vista_track *tracks, int32_t track_count) {
  if (map == NULL || params == NULL || camera == NULL || motion == NULL || path == NULL ||
      (tracks == NULL && track_count != 0))
    return VISTA_ERROR_ARGUMENT;
  const vista_status status = check(map, params, camera, motion, tracks, track_count);
  if (status != VISTA_OK) return status;
  vista_obstacle_map_reset(map);
  vista_obstacle ground;
  const bool ahead =
      terrain != NULL && terrain->ahead && vista_terrain_obstacle(camera, &motion->pose, path, terrain, &ground);
  const bool warned = ahead && ground.confirmed && ground.in_collision_volume;
  if (ahead) insert(map, &ground);
  if (warned) map->nearest = collision_with(params, camera, &ground, NULL, path, motion);
  bool shown = warned && !ground.coasting; /* by the nearest collision: it is seen, beyond what would hide it */
  for (int32_t i = 0; i < track_count; ++i) {
    vista_obstacle obstacle;
    if (!obstacle_of(params, camera, &motion->pose, path, motion->speed_m_s, &tracks[i], &obstacle)) continue;
    if (warned && (vista_terrain_bears(terrain, &obstacle, obstacle.position_m) ||
                   (is_touched(camera, &tracks[i]) && vista_terrain_bears(terrain, &obstacle, tracks[i].met_m))))
      obstacle.in_collision_volume = false; /* what is met of it is said */
    insert(map, &obstacle);
    if (!obstacle.confirmed || !obstacle.in_collision_volume) continue;
    shown |= !obstacle.coasting;
    const vista_nearest_collision met = collision_with(params, camera, &obstacle, &tracks[i], path, motion);
    if (!map->nearest.valid || met.distance_m < map->nearest.distance_m) map->nearest = met;
  }
  allow_for_parts(&motion->pose, map->obstacles, map->count, &map->nearest);
  if (blind_zone == NULL || !blind_zone->occupied) return VISTA_OK;
  const vista_obstacle obstacle = too_near(params, camera, path, blind_zone->range_m);
  insert(map, &obstacle);
  if (!shown && !(map->nearest.valid && map->nearest.distance_m < obstacle.distance_m))
    map->nearest = collision_with(params, camera, &obstacle, NULL, path, motion);
  return VISTA_OK;
}
