#include "perceive/cells/surface.h"

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "common/depth.h"
#include "common/plane_fit.h"
#include "perceive/scales.h"

#define GROUND_STEP_M 0.35 /* cells above the plane by this, too, stand; at most 6 % of the range */

vista_status vista_surfaces_layout(vista_surfaces *surfaces, vista_arena *arena, const vista_foveation *foveation) {
  surfaces->inclination_deg = vista_arena_take(arena, (size_t)foveation->max_nodes, sizeof(float));
  surfaces->horizontal = vista_arena_take(arena, (size_t)foveation->max_nodes, sizeof(uint8_t));
  surfaces->candidates = vista_arena_take(arena, (size_t)foveation->max_nodes, sizeof(int32_t));
  return vista_inclination_layout(foveation, arena, &surfaces->inclination);
}

double vista_plane_inclination_deg(const vista_camera *camera, const double up_camera[3], double u_px, double v_px,
                                   double disparity_px, double slope_u, double slope_v) {
  const double at_center =
      disparity_px - slope_u * (u_px - camera->center_u_px) - slope_v * (v_px - camera->center_v_px);
  const double n[3] = {slope_u, slope_v, at_center / camera->focal_px};
  const double norm = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
  if (!(norm > 0.0)) return NAN;
  const double along = fabs(n[0] * up_camera[0] + n[1] * up_camera[1] + n[2] * up_camera[2]) / norm;
  return asin(fmin(along, 1.0)) * VISTA_DEGREES_PER_RADIAN;
}

/* Cells on the ground's plane are ground whatever their own inclination, which noise and the edges of things upset;
 * what is well above it stands: the top of a thing may lean, but it is no surface to fly along. */
static void compare_with_ground(const vista_frame_view *frame, const vista_cells *cells, vista_surfaces *surfaces) {
  const vista_foveation *const f = frame->foveation;
  const vista_camera *const camera = frame->camera;
  const vista_plane *const plane = &surfaces->ground;
  for (int32_t i = 0; i < f->node_count; ++i) {
    const double d = (double)cells->disparity_px[i];
    if (d <= 0.0) continue;
    const double u = (double)f->center_u[i], v = (double)f->center_v[i];
    const double ground = vista_plane_disparity_px(plane, camera, u, v);
    if (d < ground - VISTA_GROUND_PX) continue;
    const double step_m = (double)vista_limit_m(camera, (float)d, (float)GROUND_STEP_M);
    const bool stands = d >= ground + VISTA_GROUND_PX && vista_plane_height_m(plane, camera, u, v, d) >= step_m;
    surfaces->horizontal[i] = !stands;
  }
}

void vista_surfaces_compute(const vista_frame_view *frame, const vista_cells *cells, vista_surfaces *surfaces) {
  surfaces->inclination_deg[0] = -1.0f;
  vista_inclination_measure(surfaces->inclination, frame, cells, surfaces->inclination_deg);
  for (int32_t i = 0; i < frame->foveation->node_count; ++i)
    surfaces->horizontal[i] = surfaces->inclination_deg[i] >= (float)VISTA_HORIZONTAL_DEG;
  surfaces->ground = (vista_plane){0};
  surfaces->ground_found =
      vista_find_ground_plane(frame, cells, surfaces->inclination_deg, surfaces->candidates, &surfaces->ground);
  if (surfaces->ground_found) compare_with_ground(frame, cells, surfaces);
}
