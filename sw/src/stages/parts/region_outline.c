#include "stages/parts/region_outline.h"

#include <math.h>
#include <string.h>

#include "common/bits.h"
#include "common/depth.h"

#define SIDE_BINS 32 /* of the height of the left and the right edge, and of the width of the foot */

typedef struct box {
  double min_u, min_v, max_u, max_v;
} box;

typedef enum side { SIDE_LEFT, SIDE_RIGHT, SIDE_TOP, SIDE_FOOT, SIDE_COUNT } side;

/* Where one arc out of the region crosses its outline. */
typedef struct crossing {
  side side;
  int32_t node; /* of its two cells, outer before inner, the one with a disparity; negative: neither has one */
  double u_px, v_px, length_px;
} crossing;

static crossing cross(const vista_region_view *w, int32_t inner, int32_t outer) {
  const float *const d = w->cells->disparity_px;
  const vista_foveation *const f = w->foveation;
  const double du = (double)(f->center_u[outer] - f->center_u[inner]);
  const double dv = (double)(f->center_v[outer] - f->center_v[inner]);
  const bool across = fabs(du) > fabs(dv);
  return (crossing){.side = across ? (du < 0.0 ? SIDE_LEFT : SIDE_RIGHT) : (dv < 0.0 ? SIDE_TOP : SIDE_FOOT),
                    .node = d[outer] > 0.0f   ? outer
                            : d[inner] > 0.0f ? inner
                                              : -1,
                    .u_px = (double)f->center_u[inner] + 0.5 * du,
                    .v_px = (double)f->center_v[inner] + 0.5 * dv,
                    .length_px = (double)f->size_px[inner]};
}

/* Extent of the region, and the share of its area that has a disparity. */
static double measure_inside(const vista_region_view *w, box *extent) {
  double area = 0.0, matched = 0.0;
  *extent = (box){INFINITY, INFINITY, -INFINITY, -INFINITY};
  for (int32_t m = 0; m < w->member_count; ++m) {
    const int32_t node = w->members[m];
    const double half = 0.5 * (double)w->foveation->size_px[node];
    const double u = (double)w->foveation->center_u[node], v = (double)w->foveation->center_v[node];
    *extent = (box){fmin(extent->min_u, u - half), fmin(extent->min_v, v - half), fmax(extent->max_u, u + half),
                    fmax(extent->max_v, v + half)};
    area += half * half;
    if (w->cells->disparity_px[node] >= 0.0f) matched += half * half;
  }
  return matched / area;
}

/* Those of SIDE_BINS between first and last that a stretch of the outline covers. */
static uint32_t covered(double first, double last, double center, double length) {
  const double scale = SIDE_BINS / (last - first);
  const int from = (int)fmax(floor((center - 0.5 * length - first) * scale + 0.5), 0.0);
  const int to = (int)fmin(floor((center + 0.5 * length - first) * scale + 0.5), SIDE_BINS);
  uint32_t bins = 0;
  for (int b = from; b < to; ++b) bins |= UINT32_C(1) << b;
  return bins;
}

static double share(uint32_t bins) { return (double)vista_window_count(bins, SIDE_BINS) / SIDE_BINS; }

static double above_ground_m(const vista_surfaces *s, const vista_camera *camera, double u_px, double v_px,
                             double disparity_px) {
  return vista_plane_height_m(&s->ground, camera, u_px, v_px, disparity_px);
}

static bool upright(const crossing *at) { return at->side == SIDE_LEFT || at->side == SIDE_RIGHT; }

/* Histogram of the disparities of what stands along the upright edges; returns the largest word. */
static int32_t count_edges(const vista_region_view *w, const int32_t *label, vista_region *region) {
  const vista_graph *const graph = &w->foveation->graph;
  int32_t top = 0;
  for (int32_t m = 0; m < w->member_count; ++m) {
    const int32_t i = w->members[m];
    for (int32_t arc = graph->first_arc[i]; arc < graph->first_arc[i + 1]; ++arc) {
      if (label[graph->head[arc]] == region->label) continue;
      const crossing at = cross(w, i, graph->head[arc]);
      if (!upright(&at)) continue;
      region->boundary_pixels += (int32_t)at.length_px;
      if (at.node < 0 || w->surfaces->horizontal[at.node]) continue;
      const int32_t word = (int32_t)(w->cells->disparity_px[at.node] * VISTA_DISPARITY_SCALE);
      if (word >= VISTA_WORD_BINS) continue;
      region->boundary_valid += (int32_t)at.length_px;
      w->bins[word] += (uint32_t)at.length_px;
      if (word > top) top = word;
    }
  }
  return top;
}

typedef struct edges {
  uint32_t seen[SIDE_COUNT]; /* bins of each side that are at the depth of the thing */
  double length_px, sum_px, sum_of_squares_px2; /* of the upright ones, and of their residuals */
} edges;

/* What of the outline lies at mode_px: standing cells beside it, and ground below it where the thing would stand. */
static edges find_edges(const vista_region_view *w, const vista_camera *camera, const int32_t *label,
                        const vista_region *region, const box *extent, double mode_px) {
  const vista_graph *const graph = &w->foveation->graph;
  const double foot_m = (double)vista_limit_m(camera, (float)mode_px, (float)w->params->foot_m);
  edges found = {0};
  for (int32_t m = 0; m < w->member_count; ++m) {
    const int32_t i = w->members[m];
    for (int32_t arc = graph->first_arc[i]; arc < graph->first_arc[i + 1]; ++arc) {
      if (label[graph->head[arc]] == region->label) continue;
      const crossing at = cross(w, i, graph->head[arc]);
      if (at.node < 0) continue;
      const bool ground = w->surfaces->horizontal[at.node];
      const double residual = (double)w->cells->disparity_px[at.node] - mode_px;
      if (upright(&at) && !ground && fabs(residual) <= w->tolerance_px) {
        found.seen[at.side] |= covered(extent->min_v, extent->max_v, at.v_px, at.length_px);
        found.length_px += at.length_px;
        found.sum_px += at.length_px * residual;
        found.sum_of_squares_px2 += at.length_px * residual * residual;
      } else if (at.side == SIDE_FOOT && ground) {
        const double height_m = above_ground_m(w->surfaces, camera, at.u_px, at.v_px, mode_px);
        if (fabs(height_m) <= foot_m)
          found.seen[SIDE_FOOT] |= covered(extent->min_u, extent->max_u, at.u_px, at.length_px);
      }
    }
  }
  return found;
}

bool vista_region_owns_outline(vista_region_view *w, const vista_camera *camera, const int32_t *label,
                               vista_region *region) {
  box extent;
  if (!w->surfaces->ground_found || measure_inside(w, &extent) > w->params->min_valid_fraction) return false;
  const int32_t top = count_edges(w, label, region);
  const double mode_px = vista_region_mode_px(w, camera, 0, top);
  memset(w->bins, 0, ((size_t)top + 1) * sizeof *w->bins);
  if (mode_px <= 0.0) return false;
  w->tolerance_px = vista_region_tolerance_px(w->params, camera, mode_px);
  const double top_m = above_ground_m(w->surfaces, camera, 0.5 * (extent.min_u + extent.max_u), extent.min_v, mode_px);
  if (top_m < (double)vista_limit_m(camera, (float)mode_px, (float)w->params->min_height_m)) return false;
  const edges found = find_edges(w, camera, label, region, &extent, mode_px);
  for (int k = 0; k < SIDE_COUNT; ++k)
    if (k != SIDE_TOP && share(found.seen[k]) < w->params->outline_fraction) return false;
  const double mean_px = found.sum_px / found.length_px;
  region->plain = true;
  region->disparity_px = mode_px + mean_px;
  region->disparity_sigma_px = sqrt(fmax(found.sum_of_squares_px2 / found.length_px - mean_px * mean_px, 0.0));
  region->boundary_inliers = (int32_t)found.length_px;
  return true;
}
