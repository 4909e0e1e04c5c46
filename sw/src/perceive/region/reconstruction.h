/* Regions to detections: linear triangulation at the boundary disparity (paper, section II-D).
 *
 *   Z = f B / d,   X = (u - u0) B / d,   Y = (v - v0) B / d
 *
 * The covariance is J diag(sigma_u^2, sigma_v^2, sigma_d^2) J^T with J = d(X, Y, Z) / d(u, v, d), so that a far
 * region is honestly uncertain in range: sigma_Z = Z^2 / (f B) sigma_d. */
#ifndef VISTA_RECONSTRUCTION_H
#define VISTA_RECONSTRUCTION_H

#include <stdbool.h>
#include <stdint.h>

#include "perceive/frame_view.h"
#include "perceive/region/region.h"
#include "vista/obstacle.h"
#include "vista/status.h"
#include "vista/types.h"

typedef struct vista_detection {
  int32_t label; /* of the region */
  bool plain;    /* the region is told by its outline alone */
  /* Of the disparity, an error that is the same in each frame: of a plain one by where its foot is, of a line by rows of
   * the two images that do not match. */
  double lasting_sigma_px;
  double u_px, v_px, disparity_px;
  double sigma_u_px, sigma_v_px, sigma_disparity_px; /* standard deviations, independent of one another */
  double position_camera_m[3];
  double covariance_camera_m2[9]; /* row-major, symmetric */
  double extent_m[2]; /* width, height of the upright box around the ellipse, at the range of the region */
  bool cut_u, cut_v; /* the border of the matched image cuts the region: the extent is a lower bound
                                     along u, v; the centre is uncertain by half of it (in sigma_u_px, sigma_v_px) */
  int32_t volume_pixels; /* of the region, in the collision volume */
  bool foot_seen; /* as of the region */
  double foot_share;
  bool met; /* by the collision volume, there: */
  double met_camera_m[3];
  double met_sigma_m; /* of its range */
  bool line; /* a thin one, no region */
  bool unrepeated; /* it lies so flat that nothing repeats it along a row: it is no image of a texture */
  vista_ellipse ellipse;
} vista_detection;

/* Fills position and covariance from u, v, disparity (positive) and their standard deviations. */
void vista_triangulate(const vista_camera *camera, vista_detection *detection);

/* Fills position, covariance and extent of one region in, whatever its verdict. VISTA_ERROR_NUMBER: it is not finite;
 * VISTA_ERROR_RANGE: its disparity is below disparity_min_px. */
vista_status vista_reconstruct_region(const vista_frame_view *frame, const vista_region *region,
                                      vista_detection *detection);

typedef struct vista_detections {
  vista_detection *items;
  int32_t count, capacity;
} vista_detections;

/* Replaces the detections by those of the accepted regions, in their order; regions below disparity_min_px are left
 * out. VISTA_ERROR_CAPACITY: there are more than fit; the nearest of them are there then, in no order. */
vista_status vista_reconstruct_regions(const vista_frame_view *frame, const vista_region *regions, int32_t region_count,
                                       vista_detections *detections);

#endif
