#include "perceive/region/region_boundary.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#include "common/depth.h"
#include "common/wide_vectors.h"
#include "common/word_blocks.h"
#include "perceive/scales.h"

#define SPAN_TOLERANCES 4.0 /* a plane that spans fewer has no middle to be seen */
#define MIDDLE_SHARE 0.25   /* of the area that the middle third of a plane has if it is seen evenly */
#define MAX_TOLERANCE_PX 32.0 /* keeps the sums of squares of one run inside 32 bits */

double vista_region_tolerance_px(const vista_camera *camera, double disparity_px) {
  const double relief = (double)vista_depth_step_px(camera, (float)disparity_px, (float)VISTA_RELIEF_M);
  const double tolerance_px = relief > VISTA_SURFACE_PX ? relief : VISTA_SURFACE_PX;
  return tolerance_px < MAX_TOLERANCE_PX ? tolerance_px : MAX_TOLERANCE_PX;
}

typedef struct inliers {
  int32_t count;
  double mean_px, sigma_px; /* of their residuals */
} inliers;

static inliers summarise(int64_t count, double sum, double sum_of_squares) {
  if (count == 0) return (inliers){0};
  const double mean = sum / (double)count;
  return (inliers){(int32_t)count, mean, sqrt(fmax(sum_of_squares / (double)count - mean * mean, 0.0))};
}

/* No branch: which words are valid is hard to foresee. The others go to the bins of negative words, which nobody reads.
 * Neighbours often have the same word: each other one goes to a histogram of its own, so that none waits for the one
 * before. */
static void add_words(const int16_t *words, int32_t count, uint32_t *restrict bins, uint32_t *restrict other_bins) {
  int32_t i = 0;
  for (; i + 1 < count; i += 2) {
    bins[(uint16_t)words[i]]++;
    other_bins[(uint16_t)words[i + 1]]++;
  }
  if (i < count) bins[(uint16_t)words[i]]++;
}

/* Empties the second one into the first. */
VISTA_WIDE_VECTORS static void add_bins(int32_t low, int32_t top, uint32_t *restrict bins,
                                        uint32_t *restrict other_bins) {
  for (int32_t b = low; b <= top; ++b) {
    bins[b] += other_bins[b];
    other_bins[b] = 0;
  }
}

/* Histogram of the words under the boundary. */
static vista_word_range count_boundary(const vista_region_view *w, vista_region *region) {
  vista_word_range found = {0, INT16_MAX, 0};
  for (int32_t m = 0; m < w->member_count; ++m) {
    const int32_t node = w->members[m], count = w->foveation->pixel_count[node];
    if (!w->boundary[node]) continue;
    region->boundary_pixels += count;
    const vista_word_range *const range = &w->cells->range[node];
    if (range->valid == 0) continue;
    found.valid += range->valid;
    found.least = range->least < found.least ? range->least : found.least;
    found.most = range->most > found.most ? range->most : found.most;
    add_words(w->cells->words + w->foveation->first_pixel[node], count, w->bins, w->bins + VISTA_ALL_WORDS);
  }
  add_bins(found.least, found.most, w->bins, w->bins + VISTA_ALL_WORDS);
  region->boundary_valid += found.valid;
  return found;
}

double vista_region_mode_px(const vista_region_view *w, int32_t low, int32_t top) {
  const vista_camera *const camera = w->frame->camera;
  const uint32_t *const bins = w->bins;
  const bool even = vista_region_tolerance_px(camera, top / (double)VISTA_DISPARITY_SCALE) ==
                    VISTA_SURFACE_PX; /* it grows with the disparity: the least is that of all */
  const double least_width = 2.0 * VISTA_DISPARITY_SCALE * VISTA_SURFACE_PX;
  uint32_t sum = 0, best = 0;
  double mode = 0.0;
  for (int32_t end = low, start = 0; end <= top; ++end) {
    if (bins[end] == 0) continue; /* a best window can end on a word that occurs */
    const double width =
        even ? least_width
             : 2.0 * VISTA_DISPARITY_SCALE * vista_region_tolerance_px(camera, end / (double)VISTA_DISPARITY_SCALE);
    if (sum == 0 && end - start > width) start = (int32_t)ceil(end - width); /* nothing lies in between */
    sum += bins[end];
    while (end - start > width) sum -= bins[start++];
    if (sum > best) {
      best = sum;
      mode = 0.5 * (end + start) / VISTA_DISPARITY_SCALE;
    }
  }
  return mode;
}

static inliers inliers_around(const uint32_t *bins, double center_px, double tolerance) {
  const int32_t first = (int32_t)fmax(ceil((center_px - tolerance) * VISTA_DISPARITY_SCALE), 0.0);
  const int32_t last = (int32_t)fmin(floor((center_px + tolerance) * VISTA_DISPARITY_SCALE), VISTA_WORD_BINS - 1);
  int64_t count = 0;
  double sum = 0.0, squares = 0.0;
  for (int32_t b = first; b <= last; ++b) {
    const double residual = b / (double)VISTA_DISPARITY_SCALE - center_px;
    count += bins[b];
    sum += bins[b] * residual;
    squares += bins[b] * residual * residual;
  }
  return summarise(count, sum, squares);
}

/* How far a cell is off a plane. */
static double off_px(const vista_region_view *w, const vista_plane *plane, int32_t node) {
  return (double)w->cells->disparity_px[node] -
         vista_plane_at(plane, (double)w->foveation->center_u[node], (double)w->foveation->center_v[node]);
}

/* Plane through the region's cells, weighted by their area; cells far off the first fit are left out of a second.
 * *range_px: from the plane's nearest to its farthest disparity, were the cells spread evenly. */
static bool fit_plane(const vista_region_view *w, vista_plane *plane, double *range_px) {
  for (int pass = 0; pass < 2; ++pass) {
    vista_plane_fit fit = {0};
    int32_t used = 0;
    for (int32_t m = 0; m < w->member_count; ++m) {
      const int32_t node = w->members[m];
      const double d = (double)w->cells->disparity_px[node];
      if (d < 0.0) continue;
      const double u = (double)w->foveation->center_u[node], v = (double)w->foveation->center_v[node];
      if (pass > 0 && fabs(off_px(w, plane, node)) > 2.0 * w->tolerance_px) continue;
      const double size = (double)w->foveation->size_px[node];
      vista_plane_fit_add(&fit, u, v, d, size * size);
      used++;
    }
    if (used < VISTA_SLOPE_POINTS || !vista_plane_fit_solve(&fit, plane)) return false;
    *range_px = sqrt(12.0) * vista_plane_fit_spread(&fit, plane);
  }
  return true;
}

/* Area of the cells whose disparity lies on a surface. */
static double area_on(const vista_region_view *w, const vista_plane *plane) {
  double area = 0.0;
  for (int32_t m = 0; m < w->member_count; ++m) {
    const int32_t node = w->members[m];
    const double size = (double)w->foveation->size_px[node];
    if (w->cells->disparity_px[node] >= 0.0f && fabs(off_px(w, plane, node)) <= w->tolerance_px) area += size * size;
  }
  return area;
}

/* Whether a plane that spans several tolerances is seen between its ends, too. A gap between two things has words at
 * its edges only, half a block of either thing, and a plane leads through both. */
static bool seen_throughout(const vista_region_view *w, const vista_plane *plane) {
  double low = INFINITY, high = -INFINITY, all = 0.0, between = 0.0;
  for (int pass = 0; pass < 2; ++pass)
    for (int32_t m = 0; m < w->member_count; ++m) {
      const int32_t node = w->members[m];
      const double size = (double)w->foveation->size_px[node], d = (double)w->cells->disparity_px[node];
      if (d < 0.0 || fabs(off_px(w, plane, node)) > w->tolerance_px) continue;
      if (pass == 0) {
        low = fmin(low, d);
        high = fmax(high, d);
        all += size * size;
      } else if (fabs(2.0 * d - low - high) <= (high - low) / 3.0) {
        between += size * size;
      }
    }
  return high - low < SPAN_TOLERANCES * w->tolerance_px || 3.0 * between >= MIDDLE_SHARE * all;
}

#define SLOPE_MAX 8.0
#define FIXED_BITS 12 /* of a sixteenth of a pixel */

static int32_t to_fixed(double disparity_px) {
  const double limit = 1 << 28;
  return (int32_t)lround(fmin(fmax(disparity_px * VISTA_DISPARITY_SCALE * (1 << FIXED_BITS), -limit), limit));
}

#define FLUSHED 4096 /* blocks whose squares, of MAX_TOLERANCE_PX at most, fit 32 bits */

/* Sums lane by lane, of residuals in whole engine words. */
typedef struct lane_sums {
  int32_t count[VISTA_WORD_BLOCK], sum[VISTA_WORD_BLOCK], squares[VISTA_WORD_BLOCK];
  int32_t blocks;
} lane_sums;

typedef struct totals {
  int64_t count, sum, squares;
} totals;

static inline void add_lanes(lane_sums *lanes, totals *all) {
  for (int32_t i = 0; i < VISTA_WORD_BLOCK; ++i) {
    all->count += lanes->count[i];
    all->sum += lanes->sum[i];
    all->squares += lanes->squares[i];
  }
  *lanes = (lane_sums){0};
}

/* The first `length` words of a block, against a surface that is at `start` plus half a word at its first one. */
static inline void add_block(const int16_t *restrict words, int32_t length, int32_t start, int32_t slope,
                             int32_t tolerance, lane_sums *restrict lanes) {
  VISTA_BLOCK_LOOP
  for (int32_t i = 0; i < VISTA_WORD_BLOCK; ++i) {
    const int32_t residual = words[i] - ((start + i * slope) >> FIXED_BITS);
    const int32_t in =
        -((words[i] >= 0) & (residual <= tolerance) & (residual >= -tolerance) & (i < length)); /* a mask */
    const int32_t counted = residual & in;
    lanes->count[i] -= in;
    lanes->sum[i] += counted;
    lanes->squares[i] += counted * counted;
  }
}

/* Residuals from the plane in whole engine words: integers, so that the loop is vectorised. */
VISTA_WIDE_VECTORS static inliers boundary_inliers(const vista_region_view *w, const vista_plane *plane) {
  totals all = {0};
  lane_sums lanes = {0};
  const int32_t slope = to_fixed(fmin(fmax(plane->slope_u, -SLOPE_MAX), SLOPE_MAX));
  const int32_t tolerance = (int32_t)(w->tolerance_px * VISTA_DISPARITY_SCALE);
  const bool judged = fabs(plane->slope_u) < SLOPE_MAX;
  for (int32_t m = 0; m < w->member_count; ++m) {
    const int32_t node = w->members[m];
    if (!w->boundary[node] || (judged && vista_cell_off_plane(w, plane, w->tolerance_px, node))) continue;
    const int16_t *words = w->cells->words + w->foveation->first_pixel[node];
    for (int32_t r = w->foveation->first_run[node]; r < w->foveation->first_run[node + 1]; ++r) {
      const vista_run run = w->foveation->runs[r];
      const int32_t start = to_fixed(vista_plane_at(plane, run.u_px, run.v_px)) + (1 << (FIXED_BITS - 1));
      for (int32_t i = 0; i < run.length_px; i += VISTA_WORD_BLOCK) {
        add_block(words + i, run.length_px - i, start + i * slope, slope, tolerance, &lanes);
        if (++lanes.blocks == FLUSHED) add_lanes(&lanes, &all);
      }
      words += run.length_px;
    }
  }
  add_lanes(&lanes, &all);
  const double unit = 1.0 / VISTA_DISPARITY_SCALE;
  return summarise(all.count, (double)all.sum * unit, (double)all.squares * unit * unit);
}

/* The boundary against the surface that explains it best; false: no valid pixel there. */
bool vista_region_measure_boundary(vista_region_view *w, vista_region *region, vista_plane *surface) {
  const vista_camera *const camera = w->frame->camera;
  const vista_word_range found = count_boundary(w, region);
  if (region->boundary_valid == 0) return false;
  const double mode = vista_region_mode_px(w, found.least, found.most);
  w->tolerance_px = vista_region_tolerance_px(camera, mode);
  const inliers around_mode = inliers_around(w->bins, mode, w->tolerance_px);
  *surface = (vista_plane){.offset = mode + around_mode.mean_px}; /* mode, refined by the mean around it */
  inliers in = inliers_around(w->bins, surface->offset, w->tolerance_px);
  memset(w->bins + found.least, 0, (size_t)(found.most - found.least + 1) * sizeof *w->bins);

  const double u = (double)w->foveation->center_u[w->members[0]], v = (double)w->foveation->center_v[w->members[0]];
  vista_plane plane;
  double range_px;
  if (fit_plane(w, &plane, &range_px)) {
    if (range_px >= w->tolerance_px) /* a slope that the noise cannot make */
      region->inclination_deg = vista_plane_inclination_deg(camera, w->frame->up_camera, u, v,
                                                            vista_plane_at(&plane, u, v), plane.slope_u, plane.slope_v);
    if (area_on(w, &plane) > 1.1 * area_on(w, surface) && seen_throughout(w, &plane)) {
      *surface = plane;
      in = boundary_inliers(w, &plane);
    }
  }
  surface->offset += in.mean_px;
  region->boundary_inliers = in.count;
  region->disparity_sigma_px = in.sigma_px;
  region->slope_u = surface->slope_u;
  region->slope_v = surface->slope_v;
  region->disparity_px = vista_plane_at(surface, u, v); /* until the centre is known */
  return in.count > 0;
}
