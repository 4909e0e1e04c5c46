#include "stages/parts/region_boundary.h"

#include <math.h>
#include <string.h>

#include "common/depth.h"

#define PLANE_MIN_CELLS 6     /* fewer do not tell a slope from noise */
#define MAX_TOLERANCE_PX 32.0 /* keeps the sums of squares of one run inside 32 bits */

double vista_region_tolerance_px(const vista_region_params *params, const vista_camera *camera, double disparity_px) {
  const double relief = (double)vista_depth_step_px(camera, (float)disparity_px, (float)params->tolerance_m);
  return fmin(fmax(params->tolerance_px, relief), MAX_TOLERANCE_PX);
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

/* Histogram of the words under the boundary; returns the largest of them. */
static int32_t count_boundary(const vista_region_view *w, vista_region *region) {
  int32_t top = 0, valid = 0;
  for (int32_t m = 0; m < w->member_count; ++m) {
    const int32_t node = w->members[m];
    if (!w->boundary[node]) continue;
    for (int32_t r = w->foveation->first_run[node]; r < w->foveation->first_run[node + 1]; ++r) {
      const vista_run run = w->foveation->runs[r];
      const int16_t *const words = vista_region_words(w, run);
      region->boundary_pixels += run.length_px;
      for (int32_t i = 0; i < run.length_px; ++i) { /* no branch: which words are valid is hard to foresee */
        const int32_t is_valid = vista_word_valid(words[i]), word = is_valid ? words[i] : 0;
        valid += is_valid;
        w->bins[word] += (uint32_t)is_valid;
        top = word > top ? word : top;
      }
    }
  }
  region->boundary_valid += valid;
  return top;
}

double vista_region_mode_px(const vista_region_view *w, const vista_camera *camera, int32_t top) {
  const uint32_t *const bins = w->bins;
  uint32_t sum = 0, best = 0;
  double mode = 0.0;
  for (int32_t end = 0, start = 0; end <= top; ++end) {
    if (bins[end] == 0) continue; /* a best window can end on a word that occurs */
    const double end_px = end / (double)VISTA_DISPARITY_SCALE;
    const double width = 2.0 * VISTA_DISPARITY_SCALE * vista_region_tolerance_px(w->params, camera, end_px);
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
      const double residual = pass == 0 ? 0.0 : d - plane->offset - plane->slope_u * u - plane->slope_v * v;
      if (fabs(residual) > 2.0 * w->tolerance_px) continue;
      const double size = (double)w->foveation->size_px[node];
      vista_plane_fit_add(&fit, u, v, d, size * size);
      used++;
    }
    if (used < PLANE_MIN_CELLS || !vista_plane_fit_solve(&fit, plane)) return false;
    *range_px = sqrt(12.0) * vista_plane_fit_spread(&fit, plane);
  }
  return true;
}

/* Area of the cells whose disparity lies on a surface. */
static double area_on(const vista_region_view *w, const vista_plane *plane) {
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

#define FIXED_BITS 12 /* of a sixteenth of a pixel */

static int32_t to_fixed(double disparity_px) {
  const double limit = 1 << 28;
  return (int32_t)lround(fmin(fmax(disparity_px * VISTA_DISPARITY_SCALE * (1 << FIXED_BITS), -limit), limit));
}

/* Residuals in whole engine words: integers, so that the loop is vectorised. */
static inliers boundary_inliers(const vista_region_view *w, const vista_plane *plane) {
  int64_t count = 0, sum = 0, squares = 0;
  const int32_t slope = to_fixed(fmin(fmax(plane->slope_u, -8.0), 8.0));
  const int32_t tolerance = (int32_t)(w->tolerance_px * VISTA_DISPARITY_SCALE);
  for (int32_t m = 0; m < w->member_count; ++m) {
    const int32_t node = w->members[m];
    if (!w->boundary[node]) continue;
    for (int32_t r = w->foveation->first_run[node]; r < w->foveation->first_run[node + 1]; ++r) {
      const vista_run run = w->foveation->runs[r];
      const int16_t *const words = vista_region_words(w, run);
      const int32_t start = to_fixed(vista_plane_at(plane, run.u_px, run.v_px)) + (1 << (FIXED_BITS - 1));
      int32_t run_count = 0, run_sum = 0, run_squares = 0;
      for (int32_t i = 0; i < run.length_px; ++i) {
        const int32_t residual = words[i] - ((start + i * slope) >> FIXED_BITS);
        const int32_t in = vista_word_valid(words[i]) & (residual <= tolerance) & (residual >= -tolerance);
        run_count += in;
        run_sum += in * residual;
        run_squares += in * residual * residual;
      }
      count += run_count;
      sum += run_sum;
      squares += run_squares;
    }
  }
  const double unit = 1.0 / VISTA_DISPARITY_SCALE;
  return summarise(count, (double)sum * unit, (double)squares * unit * unit);
}

/* The boundary against the surface that explains it best; false: no valid pixel there. */
bool vista_region_measure_boundary(vista_region_view *w, const vista_camera *camera, const double up_camera[3],
                                   vista_region *region, vista_plane *surface) {
  const int32_t top = count_boundary(w, region);
  if (region->boundary_valid == 0) return false;
  const double mode = vista_region_mode_px(w, camera, top);
  w->tolerance_px = vista_region_tolerance_px(w->params, camera, mode);
  const inliers around_mode = inliers_around(w->bins, mode, w->tolerance_px);
  *surface = (vista_plane){.offset = mode + around_mode.mean_px}; /* mode, refined by the mean around it */
  inliers in = inliers_around(w->bins, surface->offset, w->tolerance_px);
  memset(w->bins, 0, ((size_t)top + 1) * sizeof *w->bins);

  const double u = (double)w->foveation->center_u[w->members[0]], v = (double)w->foveation->center_v[w->members[0]];
  vista_plane plane;
  double range_px;
  if (fit_plane(w, &plane, &range_px)) {
    if (range_px >= w->tolerance_px) /* a slope that the noise cannot make */
      region->inclination_deg = vista_plane_inclination_deg(camera, up_camera, u, v, vista_plane_at(&plane, u, v),
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
  region->disparity_px = vista_plane_at(surface, u, v); /* until the centre is known */
  return in.count > 0;
}
