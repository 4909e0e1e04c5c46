#include "perceive/region/footing.h"

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include "common/depth.h"
#include "common/plane_fit.h"
#include "common/wide_vectors.h"
#include "perceive/scales.h"

/* Pixels of an obstacle whose word is less than this above the ground's plane are the ground at its foot; at most 6 %
 * of the range. */
#define GROUND_HEIGHT_M 0.2
#define BEHIND_PX 1.5 /* of disparity: ground farther behind a surface is seen past a thin thing, and stays with it */
#define FIXED_BITS 12
#define SLOPE_MAX 2.0 /* px per px */

/* A stretch of a row in one region: the ground there and the surface of the region, in fixed-point engine words, which
 * are integers because compilers make vectors of their comparisons. */
typedef struct stretch {
  int32_t ground, ground_slope, surface, surface_slope;
  int32_t low; /* 1 - h |n| / B: a word w is less than h above the plane when w low < ground (region_evidence.c) */
} stretch;

/* Limits a value without calling the mathematical library, for it is asked several times a stretch. */
static inline double within(double value, double limit) {
  return value < -limit ? -limit : value > limit ? limit : value;
}

static inline int32_t to_fixed(double words) { return (int32_t)within(words * (1 << FIXED_BITS), 1 << 28); }

/* A gradient in fixed point, limited so that it fits when it is multiplied by the length of a row. */
static inline int32_t to_fixed_slope(double slope) {
  return to_fixed(VISTA_DISPARITY_SCALE * within(slope, SLOPE_MAX));
}

VISTA_WIDE_VECTORS static void clear_stretch(const stretch *s, const int16_t *words, int32_t length, int32_t *label) {
  const int32_t behind = (int32_t)(BEHIND_PX * VISTA_DISPARITY_SCALE * (1 << FIXED_BITS));
  const int32_t below = (int32_t)(VISTA_GROUND_PX * VISTA_DISPARITY_SCALE * (1 << FIXED_BITS));
  for (int32_t i = 0; i < length; ++i) {
    const int32_t word = words[i], ground = s->ground + s->ground_slope * i;
    const int32_t surface = s->surface + s->surface_slope * i;
    const int32_t near = (word > 0) & (word * (1 << FIXED_BITS) > surface - behind);
    const int32_t lies = near & (word * s->low < ground);
    const int32_t beneath = (word <= 0) & (ground > 0) & (ground > surface + below);
    label[i] |= -(lies | beneath); /* VISTA_NO_LABEL: all ones */
  }
}

static void clear_row(const vista_camera *camera, const vista_plane *ground, double per_m, int32_t v,
                      const int16_t *words, const vista_regions *regions, int32_t *label) {
  const int32_t width = camera->width_px;
  for (int32_t first = 0, end; first < width; first = end) {
    const int32_t own = label[first];
    for (end = first + 1; end < width && label[end] == own;) ++end;
    if (own < 0 || own >= regions->count) continue;
    const vista_region *const r = &regions->items[own];
    if (r->verdict != VISTA_REGION_ACCEPTED) continue;
    const double limit_m = (double)vista_limit_m(camera, (float)r->disparity_px, (float)GROUND_HEIGHT_M);
    const double surface_px = vista_region_surface_px(r, first, v);
    const double ground_px = vista_plane_disparity_px(ground, camera, first, v);
    const double low = within(1.0 - limit_m * per_m, 1.0);
    const stretch s = {to_fixed(VISTA_DISPARITY_SCALE * ground_px), to_fixed_slope(ground->slope_u),
                       to_fixed(VISTA_DISPARITY_SCALE * surface_px), to_fixed_slope(r->slope_u), to_fixed(low)};
    clear_stretch(&s, words + first, end - first, label + first);
  }
}

void vista_footing_clear(const vista_frame_view *frame, const vista_surfaces *surfaces, const vista_regions *regions,
                         vista_refinement *refinement) {
  if (!surfaces->ground_found) return;
  const vista_camera *const camera = frame->camera;
  const vista_disparity_image *const disparity = &frame->words;
  const vista_plane *const ground = &surfaces->ground;
  const double per_m = vista_plane_share_per_m(ground, camera);
  for (int32_t v = 0; v < camera->height_px; ++v) {
    const double left_px = vista_plane_disparity_px(ground, camera, 0.0, v);
    if (fmax(left_px, left_px + ground->slope_u * camera->width_px) <= 0.0) continue; /* above the horizon */
    clear_row(camera, ground, per_m, v, disparity->data + v * disparity->stride, regions,
              refinement->label + (ptrdiff_t)v * camera->width_px);
  }
}
