/* Bounding ellipse of a region, from the moments of its pixels (paper, section II-D). */
#ifndef VISTA_ELLIPSE_H
#define VISTA_ELLIPSE_H

#include <stdbool.h>

#include "perceive/region/region.h"
#include "vista/obstacle.h"
#include "vista/status.h"

/* The ellipse that, uniformly filled, has this mean and covariance: semi-axes 2*sqrt(eigenvalue).
 * VISTA_ERROR_NUMBER: not finite; VISTA_ERROR_RANGE: not a covariance (a negative eigenvalue). */
vista_status vista_ellipse_from_moments(double mean_u_px, double mean_v_px, double cov_uu_px2, double cov_uv_px2,
                                        double cov_vv_px2, vista_ellipse *ellipse);

/* The same of a region, whose pixels are unit squares, not points: 1/12 px^2 on both variances, so that
 * a single pixel has an area too. */
vista_status vista_ellipse_from_region(const vista_region *region, vista_ellipse *ellipse);

/* Half width and half height of the upright box around the ellipse. */
void vista_ellipse_half_box(const vista_ellipse *ellipse, double *half_width_px, double *half_height_px);

#endif
