#include "stages/footing.h"

#include <stddef.h>

#include "common/depth.h"
#include "common/frame.h"
#include "common/numbers.h"
#include "common/parameters_check.h"
#include "common/plane_fit.h"
#include "common/wide_vectors.h"
#include "stages/segmentation.h"

#define BEHIND_PX 1.5f /* of disparity: ground farther behind a surface is seen past a thin thing, that it belongs to */
#define BELOW_PX 0.5f /* of disparity: so far beneath the ground's plane a surface has to be */

/* In one row, in engine words: the ground, and the surface of the region that a stretch of it belongs to. */
typedef struct stretch {
  float ground, ground_slope, surface, surface_slope;
  float low; /* 1 - h |n| / B: a word w is less than h above the plane when w low < ground (region_evidence.c) */
} stretch;

VISTA_WIDE_VECTORS static void clear_stretch(const stretch *s, const int16_t *words, int32_t length, int32_t *label) {
  for (int32_t i = 0; i < length; ++i) {
    const float ground = s->ground + s->ground_slope * (float)i, word = (float)words[i];
    const float surface = s->surface + s->surface_slope * (float)i;
    const int32_t lies =
        (words[i] > 0) & (word * s->low < ground) & (word > surface - BEHIND_PX * VISTA_DISPARITY_SCALE);
    const int32_t beneath = (words[i] <= 0) & (ground > 0.0f) & (ground > surface + BELOW_PX * VISTA_DISPARITY_SCALE);
    label[i] = (lies | beneath) ? VISTA_NO_LABEL : label[i];
  }
}

static void clear_row(const vista_region_params *params, const vista_camera *camera, const vista_plane *ground,
                      double per_m, int32_t v, const int16_t *words, const vista_regions *regions, int32_t *label) {
  const int32_t width = camera->width_px;
  for (int32_t first = 0, end; first < width; first = end) {
    for (end = first + 1; end < width && label[end] == label[first];) ++end;
    if (label[first] < 0 || label[first] >= regions->count) continue;
    const vista_region *const r = &regions->items[label[first]];
    if (r->verdict != VISTA_REGION_ACCEPTED) continue;
    const double limit_m = (double)vista_limit_m(camera, (float)r->disparity_px, (float)params->ground_height_m);
    const double surface_px = r->disparity_px + r->slope_u * (first - r->mean_u_px) + r->slope_v * (v - r->mean_v_px);
    const stretch s = {(float)(VISTA_DISPARITY_SCALE * vista_plane_disparity_px(ground, camera, first, v)),
                       (float)(VISTA_DISPARITY_SCALE * ground->slope_u), (float)(VISTA_DISPARITY_SCALE * surface_px),
                       (float)(VISTA_DISPARITY_SCALE * r->slope_u), (float)(1.0 - limit_m * per_m)};
    if (s.ground <= 0.0f && s.ground + s.ground_slope * (float)(end - first) <= 0.0f) continue; /* sky */
    clear_stretch(&s, words + first, end - first, label + first);
  }
}

vista_status vista_footing_clear(const vista_region_params *params, const vista_camera *camera,
                                 const vista_disparity_image *disparity, const vista_surfaces *surfaces,
                                 const vista_regions *regions, vista_refinement *refinement) {
  if (params == NULL || camera == NULL || disparity == NULL || surfaces == NULL || regions == NULL ||
      refinement == NULL)
    return VISTA_ERROR_ARGUMENT;
  vista_status status = VISTA_CHECK_SECTION(region, params);
  if (status == VISTA_OK) status = vista_frame_check_camera(camera);
  if (status == VISTA_OK) status = vista_frame_check_disparity(disparity, camera->width_px, camera->height_px);
  if (status != VISTA_OK || !surfaces->ground_found) return status;
  const vista_plane ground = {surfaces->ground_px, surfaces->ground_slope_u, surfaces->ground_slope_v};
  const double n[3] = {ground.slope_u, ground.slope_v, ground.offset / camera->focal_px};
  const double per_m = vista_norm(n) / camera->baseline_m;
  for (int32_t v = 0; v < camera->height_px; ++v)
    clear_row(params, camera, &ground, per_m, v, disparity->data + v * disparity->stride, regions,
              refinement->label + (ptrdiff_t)v * camera->width_px);
  return VISTA_OK;
}
