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

#include "common/ellipse.h"
#include "common/matched_area.h"
#include "perceive/region/region.h"
#include "vista/parameters.h"
#include "vista/status.h"
#include "vista/types.h"

typedef struct vista_detection {
  int32_t label; /* of the region */
  bool plain;    /* the region is told by its outline alone */
  double foot_sigma_px; /* of the disparity of a plain one, by where its foot is: the same in each frame */
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
  bool line;          /* a thin one, no region */
  vista_ellipse ellipse;
} vista_detection;

/* Fills position and covariance from u, v, disparity (positive) and their standard deviations. */
void vista_triangulate(const vista_camera *camera, vista_detection *detection);

/* One region, whatever its verdict.
 * VISTA_ERROR_NUMBER: not finite; VISTA_ERROR_RANGE: parameter or camera out of range, or a disparity below
 * disparity_min_px. */
vista_status vista_reconstruct_region(const vista_region *region, const vista_camera *camera,
                                      const vista_matched_area *matched, const vista_reconstruction_params *params,
                                      vista_detection *detection);

/* The accepted regions, in their order; regions below disparity_min_px are left out.
 * VISTA_ERROR_CAPACITY: more than `capacity` of them; the first `capacity` are written then. */
vista_status vista_reconstruct_regions(const vista_region *regions, int32_t region_count, const vista_camera *camera,
                                       const vista_matched_area *matched, const vista_reconstruction_params *params,
                                       vista_detection *detections, int32_t capacity, int32_t *detection_count);

#endif
