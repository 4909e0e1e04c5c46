/* Depth steps as disparity steps, internal to libvista: Z = f B / d, so a step of s metres at disparity d is
 * d - f B / (f B / d + s) = d^2 s / (f B + d s) pixels. */
#ifndef VISTA_SRC_DEPTH_H
#define VISTA_SRC_DEPTH_H

#include "vista/types.h"

static inline float vista_depth_step_px(const vista_camera *camera, float disparity_px, float step_m) {
  const float fb = (float)(camera->focal_px * camera->baseline_m);
  return disparity_px * disparity_px * step_m / (fb + disparity_px * step_m);
}

#endif
