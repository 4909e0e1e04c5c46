#include "perceive/region/region_boundary.h"

#include <math.h>

#include "common/wide_vectors.h"
#include "common/word_blocks.h"

#define AHEAD 16 /* runs */
#define SUMMED 128 /* pixels at once: sums of products of distances within a cell, below 4096 px, fit 32 bits */

/* Masks of pixels are 0 or -1: what the words beside them are compared to. */
typedef struct moments {
  int64_t n, u, v, uu, uv, vv;
  int32_t min_u, min_v, max_u, max_v;
} moments;

/* Distances from (u_0, v_0) are summed, in 32 bits, and moved there afterwards: all of it in whole numbers. */
static inline void add_pixels(const int16_t *restrict us, const int16_t *restrict vs, const int16_t *restrict own,
                              int32_t count, int16_t u_0, int16_t v_0, moments *sum) {
  int32_t n = 0, u = 0, v = 0, uu = 0, uv = 0, vv = 0;
  int16_t min_u = INT16_MAX, min_v = INT16_MAX, max_u = INT16_MIN, max_v = INT16_MIN;
  for (int32_t i = 0; i < count; ++i) {
    const int16_t is_own = own[i], not_own = (int16_t)~is_own;
    const int16_t du = (int16_t)((us[i] - u_0) & is_own), dv = (int16_t)((vs[i] - v_0) & is_own);
    const int16_t low_u = (int16_t)(du | (not_own & INT16_MAX)), high_u = (int16_t)(du | (not_own & INT16_MIN));
    const int16_t low_v = (int16_t)(dv | (not_own & INT16_MAX)), high_v = (int16_t)(dv | (not_own & INT16_MIN));
    min_u = low_u < min_u ? low_u : min_u;
    max_u = high_u > max_u ? high_u : max_u;
    min_v = low_v < min_v ? low_v : min_v;
    max_v = high_v > max_v ? high_v : max_v;
    n += is_own * is_own;
    u += is_own * du;
    v += is_own * dv;
    uu += du * du;
    uv += du * dv;
    vv += dv * dv;
  }
  if (n == 0) return;
  const int64_t to_u = u_0, to_v = v_0;
  sum->uu += uu - 2 * to_u * u + to_u * to_u * n; /* u and v: minus the sums */
  sum->uv += uv - to_u * v - to_v * u + to_u * to_v * n;
  sum->vv += vv - 2 * to_v * v + to_v * to_v * n;
  sum->u += to_u * n - u;
  sum->v += to_v * n - v;
  sum->n += n;
  if (u_0 + min_u < sum->min_u) sum->min_u = u_0 + min_u;
  if (v_0 + min_v < sum->min_v) sum->min_v = v_0 + min_v;
  if (u_0 + max_u > sum->max_u) sum->max_u = u_0 + max_u;
  if (v_0 + max_v > sum->max_v) sum->max_v = v_0 + max_v;
}

static inline void add_cell(const vista_foveation *f, int32_t node, const int16_t *own, moments *sum) {
  const int16_t *const u = f->pixel_u + f->first_pixel[node], *const v = f->pixel_v + f->first_pixel[node];
  for (int32_t left = f->pixel_count[node], i = 0; left > 0; i += SUMMED, left -= SUMMED)
    add_pixels(u + i, v + i, own + i, left < SUMMED ? left : SUMMED, (int16_t)f->center_u[node],
               (int16_t)f->center_v[node], sum);
}

static void summarise(const moments *sum, vista_region *region) {
  region->min_u_px = sum->min_u;
  region->min_v_px = sum->min_v;
  region->max_u_px = sum->max_u;
  region->max_v_px = sum->max_v;
  region->pixel_count = (int32_t)sum->n;
  if (sum->n == 0) return;
  const double n = (double)sum->n;
  region->mean_u_px = (double)sum->u / n;
  region->mean_v_px = (double)sum->v / n;
  region->cov_uu_px2 = fmax((double)sum->uu / n - region->mean_u_px * region->mean_u_px, 0.0);
  region->cov_uv_px2 = (double)sum->uv / n - region->mean_u_px * region->mean_v_px;
  region->cov_vv_px2 = fmax((double)sum->vv / n - region->mean_v_px * region->mean_v_px, 0.0);
}

/* Marks those of a cell's pixels that the image gives to the region and whose words lie on its surface; of a cell
 * without a disparity all that the image gives. */
VISTA_WIDE_VECTORS static void mark_cell(const vista_region_view *w, const vista_plane *surface, int32_t label,
                                         int32_t node, int16_t *restrict own) {
  const vista_foveation *const f = w->foveation;
  const int32_t first = f->first_pixel[node], count = f->pixel_count[node];
  const int16_t *const words = w->cells->words + first, *const us = f->pixel_u + first, *const vs = f->pixel_v + first;
  const int32_t *const drawn = w->region_of_listed + first;
  const float offset = (float)(surface->offset * VISTA_DISPARITY_SCALE),
              tolerance = (float)(w->tolerance_px * VISTA_DISPARITY_SCALE);
  const float slope_u = (float)(surface->slope_u * VISTA_DISPARITY_SCALE),
              slope_v = (float)(surface->slope_v * VISTA_DISPARITY_SCALE);
  const int32_t unmixed = w->mixed[node] == 0, whole = w->cells->disparity_px[node] < 0.0f;
  for (int32_t i = 0; i < count; ++i) {
    const float off = (float)words[i] - (offset + slope_v * (float)vs[i] + slope_u * (float)us[i]);
    const int32_t on = (words[i] >= 0) & (fabsf(off) <= tolerance);
    own[i] = (int16_t)-((unmixed | (drawn[i] == label)) & (whole | on));
  }
}

/* Takes out of a block what is off the surface. start_px: of the surface, `first` pixels before the block. */
static inline void keep_on_surface(const vista_region_view *w, const vista_plane *surface, const int16_t *words,
                                   double start_px, int32_t first, int16_t own[VISTA_WORD_BLOCK]) {
  const double slope = surface->slope_u, tolerance_px = w->tolerance_px;
  VISTA_BLOCK_LOOP
  for (int32_t i = 0; i < VISTA_WORD_BLOCK; ++i) {
    const double off_px = words[i] * (1.0 / VISTA_DISPARITY_SCALE) - (start_px + slope * (first + i));
    own[i] = (int16_t)(own[i] & -((words[i] >= 0) & (fabs(off_px) <= tolerance_px)));
  }
}

/* Takes those of a run's pixels out that are not inside. Blocks end with their run. */
static inline void narrow_run(const vista_region_view *w, const vista_plane *surface, vista_run run, int16_t *own) {
  const int16_t *const row = w->frame->words.data + run.v_px * w->frame->words.stride;
  const double start_px = vista_plane_at(surface, run.u_px, run.v_px);
  const int32_t reach = (int32_t)VISTA_BOUNDARY_PX, width = w->foveation->width_px;
  int16_t copy[VISTA_WORD_BLOCK], inner[VISTA_WORD_BLOCK];
  for (int32_t i = 0; i < run.length_px; i += VISTA_WORD_BLOCK) {
    const int32_t left = run.length_px - i;
    VISTA_BLOCK_LOOP
    for (int32_t k = 0; k < VISTA_WORD_BLOCK; ++k) inner[k] = -1;
    for (int32_t aside = -reach; aside <= reach; aside += 2 * reach)
      keep_on_surface(w, surface, vista_word_block(row, run.u_px + i + aside, width, copy), start_px, i + aside, inner);
    VISTA_BLOCK_LOOP
    for (int32_t k = 0; k < VISTA_WORD_BLOCK; ++k) own[i + k] = (int16_t)(own[i + k] & (inner[k] | -(k >= left)));
  }
}

/* Fetches the words that a run is going to be asked for: no processor foresees which rows the cells lie in. Addresses,
 * for they may lie before or behind the image. */
static inline void fetch_words(const vista_region_view *w, vista_run run) {
  const uintptr_t first = (uintptr_t)(w->frame->words.data + run.v_px * w->frame->words.stride + run.u_px);
  const uintptr_t reach = (uintptr_t)VISTA_BOUNDARY_PX * sizeof(int16_t);
  __builtin_prefetch((const void *)(first - reach));
  __builtin_prefetch((const void *)(first + reach + (VISTA_WORD_BLOCK - 1) * sizeof(int16_t)));
}

VISTA_WIDE_VECTORS static void narrow_cell(const vista_region_view *w, const vista_plane *surface, int32_t node,
                                           int16_t *own) {
  const int32_t all = w->foveation->first_run[w->foveation->node_count];
  for (int32_t r = w->foveation->first_run[node]; r < w->foveation->first_run[node + 1]; ++r) {
    if (r + AHEAD < all) fetch_words(w, w->foveation->runs[r + AHEAD]);
    narrow_run(w, surface, w->foveation->runs[r], own);
    own += w->foveation->runs[r].length_px;
  }
}

static const moments nothing = {.min_u = INT32_MAX, .min_v = INT32_MAX, .max_u = INT32_MIN, .max_v = INT32_MIN};

VISTA_WIDE_VECTORS static moments find_pixels(const vista_region_view *w, const vista_plane *surface, int32_t label) {
  moments sum = nothing;
  int16_t *own = w->pixels;
  for (int32_t m = 0; m < w->member_count; own += w->foveation->pixel_count[w->members[m++]]) {
    mark_cell(w, surface, label, w->members[m], own);
    add_cell(w->foveation, w->members[m], own, &sum);
  }
  return sum;
}

void vista_region_find_pixels(const vista_region_view *w, const vista_plane *surface, vista_region *region) {
  const moments sum = find_pixels(w, surface, region->label);
  summarise(&sum, region);
}

VISTA_WIDE_VECTORS static moments keep_inner_pixels(const vista_region_view *w, const vista_plane *surface) {
  moments sum = nothing;
  int16_t *own = w->pixels;
  for (int32_t m = 0; m < w->member_count; own += w->foveation->pixel_count[w->members[m++]]) {
    if (w->cells->disparity_px[w->members[m]] >= 0.0f) narrow_cell(w, surface, w->members[m], own);
    add_cell(w->foveation, w->members[m], own, &sum);
  }
  return sum;
}

void vista_region_keep_inner_pixels(const vista_region_view *w, const vista_plane *surface, vista_region *region) {
  const moments sum = keep_inner_pixels(w, surface);
  summarise(&sum, region);
}
