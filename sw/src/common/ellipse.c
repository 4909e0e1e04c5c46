#include "common/ellipse.h"
#include "common/numbers.h"

#include <math.h>
#include <stddef.h>

#define PIXEL_VARIANCE (1.0 / 12.0) /* of a unit square, along u and v */

vista_status vista_ellipse_from_moments(double mean_u_px, double mean_v_px, double cov_uu_px2, double cov_uv_px2,
                                        double cov_vv_px2, vista_ellipse *ellipse) {
  if (ellipse == NULL) return VISTA_ERROR_ARGUMENT;
  if (!isfinite(mean_u_px) || !isfinite(mean_v_px) || !isfinite(cov_uu_px2) || !isfinite(cov_uv_px2) ||
      !isfinite(cov_vv_px2))
    return VISTA_ERROR_NUMBER;
  const double center = 0.5 * (cov_uu_px2 + cov_vv_px2);
  const double difference = 0.5 * (cov_uu_px2 - cov_vv_px2);
  const double radius = hypot(difference, cov_uv_px2);
  const double slack = 1e-9 * (fabs(cov_uu_px2) + fabs(cov_vv_px2)); /* a line's small eigenvalue may round below 0 */
  if (center < 0.0 || center - radius < -slack) return VISTA_ERROR_RANGE;
  double angle_deg = 0.5 * atan2(cov_uv_px2, difference) * VISTA_DEGREES_PER_RADIAN;
  if (angle_deg <= -90.0) angle_deg += 180.0;
  *ellipse = (vista_ellipse){.center_u_px = mean_u_px,
                             .center_v_px = mean_v_px,
                             .axis_a_px = 2.0 * sqrt(center + radius),
                             .axis_b_px = 2.0 * sqrt(fmax(0.0, center - radius)),
                             .angle_deg = angle_deg};
  return VISTA_OK;
}

vista_status vista_ellipse_from_region(const vista_region *region, vista_ellipse *ellipse) {
  if (region == NULL) return VISTA_ERROR_ARGUMENT;
  return vista_ellipse_from_moments(region->mean_u_px, region->mean_v_px, region->cov_uu_px2 + PIXEL_VARIANCE,
                                    region->cov_uv_px2, region->cov_vv_px2 + PIXEL_VARIANCE, ellipse);
}

void vista_ellipse_half_box(const vista_ellipse *ellipse, double *half_width_px, double *half_height_px) {
  const double c = cos(ellipse->angle_deg / VISTA_DEGREES_PER_RADIAN);
  const double s = sin(ellipse->angle_deg / VISTA_DEGREES_PER_RADIAN);
  *half_width_px = hypot(ellipse->axis_a_px * c, ellipse->axis_b_px * s);
  *half_height_px = hypot(ellipse->axis_a_px * s, ellipse->axis_b_px * c);
}
