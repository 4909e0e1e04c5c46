#include "perceive/region/region_pixels.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "common/wide_vectors.h"
#include "common/word_blocks.h"

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
  const int32_t padded = (f->pixel_count[node] + VISTA_WORD_BLOCK - 1) & -VISTA_WORD_BLOCK;
  for (int32_t i = 0; i < padded; i += SUMMED)
    add_pixels(u + i, v + i, own + i, padded - i < SUMMED ? padded - i : SUMMED, (int16_t)f->center_u[node],
               (int16_t)f->center_v[node], sum);
}

/* All pixels of a cell, run by run: sums of consecutive numbers and of their squares. */
static inline void add_whole_cell(const vista_foveation *f, int32_t node, moments *sum) {
  for (int32_t r = f->first_run[node]; r < f->first_run[node + 1]; ++r) {
    const vista_run run = f->runs[r];
    const int64_t n = run.length_px, first = run.u_px, v = run.v_px;
    const int64_t u = n * first + n * (n - 1) / 2;
    sum->n += n;
    sum->u += u;
    sum->v += n * v;
    sum->uu += n * first * first + first * n * (n - 1) + n * (n - 1) * (2 * n - 1) / 6;
    sum->uv += u * v;
    sum->vv += n * v * v;
    if (run.u_px < sum->min_u) sum->min_u = run.u_px;
    if (run.v_px < sum->min_v) sum->min_v = run.v_px;
    if (run.u_px + run.length_px - 1 > sum->max_u) sum->max_u = run.u_px + run.length_px - 1;
    if (run.v_px > sum->max_v) sum->max_v = run.v_px;
  }
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

/* The surface as words are compared to it: to two numbers where it faces the camera. */
typedef struct target {
  const vista_plane *plane;
  double tolerance_px;
  bool facing;
  int16_t least, most;
} target;

static bool is_on(int32_t word, double surface_px, double tolerance_px) {
  return fabs(word * (1.0 / VISTA_DISPARITY_SCALE) - surface_px) <= tolerance_px;
}

/* The words from least to most are those that is_on is true of; rounding may be one off. */
static target aim(const vista_plane *plane, double tolerance_px) {
  target t = {.plane = plane, .tolerance_px = tolerance_px, .facing = plane->slope_u == 0.0 && plane->slope_v == 0.0};
  if (!t.facing) return t;
  const double low = ceil((plane->offset - tolerance_px) * VISTA_DISPARITY_SCALE);
  const double high = floor((plane->offset + tolerance_px) * VISTA_DISPARITY_SCALE);
  int32_t least = (int32_t)fmin(fmax(low, 0.0), INT16_MAX), most = (int32_t)fmin(fmax(high, -1.0), INT16_MAX);
  if (least > 0 && is_on(least - 1, plane->offset, tolerance_px)) --least;
  if (!is_on(least, plane->offset, tolerance_px)) ++least;
  if (most < INT16_MAX && is_on(most + 1, plane->offset, tolerance_px)) ++most;
  if (!is_on(most, plane->offset, tolerance_px)) --most;
  t.least = (int16_t)(least < INT16_MAX ? least : INT16_MAX);
  t.most = (int16_t)most;
  return t;
}

/* Takes out what is off the surface. start_px: of the surface, `first` pixels before the block. */
static inline void keep_on_surface(const target *t, const int16_t *words, double start_px, int32_t first,
                                   int16_t own[VISTA_WORD_BLOCK]) {
  if (t->facing) {
    const int16_t least = t->least, most = t->most;
    VISTA_BLOCK_LOOP
    for (int32_t i = 0; i < VISTA_WORD_BLOCK; ++i)
      own[i] = (int16_t)(own[i] & -((words[i] >= least) & (words[i] <= most)));
    return;
  }
  const double slope = t->plane->slope_u, tolerance_px = t->tolerance_px;
  VISTA_BLOCK_LOOP
  for (int32_t i = 0; i < VISTA_WORD_BLOCK; ++i) {
    const double residual_px = words[i] * (1.0 / VISTA_DISPARITY_SCALE) - (start_px + slope * (first + i));
    own[i] = (int16_t)(own[i] & -((words[i] >= 0) & (fabs(residual_px) <= tolerance_px)));
  }
}

/* Says beforehand which pixels of a cell belong, where its words alone tell. It takes longer to judge a cell of a
 * pixel's size than to look at it. */
static inline uint8_t foresee(const vista_region_view *w, const target *t, int32_t node) {
  if (node <= w->foveation->point_count) return VISTA_SOME_PIXELS;
  const bool mixed = w->mixed[node] != 0;
  if (w->cells->disparity_px[node] < 0.0f) return mixed ? VISTA_SOME_PIXELS : VISTA_ALL_PIXELS;
  if (vista_cell_off_plane(w, t->plane, t->tolerance_px, node)) return VISTA_NO_PIXEL;
  const vista_word_range range = w->cells->range[node];
  const bool all = !mixed && t->facing && range.valid == w->foveation->pixel_count[node] && range.least >= t->least &&
                   range.most <= t->most;
  return all ? VISTA_ALL_PIXELS : VISTA_SOME_PIXELS;
}

/* Which of a block's pixels the image gives to a region. */
static inline void mark_drawn(const int32_t *region_of_pixel, int32_t label, int16_t own[VISTA_WORD_BLOCK]) {
  VISTA_BLOCK_LOOP
  for (int32_t i = 0; i < VISTA_WORD_BLOCK; ++i) own[i] = (int16_t)-(region_of_pixel[i] == label);
}

/* The words of a cell whose pixels are all its region's, and whose surface faces the camera: run by run makes no
 * difference. What is marked beyond the cell's end the next one overwrites. */
static inline void mark_words(const target *t, const int16_t *words, int32_t count, int16_t *own) {
  for (int32_t i = 0; i < count; i += VISTA_WORD_BLOCK) {
    memset(own + i, 0xff, VISTA_WORD_BLOCK * sizeof *own);
    keep_on_surface(t, words + i, 0.0, 0, own + i);
  }
}

/* Marks the pixels of a cell. Blocks overlap: the next run overwrites what is beyond the end. */
VISTA_WIDE_VECTORS static void mark_cell(const vista_region_view *w, const target *t, int32_t label, int32_t node,
                                         int16_t *own) {
  const vista_foveation *const f = w->foveation;
  const bool mixed = w->mixed[node] != 0, whole = w->cells->disparity_px[node] < 0.0f;
  if (!mixed && whole) { /* of a pixel's size */
    memset(own, 0xff, (size_t)f->pixel_count[node] * sizeof *own);
    return;
  }
  const int16_t *words = w->cells->words + f->first_pixel[node];
  const int32_t *drawn = w->region_of_listed + f->first_pixel[node];
  if (!mixed && t->facing) {
    mark_words(t, words, f->pixel_count[node], own);
    return;
  }
  for (int32_t r = f->first_run[node]; r < f->first_run[node + 1]; ++r) {
    const vista_run run = f->runs[r];
    const double start_px = t->plane->offset + t->plane->slope_v * run.v_px + t->plane->slope_u * run.u_px;
    for (int32_t i = 0; i < run.length_px; i += VISTA_WORD_BLOCK) {
      if (mixed)
        mark_drawn(drawn + i, label, own + i);
      else
        memset(own + i, 0xff, VISTA_WORD_BLOCK * sizeof *own);
      if (!whole) keep_on_surface(t, words + i, start_px, i, own + i);
    }
    words += run.length_px;
    drawn += run.length_px;
    own += run.length_px;
  }
}

/* Takes those of a run's pixels out that are not inside. Blocks end with their run. */
static inline void narrow_run(const target *t, const int16_t *row, int32_t width, vista_run run, int32_t reach,
                              double start_px, int16_t *own) {
  int16_t copy[VISTA_WORD_BLOCK], inner[VISTA_WORD_BLOCK];
  for (int32_t i = 0; i < run.length_px; i += VISTA_WORD_BLOCK) {
    const int32_t left = run.length_px - i;
    int16_t any = 0;
    VISTA_BLOCK_LOOP
    for (int32_t k = 0; k < VISTA_WORD_BLOCK; ++k) any = (int16_t)(any | (own[i + k] & -(k < left)));
    if (any == 0) continue;
    VISTA_BLOCK_LOOP
    for (int32_t k = 0; k < VISTA_WORD_BLOCK; ++k) inner[k] = -1;
    keep_on_surface(t, vista_word_block(row, run.u_px + i - reach, width, copy), start_px, i - reach, inner);
    keep_on_surface(t, vista_word_block(row, run.u_px + i + reach, width, copy), start_px, i + reach, inner);
    VISTA_BLOCK_LOOP
    for (int32_t k = 0; k < VISTA_WORD_BLOCK; ++k) own[i + k] = (int16_t)(own[i + k] & (inner[k] | -(k >= left)));
  }
}

VISTA_WIDE_VECTORS static void narrow_cell(const vista_region_view *w, const target *t, int32_t reach, int32_t node,
                                           int16_t *own) {
  const int32_t width = w->foveation->width_px, end = w->foveation->first_run[node + 1];
  for (int32_t r = w->foveation->first_run[node]; r < end; ++r) {
    const vista_run run = w->foveation->runs[r];
    const int16_t *const row = w->disparity->data + run.v_px * w->disparity->stride;
    const double start_px =
        t->facing ? 0.0 : t->plane->offset + t->plane->slope_v * run.v_px + t->plane->slope_u * run.u_px;
    narrow_run(t, row, width, run, reach, start_px, own);
    own += run.length_px;
  }
}

static const moments nothing = {.min_u = INT32_MAX, .min_v = INT32_MAX, .max_u = INT32_MIN, .max_v = INT32_MIN};

VISTA_WIDE_VECTORS static moments find_pixels(const vista_region_view *w, const target *t, int32_t label) {
  const vista_foveation *const f = w->foveation;
  moments sum = nothing;
  int16_t *own = w->pixels;
  for (int32_t m = 0; m < w->member_count; ++m) {
    const int32_t node = w->members[m], count = f->pixel_count[node];
    w->own[m] = foresee(w, t, node);
    if (w->own[m] == VISTA_ALL_PIXELS) add_whole_cell(f, node, &sum);
    if (w->own[m] == VISTA_SOME_PIXELS) {
      mark_cell(w, t, label, node, own);
      memset(own + count, 0, VISTA_WORD_BLOCK * sizeof *own);
      add_cell(f, node, own, &sum);
    }
    own += count;
  }
  return sum;
}

VISTA_WIDE_VECTORS static moments keep_inner_pixels(const vista_region_view *w, const target *t) {
  const vista_foveation *const f = w->foveation;
  const int32_t reach = (int32_t)VISTA_BOUNDARY_PX;
  moments sum = nothing;
  int16_t *own = w->pixels;
  for (int32_t m = 0; m < w->member_count; ++m) {
    const int32_t node = w->members[m], count = f->pixel_count[node];
    const bool narrowed = reach > 0 && w->cells->disparity_px[node] >= 0.0f;
    if (w->own[m] == VISTA_ALL_PIXELS && !narrowed) add_whole_cell(f, node, &sum);
    if (w->own[m] == VISTA_SOME_PIXELS || (w->own[m] == VISTA_ALL_PIXELS && narrowed)) {
      int16_t next[VISTA_WORD_BLOCK]; /* marks of the next cell, hidden from the sums over whole blocks */
      if (w->own[m] == VISTA_ALL_PIXELS) memset(own, 0xff, (size_t)count * sizeof *own);
      if (narrowed) narrow_cell(w, t, reach, node, own);
      memcpy(next, own + count, sizeof next);
      memset(own + count, 0, sizeof next);
      add_cell(f, node, own, &sum);
      memcpy(own + count, next, sizeof next);
    }
    own += count;
  }
  return sum;
}

void vista_region_find_pixels(const vista_region_view *w, const vista_plane *surface, vista_region *region) {
  const target t = aim(surface, w->tolerance_px);
  const moments sum = find_pixels(w, &t, region->label);
  summarise(&sum, region);
}

void vista_region_keep_inner_pixels(const vista_region_view *w, const vista_plane *surface, vista_region *region) {
  const target t = aim(surface, w->tolerance_px);
  const moments sum = keep_inner_pixels(w, &t);
  summarise(&sum, region);
}
