#include "stages/surface.h"

#include <math.h>
#include <stdbool.h>

#include "common/depth.h"
#include "common/frame.h"
#include "common/parameters_check.h"
#include "common/plane_fit.h"
#include "stages/parts/ground_plane.h"

static const double degrees_per_radian = 57.29577951308232;

vista_status vista_surfaces_layout(vista_surfaces *surfaces, vista_arena *arena, const vista_foveation *foveation) {
  if (surfaces == NULL || arena == NULL || foveation == NULL) return VISTA_ERROR_ARGUMENT;
  surfaces->inclination_deg = vista_arena_take(arena, (size_t)foveation->max_nodes, sizeof(float));
  surfaces->horizontal = vista_arena_take(arena, (size_t)foveation->max_nodes, sizeof(uint8_t));
  surfaces->candidates = vista_arena_take(arena, (size_t)foveation->max_nodes, sizeof(int32_t));
  return arena->base != NULL && arena->used > arena->size ? VISTA_ERROR_MEMORY : VISTA_OK;
}

double vista_plane_inclination_deg(const vista_camera *camera, const double up_camera[3], double u_px, double v_px,
                                   double disparity_px, double slope_u, double slope_v) {
  const double at_center =
      disparity_px - slope_u * (u_px - camera->center_u_px) - slope_v * (v_px - camera->center_v_px);
  const double n[3] = {slope_u, slope_v, at_center / camera->focal_px};
  const double norm = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
  if (!(norm > 0.0)) return NAN;
  const double along = fabs(n[0] * up_camera[0] + n[1] * up_camera[1] + n[2] * up_camera[2]) / norm;
  return asin(fmin(along, 1.0)) * degrees_per_radian;
}

/* Grid neighbours `steps` cells apart in eight directions, and the cell itself. */
static int32_t neighbourhood(const vista_foveation *f, int32_t ring, int32_t sector, int32_t steps, int32_t out[9]) {
  const int32_t before = sector >= steps ? sector - steps : sector - steps + f->sector_count;
  const int32_t after = sector + steps < f->sector_count ? sector + steps : sector + steps - f->sector_count;
  const int32_t sectors[] = {before, sector, after};
  int32_t count = 0;
  for (int32_t r = ring - steps; r <= ring + steps; r += steps) {
    if (r < 0 || r >= f->ring_count) continue;
    for (int32_t k = 0; k < 3; ++k) {
      const int32_t node = f->node_of_grid[r * f->sector_count + sectors[k]];
      if (node >= 0) out[count++] = node;
    }
  }
  return count;
}

static float cell_inclination_deg(const vista_foveation *f, const vista_camera *camera, const double up_camera[3],
                                  const vista_cells *cells, int32_t node, const int32_t *around, int32_t count) {
  vista_plane_fit fit = {0};
  for (int32_t k = 0; k < count; ++k) {
    const int32_t j = around[k];
    if (cells->disparity_px[j] < 0.0f) continue;
    const float du = f->center_u[j] - f->center_u[node], dv = f->center_v[j] - f->center_v[node];
    const float dd = cells->disparity_px[j] - cells->disparity_px[node];
    vista_plane_fit_add(&fit, (double)du, (double)dv, (double)dd, 1.0);
  }
  vista_plane plane;
  if (fit.weight < 5.0 || !vista_plane_fit_solve(&fit, &plane)) return -1.0f;
  const double degrees =
      vista_plane_inclination_deg(camera, up_camera, f->center_u[node], f->center_v[node],
                                  plane.offset + cells->disparity_px[node], plane.slope_u, plane.slope_v);
  return isnan(degrees) ? -1.0f : (float)degrees;
}

static bool mostly_horizontal(const vista_surfaces *surfaces, double horizontal_deg, const int32_t *around,
                              int32_t count) {
  int32_t known = 0, leaning = 0;
  for (int32_t k = 0; k < count; ++k) {
    known += surfaces->inclination_deg[around[k]] >= 0.0f;
    leaning += surfaces->inclination_deg[around[k]] >= (float)horizontal_deg;
  }
  return 2 * leaning > known;
}

/* Cells on the ground's plane are ground whatever their own inclination, which noise and the edges of things upset;
 * what is well above it stands: the top of a thing may lean, but it is no surface to fly along. */
static void compare_with_ground(const vista_foveation *f, const vista_surface_params *params,
                                const vista_camera *camera, const vista_cells *cells, const vista_plane *plane,
                                vista_surfaces *surfaces) {
  for (int32_t i = 0; i < f->node_count; ++i) {
    const double d = (double)cells->disparity_px[i];
    if (d <= 0.0) continue;
    const double u = (double)f->center_u[i], v = (double)f->center_v[i];
    const double ground = vista_plane_disparity_px(plane, camera, u, v);
    if (d < ground - params->ground_step_px) continue;
    const double step_m = (double)vista_limit_m(camera, (float)d, (float)params->ground_step_m);
    const bool stands = d >= ground + params->ground_step_px && vista_plane_height_m(plane, camera, u, v, d) >= step_m;
    surfaces->horizontal[i] = !stands;
  }
}

vista_status vista_surfaces_compute(const vista_foveation *foveation, const vista_surface_params *params,
                                    const vista_camera *camera, const double up_camera[3], const vista_cells *cells,
                                    vista_surfaces *surfaces) {
  if (foveation == NULL || params == NULL || camera == NULL || up_camera == NULL || cells == NULL || surfaces == NULL)
    return VISTA_ERROR_ARGUMENT;
  vista_status status = VISTA_CHECK_SECTION(surface, params);
  if (status == VISTA_OK) status = vista_frame_check_camera(camera);
  if (status != VISTA_OK) return status;
  const vista_foveation *const f = foveation;
  surfaces->inclination_deg[0] = -1.0f;
  surfaces->horizontal[0] = 0;
  for (int pass = 0; pass < 2; ++pass) {
    for (int32_t ring = 0; ring < f->ring_count; ++ring) {
      for (int32_t sector = 0; sector < f->sector_count; ++sector) {
        const int32_t node = f->node_of_grid[ring * f->sector_count + sector];
        if (node < 0) continue;
        int32_t around[9];
        if (pass == 0) {
          surfaces->inclination_deg[node] = -1.0f;
          if (cells->disparity_px[node] < 0.0f) continue;
          const int32_t lever = (int32_t)ceil(params->lever_px / (double)f->size_px[node]);
          const int32_t steps = lever > f->sector_count / 8 ? f->sector_count / 8 : lever;
          const int32_t count = neighbourhood(f, ring, sector, steps, around);
          surfaces->inclination_deg[node] = cell_inclination_deg(f, camera, up_camera, cells, node, around, count);
        } else {
          surfaces->horizontal[node] = 0;
          if (surfaces->inclination_deg[node] < 0.0f) continue;
          const int32_t count = neighbourhood(f, ring, sector, 1, around);
          surfaces->horizontal[node] = mostly_horizontal(surfaces, params->horizontal_deg, around, count);
        }
      }
    }
  }
  vista_plane ground = {0};
  surfaces->ground_found = vista_find_ground_plane(f, params, camera, up_camera, cells, surfaces->inclination_deg,
                                                   surfaces->candidates, &ground);
  if (!surfaces->ground_found) return VISTA_OK;
  surfaces->ground_px = ground.offset;
  surfaces->ground_slope_u = ground.slope_u;
  surfaces->ground_slope_v = ground.slope_v;
  compare_with_ground(f, params, camera, cells, &ground, surfaces);
  return VISTA_OK;
}
