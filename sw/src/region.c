#include "vista/region.h"

#include <math.h>
#include <stdbool.h>
#include <stddef.h>

#include "depth.h"
#include "ground.h"
#include "plane_fit.h"
#include "vista/surface.h"

#define BINS (256 * VISTA_DISPARITY_SCALE + 1) /* one an engine word */
#define PLANE_MIN_CELLS 6                        /* fewer do not tell a slope from noise */

static const char *const verdict_names[VISTA_REGION_VERDICT_COUNT] = {
    [VISTA_REGION_ACCEPTED] = "ACCEPTED",
    [VISTA_REGION_TOO_FEW_PIXELS] = "TOO_FEW_PIXELS",
    [VISTA_REGION_LOW_SUPPORT] = "LOW_SUPPORT",
    [VISTA_REGION_INCONSISTENT] = "INCONSISTENT",
    [VISTA_REGION_HORIZONTAL] = "HORIZONTAL",
    [VISTA_REGION_TOO_FAR] = "TOO_FAR",
    [VISTA_REGION_TOO_SMALL] = "TOO_SMALL",
};

const char *vista_region_verdict_name(vista_region_verdict verdict) {
  return (unsigned)verdict < VISTA_REGION_VERDICT_COUNT ? verdict_names[verdict] : "UNKNOWN";
}

vista_status vista_regions_layout(vista_regions *regions, vista_arena *arena, const vista_foveation *foveation) {
  if (regions == NULL || arena == NULL || foveation == NULL) return VISTA_ERROR_ARGUMENT;
  const size_t nodes = (size_t)foveation->max_nodes;
  regions->items = vista_arena_take(arena, nodes, sizeof(vista_region));
  regions->first_member = vista_arena_take(arena, nodes + 1, sizeof(int32_t));
  regions->members = vista_arena_take(arena, nodes, sizeof(int32_t));
  regions->boundary = vista_arena_take(arena, nodes, sizeof(uint8_t));
  return arena->base != NULL && arena->used > arena->size ? VISTA_ERROR_MEMORY : VISTA_OK;
}

static void group_members(const vista_foveation *foveation, const int32_t *label, vista_regions *regions) {
  const vista_graph *const graph = &foveation->graph;
  int32_t *const first = regions->first_member;
  for (int32_t k = 0; k <= regions->count; ++k) first[k] = 0;
  for (int32_t i = 0; i < graph->node_count; ++i) {
    regions->boundary[i] = 0;
    if (label[i] < 0) continue;
    first[label[i] + 1]++;
    for (int32_t arc = graph->first_arc[i]; arc < graph->first_arc[i + 1]; ++arc)
      if (label[graph->head[arc]] != label[i]) regions->boundary[i] = 1;
  }
  for (int32_t k = 0; k < regions->count; ++k) first[k + 1] += first[k];
  for (int32_t i = 0; i < graph->node_count; ++i)
    if (label[i] >= 0) regions->members[first[label[i]]++] = i;
  for (int32_t k = regions->count; k > 0; --k) first[k] = first[k - 1];
  first[0] = 0;
}

/* What the statistics of one region read. */
typedef struct view {
  const vista_foveation *foveation;
  const vista_region_params *params;
  const vista_disparity_image *disparity;
  const vista_cells *cells;
  const vista_surfaces *surfaces;
  const vista_regions *regions;
  const int32_t *members;
  int32_t member_count;
  double tolerance_px; /* at the region's disparity */
} view;

static const int16_t *run_words(const view *w, vista_run run) {
  return w->disparity->data + run.v_px * w->disparity->stride + run.u_px;
}

static double tolerance_px(const vista_region_params *params, const vista_camera *camera, double disparity_px) {
  return fmax(params->tolerance_px,
              (double)vista_depth_step_px(camera, (float)disparity_px, (float)params->tolerance_m));
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

/* Histogram of the words under the boundary. */
static void count_boundary(const view *w, vista_region *region, uint32_t *bins) {
  for (int32_t m = 0; m < w->member_count; ++m) {
    const int32_t node = w->members[m];
    if (!w->regions->boundary[node]) continue;
    for (int32_t r = w->foveation->first_run[node]; r < w->foveation->first_run[node + 1]; ++r) {
      const vista_run run = w->foveation->runs[r];
      const int16_t *const words = run_words(w, run);
      region->boundary_pixels += run.length_px;
      for (int32_t i = 0; i < run.length_px; ++i) {
        if (words[i] < 0) continue;
        region->boundary_valid++;
        bins[words[i]]++;
      }
    }
  }
}

/* Centre of the window of width 2 tolerance that holds most words; the window grows with the disparity. */
static double mode_px(const view *w, const vista_camera *camera, const uint32_t *bins) {
  uint32_t sum = 0, best = 0;
  double mode = 0.0;
  for (int32_t end = 0, start = 0; end < BINS; ++end) {
    if (bins[end] == 0) continue; /* a best window can end on a word that occurs */
    const double width = 2.0 * VISTA_DISPARITY_SCALE * tolerance_px(w->params, camera, end / (double)VISTA_DISPARITY_SCALE);
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
  const int32_t last = (int32_t)fmin(floor((center_px + tolerance) * VISTA_DISPARITY_SCALE), BINS - 1);
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

/* Plane through the region's cells, weighted by their area; cells far off the first fit are left out of a second. */
static bool fit_plane(const view *w, vista_plane *plane) {
  for (int pass = 0; pass < 2; ++pass) {
    vista_plane_fit fit = {0};
    int32_t used = 0;
    for (int32_t m = 0; m < w->member_count; ++m) {
      const int32_t node = w->members[m];
      const double d = (double)w->cells->disparity_px[node];
      if (d < 0.0) continue;
      const double u = (double)w->foveation->center_u[node], v = (double)w->foveation->center_v[node];
      const double residual = pass == 0 ? 0.0 : d - plane->offset - plane->slope_u * u - plane->slope_v * v;
      if (fabs(residual) > 2.0 * w->tolerance_px) continue;
      const double size = (double)w->foveation->size_px[node];
      vista_plane_fit_add(&fit, u, v, d, size * size);
      used++;
    }
    if (used < PLANE_MIN_CELLS || !vista_plane_fit_solve(&fit, plane)) return false;
  }
  return true;
}

/* Area of the cells whose disparity lies on a surface. */
static double area_on(const view *w, const vista_plane *plane) {
  double area = 0.0;
  for (int32_t m = 0; m < w->member_count; ++m) {
    const int32_t node = w->members[m];
    const double size = (double)w->foveation->size_px[node], d = (double)w->cells->disparity_px[node];
    const double expected = plane->offset + plane->slope_u * (double)w->foveation->center_u[node] +
                            plane->slope_v * (double)w->foveation->center_v[node];
    if (d >= 0.0 && fabs(d - expected) <= w->tolerance_px) area += size * size;
  }
  return area;
}

static inliers boundary_inliers(const view *w, const vista_plane *plane) {
  int64_t count = 0;
  double sum = 0.0, squares = 0.0;
  for (int32_t m = 0; m < w->member_count; ++m) {
    const int32_t node = w->members[m];
    if (!w->regions->boundary[node]) continue;
    for (int32_t r = w->foveation->first_run[node]; r < w->foveation->first_run[node + 1]; ++r) {
      const vista_run run = w->foveation->runs[r];
      const int16_t *const words = run_words(w, run);
      const double start = plane->offset + plane->slope_v * run.v_px + plane->slope_u * run.u_px;
      for (int32_t i = 0; i < run.length_px; ++i) {
        const double residual = words[i] * (1.0 / VISTA_DISPARITY_SCALE) - start - plane->slope_u * i;
        if (words[i] < 0 || fabs(residual) > w->tolerance_px) continue;
        count++;
        sum += residual;
        squares += residual * residual;
      }
    }
  }
  return summarise(count, sum, squares);
}

typedef struct moments {
  double n, u, v, uu, uv, vv;
} moments;

static void add_pixels(moments *sum, vista_region *region, int32_t u, int32_t v, int32_t length) {
  /* closed sums over u .. u + length - 1 */
  const double n = length, middle = u + 0.5 * (n - 1.0);
  sum->n += n;
  sum->u += n * middle;
  sum->v += n * v;
  sum->uu += n * middle * middle + n * (n * n - 1.0) / 12.0;
  sum->uv += n * middle * v;
  sum->vv += n * v * v;
  if (u < region->min_u_px) region->min_u_px = u;
  if (u + length - 1 > region->max_u_px) region->max_u_px = u + length - 1;
  if (v < region->min_v_px) region->min_v_px = v;
  if (v > region->max_v_px) region->max_v_px = v;
}

/* Moments of the pixels on the surface; cells without a disparity count whole. */
static void own_pixels(const view *w, const vista_plane *plane, vista_region *region) {
  moments sum = {0};
  region->min_u_px = region->min_v_px = INT32_MAX;
  region->max_u_px = region->max_v_px = INT32_MIN;
  for (int32_t m = 0; m < w->member_count; ++m) {
    const int32_t node = w->members[m];
    const bool whole = w->cells->disparity_px[node] < 0.0f;
    for (int32_t r = w->foveation->first_run[node]; r < w->foveation->first_run[node + 1]; ++r) {
      const vista_run run = w->foveation->runs[r];
      if (whole) {
        add_pixels(&sum, region, run.u_px, run.v_px, run.length_px);
        continue;
      }
      const int16_t *const words = run_words(w, run);
      const double start = plane->offset + plane->slope_v * run.v_px + plane->slope_u * run.u_px;
      int32_t open = -1; /* first pixel of the current stretch of own pixels */
      for (int32_t i = 0; i <= run.length_px; ++i) {
        const bool own = i < run.length_px && words[i] >= 0 &&
                         fabs(words[i] * (1.0 / VISTA_DISPARITY_SCALE) - start - plane->slope_u * i) <=
                             w->tolerance_px;
        if (own && open < 0) open = i;
        if (!own && open >= 0) {
          add_pixels(&sum, region, run.u_px + open, run.v_px, i - open);
          open = -1;
        }
      }
    }
  }
  region->pixel_count = (int32_t)sum.n;
  if (region->pixel_count == 0) return;
  region->mean_u_px = sum.u / sum.n;
  region->mean_v_px = sum.v / sum.n;
  region->cov_uu_px2 = fmax(sum.uu / sum.n - region->mean_u_px * region->mean_u_px, 0.0);
  region->cov_uv_px2 = sum.uv / sum.n - region->mean_u_px * region->mean_v_px;
  region->cov_vv_px2 = fmax(sum.vv / sum.n - region->mean_v_px * region->mean_v_px, 0.0);
}

static double plane_at(const vista_plane *plane, double u_px, double v_px) {
  return plane->offset + plane->slope_u * u_px + plane->slope_v * v_px;
}

/* The boundary against the surface that explains it best; false: no valid pixel there. */
static bool measure_boundary(view *w, const vista_camera *camera, const double up_camera[3], vista_region *region,
                             vista_plane *surface) {
  uint32_t bins[BINS] = {0};
  count_boundary(w, region, bins);
  if (region->boundary_valid == 0) return false;
  const double mode = mode_px(w, camera, bins);
  w->tolerance_px = tolerance_px(w->params, camera, mode);
  const inliers around_mode = inliers_around(bins, mode, w->tolerance_px);
  *surface = (vista_plane){.offset = mode + around_mode.mean_px}; /* mode, refined by the mean around it */
  inliers in = inliers_around(bins, surface->offset, w->tolerance_px);

  const double u = (double)w->foveation->center_u[w->members[0]], v = (double)w->foveation->center_v[w->members[0]];
  vista_plane plane;
  if (fit_plane(w, &plane)) {
    region->inclination_deg = vista_plane_inclination_deg(camera, up_camera, u, v, plane_at(&plane, u, v),
                                                          plane.slope_u, plane.slope_v);
    if (area_on(w, &plane) > 1.1 * area_on(w, surface)) {
      *surface = plane;
      in = boundary_inliers(w, &plane);
    }
  }
  surface->offset += in.mean_px;
  region->boundary_inliers = in.count;
  region->disparity_sigma_px = in.sigma_px;
  region->slope_u = surface->slope_u;
  region->slope_v = surface->slope_v;
  region->disparity_px = plane_at(surface, u, v); /* until the centre is known */
  return in.count > 0;
}

static vista_region_verdict judge_boundary(const view *w, double horizontal_deg, const vista_region *region) {
  const vista_region_params *const p = w->params;
  if (region->boundary_inliers < p->min_inliers) return VISTA_REGION_TOO_FEW_PIXELS;
  if (region->boundary_valid < p->min_valid_fraction * region->boundary_pixels) return VISTA_REGION_LOW_SUPPORT;
  if (region->boundary_inliers < p->min_inlier_fraction * region->boundary_valid ||
      region->disparity_sigma_px > p->max_sigma_ratio * w->tolerance_px)
    return VISTA_REGION_INCONSISTENT;
  if (region->inclination_deg > horizontal_deg) return VISTA_REGION_HORIZONTAL;
  return VISTA_REGION_ACCEPTED;
}

/* Cheap tests first; only what passes them is measured further. */
static vista_region_verdict measure(view *w, const vista_camera *camera, const double up_camera[3],
                                    double horizontal_deg, vista_region *region) {
  vista_plane surface;
  if (!measure_boundary(w, camera, up_camera, region, &surface)) return VISTA_REGION_TOO_FEW_PIXELS;
  const vista_region_verdict verdict = judge_boundary(w, horizontal_deg, region);
  if (verdict != VISTA_REGION_ACCEPTED) return verdict;
  region->standing_fraction = vista_standing_fraction(w->foveation, camera, w->cells, w->surfaces, w->members,
                                                      w->member_count, w->params->min_height_m);
  if (region->standing_fraction < w->params->min_standing_fraction) return VISTA_REGION_HORIZONTAL;
  own_pixels(w, &surface, region);
  region->disparity_px = plane_at(&surface, region->mean_u_px, region->mean_v_px);
  if (region->disparity_px < w->params->min_disparity_px) return VISTA_REGION_TOO_FAR;
  const double larger_px = 4.0 * sqrt(fmax(region->cov_uu_px2, region->cov_vv_px2));
  if (larger_px * camera->baseline_m / region->disparity_px < w->params->min_size_m) return VISTA_REGION_TOO_SMALL;
  return VISTA_REGION_ACCEPTED;
}

vista_status vista_regions_compute(const vista_foveation *foveation, const vista_region_params *params,
                                   const vista_camera *camera, const double up_camera[3], double horizontal_deg,
                                   const vista_disparity_image *disparity, const vista_cells *cells,
                                   const vista_surfaces *surfaces, const vista_segmentation *segmentation,
                                   vista_regions *regions) {
  if (foveation == NULL || params == NULL || camera == NULL || up_camera == NULL || disparity == NULL ||
      cells == NULL || surfaces == NULL || segmentation == NULL || regions == NULL)
    return VISTA_ERROR_ARGUMENT;
  if (disparity->width_px != foveation->width_px || disparity->height_px != foveation->height_px)
    return VISTA_ERROR_SIZE;
  regions->count = segmentation->region_count;
  regions->accepted_count = 0;
  group_members(foveation, segmentation->label, regions);
  for (int32_t k = 0; k < regions->count; ++k) {
    const int32_t first = regions->first_member[k], count = regions->first_member[k + 1] - first;
    view w = {foveation, params, disparity, cells, surfaces, regions, regions->members + first, count, 0.0};
    vista_region *const region = &regions->items[k];
    *region = (vista_region){.label = k, .node_count = count, .inclination_deg = NAN, .standing_fraction = NAN};
    region->verdict = count > 0 ? measure(&w, camera, up_camera, horizontal_deg, region) : VISTA_REGION_TOO_FEW_PIXELS;
    regions->accepted_count += regions->items[k].verdict == VISTA_REGION_ACCEPTED;
  }
  return VISTA_OK;
}
