/* Metric limits in the image, internal to libvista. Z = f B / d.
 *
 * The limits of the parameters are made for outdoors; a limit is never more than a share of the range, because what is
 * near enough to fill the view may well be small: s(d) = min(s, RANGE_SHARE f B / d).
 * As a disparity step it is d - f B / (f B / d + s) = d^2 s / (f B + d s) pixels. */
#ifndef VISTA_SRC_DEPTH_H
#define VISTA_SRC_DEPTH_H

#include "vista/types.h"

#define RANGE_SHARE 0.06f

static inline float vista_limit_m(const vista_camera *camera, float disparity_px, float limit_m) {
  const float share_m = RANGE_SHARE * (float)(camera->focal_px * camera->baseline_m) / disparity_px;
  return share_m < limit_m ? share_m : limit_m; /* fminf is a call, and this is asked often */
}

static inline float vista_depth_step_px(const vista_camera *camera, float disparity_px, float step_m) {
  const float ds = disparity_px * vista_limit_m(camera, disparity_px, step_m);
  const float step_px = disparity_px * ds / ((float)(camera->focal_px * camera->baseline_m) + ds);
  return disparity_px > 0.0f ? step_px : 0.0f; /* chosen last, so that loops over it become vectors */
}

#endif
