/* The filters of one track: position and velocity (EKF), width and height (scalar filters on the logarithm). */
#ifndef VISTA_TRACK_FILTER_H
#define VISTA_TRACK_FILTER_H

#include <stdbool.h>

#include "follow/tracker.h"
#include "perceive/region/reconstruction.h"
#include "vista/types.h"

/* What a track looks like in the current camera. */
typedef struct vista_track_view {
  double camera_m[3];
  double measurement_px[3];  /* predicted (u, v, d) */
  double jacobian[9];        /* d(u, v, d) / d position in world */
  double covariance_px2[9];  /* of measurement_px, by the track's position covariance alone */
  double moved_covariance_px2[9]; /* the same if it moved with any velocity since its only hit */
  double half_px[2];         /* projected half width, half height */
} vista_track_view;

/* Standard deviation of the range of a detection by where its foot is: 0 unless its outline alone tells it. */
double vista_track_lasting_sigma_m(const vista_detection *detection);

/* Takes over where the collision volume meets the thing, as the detection shows it. */
void vista_track_filter_meet(const vista_pose *pose, const vista_detection *detection, vista_track *track);

/* A new track at the detection, unconfirmed, without id and times. */
void vista_track_filter_start(const vista_tracker_params *params, const vista_camera *camera, const vista_pose *pose,
                              const vista_detection *detection, vista_track *track);

void vista_track_filter_predict(double dt_s, vista_track *track);

/* A track seen once, as if its velocity were known to moving_sigma_m_s only since `since_s` ago. */
void vista_track_filter_set_moving(const vista_tracker_params *params, double since_s, vista_track *track);

/* The track's camera z must be positive. since_s: age of its last hit. */
void vista_track_filter_view(const vista_tracker_params *params, const vista_camera *camera, const vista_pose *pose,
                             double since_s, const vista_track *track, vista_track_view *view);

/* Variances of a detection's (u, v, d). `reshaped`: its centre is uncertain by the track's projected half extent. */
void vista_track_filter_noise(const vista_tracker_params *params, const vista_camera *camera,
                              const vista_detection *detection, const vista_track_view *view, bool reshaped,
                              double variance_px2[3]);

/* Squared Mahalanobis distance in (u, v, d), covariance_px2: of the view; INFINITY when the innovation covariance is
 * singular. */
double vista_track_filter_distance2(const vista_track_view *view, const double covariance_px2[9],
                                    const vista_detection *detection, const double variance_px2[3]);

/* The same in space, with the detection's own covariance. */
double vista_track_filter_space_distance2(const vista_tracker_params *params, const vista_pose *pose,
                                          const vista_track *track, const vista_track_view *view,
                                          const vista_detection *detection);

/* Squared normalised difference of the logarithms of the extents; cut axes do not count. */
double vista_track_filter_extent_distance2(const vista_track *track, const vista_detection *detection);

void vista_track_filter_update(const vista_track_view *view, const vista_detection *detection,
                               const double variance_px2[3], vista_track *track);

#endif
