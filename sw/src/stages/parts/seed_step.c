#include "stages/parts/seed_step.h"

float vista_seed_step_px(const vista_segmentation_params *params, const vista_camera *camera, float distance_px,
                         float disparity_px) {
  return vista_larger(vista_depth_step_px(camera, disparity_px, (float)params->seed_step_m),
                      (float)params->seed_step_px + (float)params->seed_step_slope * distance_px);
}
