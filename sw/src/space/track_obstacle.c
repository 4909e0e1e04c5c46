#include "space/track_obstacle.h"

#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include "common/bits.h"
#include "common/disc.h"
#include "common/flight_path.h"
#include "common/frame.h"
#include "common/numbers.h"
#include "follow/static_world.h"
#include "vista/parameters.h"
#include "vista/types.h"

/* Error of an obstacle's disparity that lasts from frame to frame: no filter averages it out. */
#define LASTING_DISPARITY_PX 0.02
/* The same in depth, of the surface that the region's boundary shows: the larger part near the camera. */
#define LASTING_RANGE_M 0.02
#define LASTING_CENTER_PX 0.6 /* the same of its centre: matching widens a thing more to one side than to the other */
/* The same of half of what its longer side has more than twice the shorter one: a region may lack the end of a long thing. */
#define LASTING_CENTER_RATIO 0.35
/* Of the scatter of its detections beyond what noise explains: a region that wanders may be wrong for long. */
#define LASTING_SCATTER 0.3
#define LONG_RATIO 2.0 /* A side is long if it is more than so many times the other one. */
#define THICK_MAX_M 1.0 /* Larger things are walls and the like: how wide they are does not tell how deep they are. */
#define STEADY_MIN 0.25 /* The variance falls to this share at least: ten hits do not show more. */
#define MISSES_MAX 2 /* After more misses in a row something else is seen in the place of what is warned of. */

/* Something is seen to move across the path above this speed, and above so many standard deviations of it; it counts as
 * in the volume when it will be there within this time. */
#define ACROSS_M_S 0.5
#define ACROSS_SIGMAS 3.0
#define ACROSS_S 0.5

/* How sure it has to be that something flies and meets the aircraft. */
typedef struct meeting {
  int32_t hits;
  double speed_m_s, sigmas; /* that it moves across the path, at least */
  double doubt; /* standard deviations of where it will be, which the volume is wider by */
  double ahead_s; /* at most */
} meeting;

#define MEET_STEPS 60

/* To warn of it: of what may only seem to move more is asked than of what is about to enter the volume, and the later
 * both meet, the less certain that is, so the volume is narrower. */
static meeting warned_of(const vista_obstacle_map_params *params) {
  return (meeting){
      .hits = 6, .speed_m_s = 1.0, .sigmas = 5.0, .doubt = -params->path_sigmas, .ahead_s = params->meet_s};
}

/* Not to call the path free where both may meet. */
static const meeting not_free = {.hits = 3, .speed_m_s = 0.5, .sigmas = 2.0, .doubt = 2.0, .ahead_s = 6.0};

/* A thing stands if its foot is, on average over at least so many hits, lower than this share of the camera's height. */
#define FOOT_HITS 2.5
#define FOOT_STANDS 0.15

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
static void lasting_covariance(const vista_frame_view *frame, const vista_track *track, const double camera_m[3],
                               double covariance_m2[9]) {
  const vista_camera *const camera = frame->camera;
  const double fb = camera->focal_px * camera->baseline_m, z = camera_m[2];
  const double share = vista_square(LASTING_SCATTER);
  const double disparity_px =
      sqrt(vista_square(LASTING_DISPARITY_PX) + share * excess_px2(track, 2) + fmax(track->lasting_px2[2], 0.0));
  const double own_m =
      hypot(z * z / fb * disparity_px, LASTING_RANGE_M + thickness_m(&frame->params->obstacle_map, track));
  const double range_m = hypot(own_m, track->lasting_sigma_m);
  const double ray[3] = {camera_m[0] / z, camera_m[1] / z, 1.0};
  double in_camera[9];
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) in_camera[3 * i + j] = range_m * range_m * ray[i] * ray[j];
  for (int i = 0; i < 2; ++i) {
    const double center_px =
        sqrt(vista_square(LASTING_CENTER_PX) + share * excess_px2(track, i) + fmax(track->lasting_px2[i], 0.0));
    const double pixels_m = center_px * z / camera->focal_px;
    const double longer_m = fmax(track->extent_m[i] - LONG_RATIO * fmin(track->extent_m[0], track->extent_m[1]), 0.0);
    const double share_m = 0.5 * LASTING_CENTER_RATIO * longer_m;
    in_camera[4 * i] += pixels_m * pixels_m + share_m * share_m;
  }
  vista_frame_covariance_to_world(&frame->motion.pose, in_camera, covariance_m2);
}

/* Of the collision volume, where that is: as narrow as its pixels are asked for (collision_volume.h). */
static double likely_radius_m(const vista_obstacle_map_params *params, const vista_flight_path *path,
                              const double position_m[3]) {
  const double along_m = fmin(fmax(vista_flight_path_along(path, position_m, NULL), 0.0), path->length_m);
  return vista_flight_path_likely_radius_m(path, along_m, params->collision_radius_m, params->path_sigmas);
}

/* Facing the camera, half the extent inflated by the standard deviation of the bearing: sigma_u Z / f across. */
static vista_disc disc_of(const vista_frame_view *frame, const vista_track *track, const double covariance_px2[9],
                          double depth_m) {
  const vista_pose *const pose = &frame->motion.pose;
  const double inflation = frame->params->obstacle_map.inflation_sigma * depth_m / frame->camera->focal_px;
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
  for (int i = 0; i < 3; ++i) soon.center_m[i] += ACROSS_S * across[i];
  return vista_flight_path_near_disc(path, &soon, params->collision_radius_m);
}

/* Whether the thing stands: the foot of its region was hardly ever seen to hang in the air. Nothing else tells as surely
 * that a thing flies. */
static bool seen_to_stand(const vista_track *track) {
  const vista_static_world *const w = &track->world;
  return w->foot_count >= FOOT_HITS && w->foot_share <= FOOT_STANDS * w->foot_count;
}

/* Whether a thing that flies and the aircraft meet, both going on as they do. */
static bool meets(const vista_obstacle_map_params *params, const vista_flight_path *path, double speed_m_s,
                  const vista_track *track, const meeting *asked) {
  if (track->hits < asked->hits || track->plain || seen_to_stand(track)) return false;
  double ahead[3], across[3];
  (void)vista_flight_path_along(path, track->position_m, ahead);
  const double variance = velocity_across(track, ahead, across);
  const double speed2 = vista_dot(across, across);
  if (speed2 <= vista_square(asked->speed_m_s) || speed2 <= vista_square(asked->sigmas) * variance) return false;
  for (int k = 0; k <= MEET_STEPS; ++k) {
    const double t_s = asked->ahead_s * k / MEET_STEPS, along_m = speed_m_s * t_s;
    if (along_m > path->length_m) return false;
    double there_m[3], off_m[3];
    vista_flight_path_point(path, along_m, there_m, NULL);
    for (int i = 0; i < 3; ++i) off_m[i] = track->position_m[i] + t_s * track->velocity_m_s[i] - there_m[i];
    const double doubt_m = asked->doubt * t_s * sqrt(0.5 * variance);
    const double likely_m =
        vista_flight_path_likely_radius_m(path, along_m, params->collision_radius_m, params->path_sigmas) + doubt_m;
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

/* Without a detection: the last ellipse, moved to where its middle is by now and scaled with the range. */
static vista_ellipse ellipse_of(const vista_frame_view *frame, const vista_track *track, double depth_m) {
  vista_ellipse ellipse = track->ellipse;
  if (!track->coasting && !track->followed) return ellipse;
  double seen_m[3], camera_m[3], measured_px[3];
  for (int i = 0; i < 3; ++i) seen_m[i] = track->position_m[i] + track->seen_off_m[i];
  vista_frame_to_camera(&frame->motion.pose, seen_m, camera_m);
  camera_m[2] = fmax(camera_m[2], VISTA_DEPTH_MIN_M);
  vista_frame_measure(frame->camera, camera_m, measured_px, NULL);
  const double scale = track->ellipse_depth_m / depth_m;
  ellipse.center_u_px = measured_px[0];
  ellipse.center_v_px = measured_px[1];
  ellipse.axis_a_px *= scale;
  ellipse.axis_b_px *= scale;
  return ellipse;
}

bool vista_track_obstacle(const vista_frame_view *frame, const vista_track *track, vista_obstacle *obstacle) {
  const vista_obstacle_map_params *const params = &frame->params->obstacle_map;
  const vista_pose *const pose = &frame->motion.pose;
  const vista_flight_path *const path = &frame->path;
  double camera_m[3], measurement_px[3], jacobian_camera[9], jacobian[9], covariance_px2[9];
  vista_frame_to_camera(pose, track->position_m, camera_m);
  if (!(camera_m[2] > VISTA_DEPTH_MIN_M)) return false;
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
  vista_frame_measure(frame->camera, camera_m, measurement_px, jacobian_camera);
  vista_frame_jacobian_to_world(pose, jacobian_camera, jacobian);
  vista_frame_propagate(jacobian, obstacle->covariance_m2, covariance_px2);
  steady_covariance(track, pose, camera_m, obstacle->covariance_m2);
  double lasting_m2[9];
  lasting_covariance(frame, track, camera_m, lasting_m2);
  for (int i = 0; i < 9; ++i) obstacle->covariance_m2[i] += lasting_m2[i];
  obstacle->disparity_px = measurement_px[2];
  obstacle->ellipse = ellipse_of(frame, track, camera_m[2]);
  const int32_t members = track->misses > MISSES_MAX ? 0 : vista_window_count(track->volume_window, 3);
  const bool undetected = track->coasting || track->followed;
  obstacle->in_collision_volume = track->credible && members >= (track->hits > 1 ? 2 : 1);
  const bool own_pixels = !undetected && !track->edges_only; /* tell whether it is a member; else its disc does */
  if (!track->credible || (own_pixels && obstacle->in_collision_volume)) return true;
  const vista_disc disc = disc_of(frame, track, covariance_px2, camera_m[2]);
  if (obstacle->in_collision_volume)
    obstacle->in_collision_volume =
        vista_flight_path_near_disc(path, &disc, likely_radius_m(params, path, disc.center_m)) ||
        still_met(params, path, track, members);
  return true;
}

bool vista_track_enters(const vista_frame_view *frame, const vista_track *track) {
  const vista_obstacle_map_params *const params = &frame->params->obstacle_map;
  const vista_pose *const pose = &frame->motion.pose;
  if (!track->credible || !motion_is_seen(track)) return false;
  double camera_m[3], measurement_px[3], jacobian_camera[9], jacobian[9], covariance_m2[9], covariance_px2[9];
  vista_frame_to_camera(pose, track->position_m, camera_m);
  for (int i = 0; i < 9; ++i) covariance_m2[i] = track->covariance[6 * (i / 3) + i % 3];
  vista_frame_measure(frame->camera, camera_m, measurement_px, jacobian_camera);
  vista_frame_jacobian_to_world(pose, jacobian_camera, jacobian);
  vista_frame_propagate(jacobian, covariance_m2, covariance_px2);
  const vista_disc disc = disc_of(frame, track, covariance_px2, camera_m[2]);
  const meeting asked = warned_of(params);
  return about_to_enter(params, &frame->path, track, &disc) ||
         meets(params, &frame->path, frame->motion.speed_m_s, track, &asked);
}

bool vista_track_may_enter(const vista_frame_view *frame, const vista_track *track) {
  return motion_is_seen(track) &&
         meets(&frame->params->obstacle_map, &frame->path, frame->motion.speed_m_s, track, &not_free);
}
