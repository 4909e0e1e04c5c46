#include "follow/track_filter.h"

#include <math.h>

#include "common/frame.h"
#include "common/numbers.h"
#include "common/symmetric.h"

#define ACCELERATION_PSD_M2_S3 0.01 /* white acceleration along each axis: obstacles are mostly static */
/* Random walk of the point that stands for the obstacle: regions change from frame to frame. */
#define POSITION_PSD_M2_S 0.01
#define EXTENT_SIGMA_RATIO 0.3 /* noise of the natural logarithm of a measured width or height */
#define EXTENT_PSD_1_S 0.02 /* random walk of the logarithm of width and height */
#define MET_WEIGHT 0.4 /* of a new detection's point that the path meets: it is a mean over a few frames */
#define MET_LINE_PX 1.5 /* of disparity, that a line and what is met around it may differ by */
#define EXTENT_CLIP_SIGMA 3.0 /* one wrong region must not resize a track */

static double extent_noise(const vista_detection *detection) {
  return vista_square(EXTENT_SIGMA_RATIO) + vista_square(detection->sigma_disparity_px / detection->disparity_px);
}

/* A line is met where it is. What an earlier region told around it holds no longer when that is at another range. */
static bool contradicts(const vista_pose *pose, const vista_detection *line, const double met_m[3]) {
  double camera_m[3];
  vista_frame_to_camera(pose, met_m, camera_m);
  const double met_px = line->disparity_px * line->position_camera_m[2] / camera_m[2];
  return !(camera_m[2] > 0.0) || fabs(met_px - line->disparity_px) > MET_LINE_PX;
}

void vista_track_filter_meet(const vista_pose *pose, const vista_detection *detection, vista_track *track) {
  if (track->met && detection->line && contradicts(pose, detection, track->met_m)) track->met = false;
  if (!detection->met) return;
  double met_m[3];
  vista_frame_to_world(pose, detection->met_camera_m, met_m);
  const double weight = track->met ? MET_WEIGHT : 1.0;
  for (int i = 0; i < 3; ++i) track->met_m[i] += weight * (met_m[i] - track->met_m[i]);
  track->met_sigma_m += weight * (detection->met_sigma_m - track->met_sigma_m);
  track->met = true;
}

double vista_track_lasting_sigma_m(const vista_detection *detection) {
  return detection->position_camera_m[2] * detection->lasting_sigma_px / detection->disparity_px;
}

void vista_track_filter_start(const vista_tracker_params *params, const vista_camera *camera, const vista_pose *pose,
                              const vista_detection *detection, vista_track *track) {
  *track = (vista_track){.label = detection->label,
                         .hits = 1,
                         .seen_frames = 1,
                         .window = 1,
                         .plain = detection->plain,
                         .lasting_sigma_m = vista_track_lasting_sigma_m(detection),
                         .volume_window = detection->volume_pixels >= VISTA_VOLUME_PIXELS,
                         .ellipse = detection->ellipse,
                         .ellipse_depth_m = camera->focal_px * camera->baseline_m / detection->disparity_px};
  double covariance_camera[9];
  for (int i = 0; i < 9; ++i) covariance_camera[i] = detection->covariance_camera_m2[i];
  const double attitude_m2 =
      vista_square(detection->position_camera_m[2] * params->attitude_sigma_deg * VISTA_RADIANS_PER_DEGREE);
  covariance_camera[0] += attitude_m2;
  covariance_camera[4] += attitude_m2;
  double covariance_world[9];
  vista_frame_covariance_to_world(pose, covariance_camera, covariance_world);
  vista_frame_to_world(pose, detection->position_camera_m, track->position_m);
  vista_track_filter_meet(pose, detection, track);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) track->covariance[6 * i + j] = covariance_world[3 * i + j];
    track->covariance[6 * (i + 3) + i + 3] = vista_square(params->velocity_sigma_m_s);
  }
  for (int i = 0; i < 2; ++i) {
    track->extent_m[i] = detection->extent_m[i];
    track->extent_variance[i] = extent_noise(detection);
  }
}

/* x' = F x, P' = F P F^T + Q with F = [I, dt I; 0, I] and, for white acceleration of density q and a random walk of
 * the position of density w, Q = [q dt^3/3 + w dt, q dt^2/2; q dt^2/2, q dt] (x) I. */
void vista_track_filter_predict(double dt_s, vista_track *track) {
  double *p = track->covariance;
  const double q = ACCELERATION_PSD_M2_S3;
  for (int i = 0; i < 3; ++i) track->position_m[i] += dt_s * track->velocity_m_s[i];
  if (!track->plain) /* a wall stands: what its velocity seems to be is a bias that changes on the way */
    for (int i = 0; i < 3; ++i) track->met_m[i] += dt_s * track->velocity_m_s[i];
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 6; ++j) p[6 * i + j] += dt_s * p[6 * (i + 3) + j]; /* F P */
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 3; ++j) p[6 * i + j] += dt_s * p[6 * i + j + 3]; /* (F P) F^T */
  for (int i = 0; i < 3; ++i) {
    p[6 * i + i] += q * dt_s * dt_s * dt_s / 3.0 + POSITION_PSD_M2_S * dt_s;
    p[6 * i + i + 3] += q * dt_s * dt_s / 2.0;
    p[6 * (i + 3) + i] += q * dt_s * dt_s / 2.0;
    p[6 * (i + 3) + i + 3] += q * dt_s;
  }
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < i; ++j) p[6 * i + j] = p[6 * j + i] = 0.5 * (p[6 * i + j] + p[6 * j + i]);
  for (int i = 0; i < 2; ++i) track->extent_variance[i] += EXTENT_PSD_1_S * dt_s;
}

/* P += sigma^2 [t^2, t; t, 1] (x) I */
void vista_track_filter_set_moving(const vista_tracker_params *params, double since_s, vista_track *track) {
  const double variance = vista_square(params->moving_sigma_m_s);
  for (int i = 0; i < 3; ++i) {
    track->covariance[6 * i + i] += variance * since_s * since_s;
    track->covariance[6 * i + i + 3] += variance * since_s;
    track->covariance[6 * (i + 3) + i] += variance * since_s;
    track->covariance[6 * (i + 3) + i + 3] += variance;
  }
}

void vista_track_filter_view(const vista_tracker_params *params, const vista_camera *camera, const vista_pose *pose,
                             double since_s, const vista_track *track, vista_track_view *view) {
  double jacobian_camera[9];
  vista_frame_to_camera(pose, track->position_m, view->camera_m);
  vista_frame_measure(camera, view->camera_m, view->measurement_px, jacobian_camera);
  vista_frame_jacobian_to_world(pose, jacobian_camera, view->jacobian);
  double position_covariance[9];
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) position_covariance[3 * i + j] = track->covariance[6 * i + j];
  vista_frame_propagate(view->jacobian, position_covariance, view->covariance_px2);
  for (int i = 0; i < 3; ++i) position_covariance[4 * i] += vista_square(params->moving_sigma_m_s * since_s);
  vista_frame_propagate(view->jacobian, position_covariance, view->moved_covariance_px2);
  for (int i = 0; i < 2; ++i) view->half_px[i] = 0.5 * track->extent_m[i] * camera->focal_px / view->camera_m[2];
}

void vista_track_filter_noise(const vista_tracker_params *params, const vista_camera *camera,
                              const vista_detection *detection, const vista_track_view *view, bool reshaped,
                              double variance_px2[3]) {
  const double attitude_px2 = vista_square(camera->focal_px * params->attitude_sigma_deg * VISTA_RADIANS_PER_DEGREE);
  variance_px2[0] =
      vista_square(detection->sigma_u_px) + attitude_px2 + (reshaped ? vista_square(view->half_px[0]) : 0.0);
  variance_px2[1] =
      vista_square(detection->sigma_v_px) + attitude_px2 + (reshaped ? vista_square(view->half_px[1]) : 0.0);
  variance_px2[2] = vista_square(detection->sigma_disparity_px);
}

static double quadratic(const double matrix[9], const double y[3]) {
  double sum = 0.0;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) sum += y[i] * matrix[3 * i + j] * y[j];
  return sum;
}

/* S = H P H^T + R */
static bool invert_innovation(const double covariance_px2[9], const double variance_px2[3], double inverse[9]) {
  for (int i = 0; i < 9; ++i) inverse[i] = covariance_px2[i] + (i % 4 == 0 ? variance_px2[i / 4] : 0.0);
  return vista_symmetric_invert(3, inverse);
}

static void innovation(const vista_track_view *view, const vista_detection *detection, double y[3]) {
  y[0] = detection->u_px - view->measurement_px[0];
  y[1] = detection->v_px - view->measurement_px[1];
  y[2] = detection->disparity_px - view->measurement_px[2];
}

double vista_track_filter_distance2(const vista_track_view *view, const double covariance_px2[9],
                                    const vista_detection *detection, const double variance_px2[3]) {
  double inverse[9], y[3];
  if (!invert_innovation(covariance_px2, variance_px2, inverse)) return INFINITY;
  innovation(view, detection, y);
  return quadratic(inverse, y);
}

double vista_track_filter_space_distance2(const vista_tracker_params *params, const vista_pose *pose,
                                          const vista_track *track, const vista_track_view *view,
                                          const vista_detection *detection) {
  double camera_from_world[9], position_world[9], s[9], y[3];
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      camera_from_world[3 * i + j] = pose->rotation[3 * j + i];
      position_world[3 * i + j] = track->covariance[6 * i + j];
    }
  vista_frame_propagate(camera_from_world, position_world, s);
  const double attitude_m2 =
      vista_square(detection->position_camera_m[2] * params->attitude_sigma_deg * VISTA_RADIANS_PER_DEGREE);
  for (int i = 0; i < 9; ++i) s[i] += detection->covariance_camera_m2[i] + (i == 0 || i == 4 ? attitude_m2 : 0.0);
  for (int i = 0; i < 3; ++i) y[i] = detection->position_camera_m[i] - view->camera_m[i];
  return vista_symmetric_invert(3, s) ? quadratic(s, y) : INFINITY;
}

double vista_track_filter_extent_distance2(const vista_track *track, const vista_detection *detection) {
  const bool cut[2] = {detection->cut_u, detection->cut_v};
  double sum = 0.0;
  for (int i = 0; i < 2; ++i)
    if (!cut[i])
      sum += vista_square(log(detection->extent_m[i] / track->extent_m[i])) /
             (track->extent_variance[i] + extent_noise(detection));
  return sum;
}

static void update_extent(const vista_detection *detection, vista_track *track) {
  const bool cut[2] = {detection->cut_u, detection->cut_v};
  for (int i = 0; i < 2; ++i) {
    const double difference = log(detection->extent_m[i] / track->extent_m[i]);
    if (cut[i] && difference < 0.0) continue; /* a lower bound that is met says nothing */
    const double noise = extent_noise(detection);
    const double variance = track->extent_variance[i] + noise;
    const double clip = EXTENT_CLIP_SIGMA * sqrt(variance);
    const double gain = track->extent_variance[i] / variance;
    track->extent_m[i] *= exp(gain * fmin(clip, fmax(-clip, difference)));
    track->extent_variance[i] *= 1.0 - gain;
  }
}

/* K = P H^T S^-1; x += K y; P = (I - K H) P (I - K H)^T + K R K^T, H = [J, 0]. */
void vista_track_filter_update(const vista_track_view *view, const vista_detection *detection,
                               const double variance_px2[3], vista_track *track) {
  double inverse[9], y[3];
  update_extent(detection, track);
  if (!invert_innovation(view->covariance_px2, variance_px2, inverse)) return;
  innovation(view, detection, y);
  double pht[18], gain[18], kept[36], half[36];
  double *p = track->covariance;
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 3; ++j) {
      double sum = 0.0;
      for (int k = 0; k < 3; ++k) sum += p[6 * i + k] * view->jacobian[3 * j + k];
      pht[3 * i + j] = sum;
    }
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 3; ++j) {
      double sum = 0.0;
      for (int k = 0; k < 3; ++k) sum += pht[3 * i + k] * inverse[3 * k + j];
      gain[3 * i + j] = sum;
    }
  for (int i = 0; i < 6; ++i) {
    double correction = 0.0;
    for (int k = 0; k < 3; ++k) correction += gain[3 * i + k] * y[k];
    if (i < 3)
      track->position_m[i] += correction;
    else
      track->velocity_m_s[i - 3] += correction;
    for (int j = 0; j < 6; ++j) {
      double sum = i == j;
      for (int k = 0; k < 3 && j < 3; ++k) sum -= gain[3 * i + k] * view->jacobian[3 * k + j];
      kept[6 * i + j] = sum; /* I - K H */
    }
  }
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) {
      double sum = 0.0;
      for (int k = 0; k < 6; ++k) sum += kept[6 * i + k] * p[6 * k + j];
      half[6 * i + j] = sum;
    }
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j <= i; ++j) {
      double sum = 0.0;
      for (int k = 0; k < 6; ++k) sum += half[6 * i + k] * kept[6 * j + k];
      for (int k = 0; k < 3; ++k) sum += gain[3 * i + k] * variance_px2[k] * gain[3 * j + k];
      p[6 * i + j] = p[6 * j + i] = sum;
    }
}
