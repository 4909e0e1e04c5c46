/* What seeds are made of: standing cells, joined where the disparity steps little. Internal to libvista. */
#ifndef VISTA_SRC_SEED_STEP_H
#define VISTA_SRC_SEED_STEP_H

#include <stdbool.h>
#include <stdint.h>

#include "common/depth.h"
#include "perceive/cells/cells.h"
#include "perceive/cells/surface.h"
#include "perceive/scales.h"
#include "vista/parameters.h"
#include "vista/types.h"

#define SEED_STEP_SLOPE 0.02 /* px per px between the centres, added to seed_step_px */

static inline bool vista_standing(const vista_cells *cells, const vista_surfaces *surfaces, int32_t node) {
  return cells->disparity_px[node] > 0.0f && !surfaces->horizontal[node];
}

/* Whether step_px, the difference in disparity of two cells distance_px apart of which the nearer one is at
 * disparity_px, is no step: at most `multiple` times what a seed may step by, in pixels or in metres of depth. In most
 * cases the first term tells. */
static inline bool vista_seed_is_smooth(const vista_segmentation_params *params, const vista_camera *camera,
                                        float distance_px, float disparity_px, float multiple, float step_px) {
  const float flat_px = (float)params->seed_step_px + (float)SEED_STEP_SLOPE * distance_px;
  return step_px <= multiple * flat_px ||
         step_px <= multiple * vista_depth_step_px(camera, disparity_px, (float)VISTA_RELIEF_M);
}

#endif
