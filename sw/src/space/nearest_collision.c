#include "space/nearest_collision.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#include "common/ellipse.h"
#include "common/flight_path.h"
#include "common/frame.h"
#include "common/numbers.h"
#include "vista/parameters.h"
#include "vista/types.h"

#define CLOSING_MIN_M_S 0.5 /* no time to collision is given for what closes slower */
#define COMPACT_M 3.0    /* A side up to this is met anywhere between its middle and the point closest to the path, */
#define LARGE_M 4.5      /* and a side from this on is met in that point. */
#define END_SHARE 0.2    /* The end of a side is known to this share of half of it, */
#define RELIEF_M 0.1     /* and the depth of a surface to this. */
#define SAME_RANGE_M 1.0 /* Things that differ in range by less, or by three standard deviations, may be one thing. */

bool vista_track_is_touched(const vista_frame_view *frame, const vista_track *track) {
  double half_px[2];
  vista_ellipse_half_box(&track->ellipse, &half_px[0], &half_px[1]);
  const double seen_m = 2.0 * fmax(half_px[0], half_px[1]) * track->ellipse_depth_m / frame->camera->focal_px;
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
static void move_to_path(const vista_frame_view *frame, const double extent_m[2], double position_m[3],
                         double sigma_m[2]) {
  const vista_pose *const pose = &frame->motion.pose;
  const double radius_m = frame->params->obstacle_map.collision_radius_m;
  double there_m[3], offset_m[3];
  vista_flight_path_nearest(&frame->path, position_m, there_m);
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

/* Replaces the variance along the line of sight, which the filter has for the middle of a thing, by that of the point
 * where the thing's own pixels show that it is met. */
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

vista_nearest_collision vista_nearest_collision_with(const vista_frame_view *frame, const vista_obstacle *obstacle,
                                                     const vista_track *track) {
  const vista_obstacle_map_params *const params = &frame->params->obstacle_map;
  const vista_motion *const motion = &frame->motion;
  vista_nearest_collision nearest = {.valid = true, .id = obstacle->id};
  memcpy(nearest.position_m, obstacle->position_m, sizeof nearest.position_m);
  memcpy(nearest.covariance_m2, obstacle->covariance_m2, sizeof nearest.covariance_m2);
  double sigma_m[2];
  if (track != NULL && vista_track_is_touched(frame, track)) {
    memcpy(nearest.position_m, track->met_m, sizeof nearest.position_m);
    if (!track->plain) set_along_sight(&motion->pose, track->met_m, track->met_sigma_m, nearest.covariance_m2);
    for (int i = 0; i < 2; ++i) sigma_m[i] = face_sigma_m(0.5 * obstacle->extent_m[i], params->collision_radius_m);
  } else if (track != NULL) {
    const double surface = large(fmax(obstacle->extent_m[0], obstacle->extent_m[1]));
    for (int i = 0; i < 3; ++i) nearest.position_m[i] += surface * (track->position_m[i] - obstacle->position_m[i]);
    move_to_path(frame, obstacle->extent_m, nearest.position_m, sigma_m);
  }
  if (track != NULL) add_across(&motion->pose, sigma_m, nearest.covariance_m2);
  double there[3], from_camera_m[3];
  for (int i = 0; i < 3; ++i) from_camera_m[i] = nearest.position_m[i] - motion->pose.translation_m[i];
  nearest.distance_m = track != NULL ? vista_norm(from_camera_m) : obstacle->distance_m;
  const double along_m = vista_flight_path_along(&frame->path, nearest.position_m, there);
  double closing_m_s = vista_dot(motion->velocity_m_s, motion->direction);
  if (track != NULL) closing_m_s -= vista_dot(track->velocity_m_s, there);
  nearest.time_to_collision_s = closing_m_s > CLOSING_MIN_M_S ? fmax(0.0, along_m) / closing_m_s : NAN;
  return nearest;
}

void vista_nearest_collision_allow_for_parts(const vista_pose *pose, const vista_obstacle *obstacles, int32_t count,
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
