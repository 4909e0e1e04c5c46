#include "perceive/region/footing.h"

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include "common/depth.h"
#include "common/plane_fit.h"
#include "common/wide_vectors.h"

/* Pixels of an obstacle whose word is less than this above the ground's plane are the ground at its foot; at most 6 %
 * of the range. */
#define GROUND_HEIGHT_M 0.2
#define BEHIND_PX 1.5 /* of disparity: ground farther behind a surface is seen past a thin thing, and stays with it */
#define FIXED_BITS 12
#define SLOPE_MAX 2.0 /* px per px */
#define ROUNDING_PX 0.5 /* more than the fixed point is off at the end of a row */
#define AT_ONCE 1024 /* pixels */
#define BELOW_PX 0.5 /* of disparity: so far beneath the ground's plane a surface has to be */

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
  const int32_t below = (int32_t)(BELOW_PX * VISTA_DISPARITY_SCALE * (1 << FIXED_BITS));
  for (int32_t i = 0; i < length; ++i) {
    const int32_t word = words[i], ground = s->ground + s->ground_slope * i;
    const int32_t surface = s->surface + s->surface_slope * i;
    const int32_t near = (word > 0) & (word * (1 << FIXED_BITS) > surface - behind);
    const int32_t lies = near & (word * s->low < ground);
    const int32_t beneath = (word <= 0) & (ground > 0) & (ground > surface + below);
    label[i] |= -(lies | beneath); /* VISTA_NO_LABEL: all ones */
  }
}

/* Says of the pixels `first` .. `end` - 1 of a row whether their label differs from that of the pixel before. */
typedef struct changes {
  int32_t first, end;
  uint8_t at[AT_ONCE];
} changes;

VISTA_WIDE_VECTORS static void find_changes(const int32_t *restrict label, int32_t count, uint8_t *restrict at) {
  for (int32_t i = 0; i < count; ++i) at[i] = label[i] != label[i - 1];
}

/* One past the stretch of equal labels that begins at `first`. */
static int32_t end_of_stretch(const int32_t *label, int32_t first, int32_t width, changes *c) {
  for (int32_t from = first + 1; from < width; from = c->end) {
    if (from >= c->end) {
      c->first = from;
      c->end = width - from < AT_ONCE ? width : from + AT_ONCE;
      find_changes(label + from, c->end - from, c->at);
    }
    const uint8_t *const change = memchr(c->at + (from - c->first), 1, (size_t)(c->end - from));
    if (change != NULL) return c->first + (int32_t)(change - c->at);
  }
  return width;
}

/* Whether at both ends of a stretch, and so all along it, the ground is farther than any word that is near the surface:
 * then none of its pixels is the ground's, as in most stretches. low: see stretch, of which the rounding is allowed
 * for. */
static inline bool stands_clear(double ground_px, double ground_slope, double surface_px, double surface_slope,
                                double low, double last) {
  const double least_px = surface_px - BEHIND_PX - ROUNDING_PX;
  const bool slight = fabs(ground_slope) < SLOPE_MAX && fabs(surface_slope) < SLOPE_MAX;
  return slight && low > 0.0 && least_px * low > ground_px &&
         (least_px + surface_slope * last) * low > ground_px + ground_slope * last;
}

static void clear_row(const vista_camera *camera, const vista_plane *ground, double per_m, int32_t v,
                      const int16_t *words, const vista_regions *regions, int32_t *label) {
  const int32_t width = camera->width_px;
  changes c;
  c.first = c.end = 0;
  for (int32_t first = 0, end; first < width; first = end) {
    end = end_of_stretch(label, first, width, &c);
    if (label[first] < 0 || label[first] >= regions->count) continue;
    const vista_region *const r = &regions->items[label[first]];
    if (r->verdict != VISTA_REGION_ACCEPTED) continue;
    const double limit_m = (double)vista_limit_m(camera, (float)r->disparity_px, (float)GROUND_HEIGHT_M);
    const double surface_px = vista_region_surface_px(r, first, v);
    const double ground_px = vista_plane_disparity_px(ground, camera, first, v);
    const double low = within(1.0 - limit_m * per_m, 1.0);
    if (stands_clear(ground_px, ground->slope_u, surface_px, r->slope_u, low, end - 1 - first)) continue;
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
