#include "stages/parts/seed_step.h"

#include <math.h>

#include "common/depth.h"
#include "common/disjoint_sets.h"

void vista_seeds_join(vista_seeds *seeds, int32_t a, int32_t b) {
  const int32_t gone = vista_sets_join(seeds->parent, a, b);
  if (gone >= 0) seeds->area_px2[seeds->parent[gone]] += seeds->area_px2[gone];
}

float vista_seed_step_px(const vista_segmentation_params *params, const vista_camera *camera, float distance_px,
                         float disparity_px) {
  return fmaxf(vista_depth_step_px(camera, disparity_px, (float)params->seed_step_m),
               (float)params->seed_step_px + (float)params->seed_step_slope * distance_px);
}
