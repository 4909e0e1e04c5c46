#include "perceive/region/ground.h"

#include <math.h>
#include <stdint.h>

#include "common/plane_fit.h"

#define GROUND_MIN_CELLS 4.0

double vista_standing_fraction(const vista_region_view *view, double min_height_m) {
  const vista_foveation *const foveation = view->foveation;
  const vista_camera *const camera = view->frame->camera;
  const vista_cells *const cells = view->cells;
  const vista_surfaces *const surfaces = view->surfaces;
  const double *const up_camera = view->frame->up_camera;
  const double horizontal_deg = view->frame->params->surface.horizontal_deg;
  const int32_t *const members = view->members, member_count = view->member_count;
  const vista_graph *const graph = &foveation->graph;
  vista_plane_fit fit = {0};
  for (int32_t m = 0; m < member_count; ++m) {
    for (int32_t arc = graph->first_arc[members[m]]; arc < graph->first_arc[members[m] + 1]; ++arc) {
      const int32_t near = graph->head[arc];
      if (!surfaces->horizontal[near]) continue;
      for (int32_t next = graph->first_arc[near]; next < graph->first_arc[near + 1]; ++next) {
        const int32_t j = graph->head[next]; /* one cell further gives the fit its lever */
        if (!surfaces->horizontal[j]) continue;
        vista_plane_fit_add(&fit, (double)foveation->center_u[j] - camera->center_u_px,
                            (double)foveation->center_v[j] - camera->center_v_px, (double)cells->disparity_px[j], 1.0);
      }
    }
  }
  vista_plane plane = surfaces->ground;
  if (fit.weight < GROUND_MIN_CELLS || !vista_plane_fit_solve(&fit, &plane)) {
    if (!surfaces->ground_found) return 1.0;
  } else if (!(vista_plane_inclination_deg(camera, up_camera, camera->center_u_px, camera->center_v_px, plane.offset,
                                           plane.slope_u, plane.slope_v) > horizontal_deg)) {
    return 1.0; /* leaning cells here and there, but nothing to lie on */
  }
  double area = 0.0, standing = 0.0;
  for (int32_t m = 0; m < member_count; ++m) {
    const int32_t node = members[m];
    const double d = (double)cells->disparity_px[node];
    if (d <= 0.0) continue;
    const double size = (double)foveation->size_px[node];
    area += size * size;
    const double height_m =
        vista_plane_height_m(&plane, camera, (double)foveation->center_u[node], (double)foveation->center_v[node], d);
    if (fabs(height_m) >= min_height_m) standing += size * size;
  }
  return area > 0.0 ? standing / area : 1.0;
}
