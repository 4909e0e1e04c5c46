/* Detections to tracks: one extended Kalman filter an obstacle, in the inertial frame with known pose (paper, II-D).
 *
 * State      x = (position, velocity) in world, nearly constant velocity with a small prior (obstacles are mostly
 *            static) and white acceleration noise. Width and height: one scalar filter each, on the logarithm.
 * Measurement z = (u, v, d) of the current camera: p = R^T (position - t), u = u0 + f X/Z, v = v0 + f Y/Z,
 *            d = f B/Z. Joseph-form update.
 * Association in three global assignments over what the one before left over:
 *            confirmed tracks with the detections in their Mahalanobis gate in (u, v, d);
 *            confirmed tracks with detections inside their extent at their depth: the region changed its shape, so
 *            its centre counts as uncertain by half the extent;
 *            tentative tracks with the detections in their gate. A newborn never takes a confirmed track's detection.
 * Life       a detection that nothing claims starts a tentative track, unless it lies within a confirmed one (a split
 *            region). Confirmed at M hits in the last N frames in which it could be seen; a tentative track that can
 *            no longer get there, or lies within a confirmed one, is dropped; so is a confirmed one after more than
 *            miss_max misses in a row.
 * Unseen     outside the matched part of the image, or nearer than the engine matches (the blind zone), a track is
 *            not blamed for a miss: it coasts until it is behind the camera or for a set time.
 * Duplicates two confirmed tracks, each centred within the other: the older id stays.
 * Overflow   with the table full, the least certain tentative track (fewest hits, then largest position variance)
 *            makes room for a more certain newborn; else the newborn is dropped. Either is counted. */
#ifndef VISTA_TRACKER_H
#define VISTA_TRACKER_H

#include <stdbool.h>
#include <stdint.h>

#include "vista/arena.h"
#include "vista/ellipse.h"
#include "vista/reconstruction.h"
#include "vista/status.h"
#include "vista/types.h"

#define VISTA_TRACKER_MAX 4096 /* tracks, detections */

/*   field                       default   range    meaning */
typedef struct vista_tracker_params {
  double velocity_sigma_m_s;    /* 0.5     > 0      prior of an obstacle's velocity, each axis */
  double acceleration_psd_m2_s3;/* 0.01    >= 0     spectral density of the white acceleration, each axis */
  double position_psd_m2_s;     /* 0.01    >= 0     random walk of the point that stands for the obstacle */
  double attitude_sigma_deg;    /* 0.05    >= 0     error of the pose's attitude, each axis: adds to u and v */
  double gate_chi2;             /* 11.34   > 0      Mahalanobis gate, chi-square with 3 dof (11.34: 0.99) */
  double extent_sigma_ratio;    /* 0.3     > 0      noise of the natural logarithm of a measured extent */
  double extent_psd_1_s;        /* 0.02    >= 0     random walk of the logarithm of the extent */
  double overlap_sigma;         /* 3.0     > 0      depth gate for "within a track", standard deviations of disparity */
  double overlap_scale;         /* 1.2     > 0      half extents that count as "within a track" */
  int32_t confirm_hits;         /* 3       1..N     M of M-of-N */
  int32_t confirm_window;       /* 5       1..32    N of M-of-N, frames in which the track could be seen */
  int32_t miss_max;             /* 5       >= 0     misses in a row that a confirmed track survives */
  double out_of_view_s;         /* 1.0     >= 0     a track outside the matched image coasts for this long */
  double blind_zone_s;          /* 5.0     >= 0     a track nearer than the engine matches coasts for this long */
  double disparity_max_px;      /* 31.0    > 0      largest disparity that the engine matches: num_disparities - 1 */
  double margin_left_px;        /* 36.0    >= 0     as in vista_reconstruction_params */
  double margin_px;             /* 5.0     >= 0     as in vista_reconstruction_params */
  double range_max_m;           /* 150.0   > 0      farther detections start no track */
} vista_tracker_params;

typedef struct vista_track {
  int32_t id; /* from 1, never reused */
  bool confirmed;
  bool coasting;       /* no detection in this frame: the state is a prediction */
  bool in_view;        /* predicted inside the matched part of the image */
  bool in_blind_zone;  /* predicted nearer than the engine matches */
  int32_t label;       /* of the region in this frame; -1 while coasting */
  int32_t age_frames;  /* updates since its birth, that one included */
  int32_t hits;        /* detections in all */
  int32_t misses;      /* in a row; only frames in which it could be seen count */
  int32_t seen_frames; /* frames in which it was seen or could have been */
  uint32_t window;     /* the last 32 of these, bit 0 the newest, 1 = hit */
  int64_t hit_t_ns;    /* last detection */
  int64_t visible_t_ns; /* last frame in which it could be seen */
  double position_m[3];   /* world */
  double velocity_m_s[3]; /* world */
  double covariance[36];  /* of (position, velocity), row-major, symmetric; m^2, m^2/s, m^2/s^2 */
  double extent_m[2];     /* width, height */
  double extent_variance[2]; /* of the natural logarithm of extent_m */
  vista_ellipse ellipse;     /* of the last detection */
  double ellipse_depth_m;    /* camera z at that detection */
} vista_track;

typedef struct vista_tracker vista_tracker;

/* *tracker is NULL while the arena counts. VISTA_ERROR_RANGE: a capacity outside 1..VISTA_TRACKER_MAX. */
vista_status vista_tracker_layout(int32_t max_tracks, int32_t max_detections, vista_arena *arena,
                                  vista_tracker **tracker);

/* Forget all tracks and the time; ids go on counting. */
void vista_tracker_reset(vista_tracker *tracker);

/* One frame. pose == NULL: a still camera, world = camera. On any error nothing is changed.
 * VISTA_ERROR_ORDER: t_ns not after that of the last update; VISTA_ERROR_NUMBER: pose, camera or detection not finite;
 * VISTA_ERROR_RANGE: parameter or camera out of range, rotation not orthonormal, a disparity, sigma or extent not
 * positive;
 * VISTA_ERROR_CAPACITY: more than max_detections; VISTA_ERROR_OVERFLOW: the ids are used up. */
vista_status vista_tracker_update(vista_tracker *tracker, const vista_tracker_params *params,
                                  const vista_camera *camera, const vista_pose *pose, int64_t t_ns,
                                  const vista_detection *detections, int32_t count);

/* All live tracks, ascending id; valid until the next update. */
const vista_track *vista_tracker_tracks(const vista_tracker *tracker, int32_t *count);

/* Tracks lost because the table was full, newborns included, since the layout or the last reset. */
int64_t vista_tracker_dropped(const vista_tracker *tracker);

#endif
