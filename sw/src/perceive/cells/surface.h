/* Inclination of the surface under each cell.
 *
 * On a plane the disparity is affine in the pixel, d = d_0 + g_u (u - c_u) + g_v (v - c_v), because
 * 1 / Z = n . (x, y, 1) for a plane n . P = 1; hence the normal in camera coordinates is n ~ (g_u, g_v, d_0 / f),
 * d_0 being the plane's disparity at the principal point. The gradient is fitted by least squares to the cells
 * around; with the up direction given, the lean from the vertical is asin(|n . up| / |n|).
 *
 * Ground, roads and water are surfaces to fly along: their pixels are matched well and their boundary is consistent,
 * so neither a matching threshold nor edge consistency tells them from obstacles. Their inclination does.
 * The ground's plane is the best of many candidate planes (ground_plane.c); it may be absent. Where it is known,
 * height above it overrides a cell's own inclination: on the plane is ground, well above it stands. */
#ifndef VISTA_SURFACE_H
#define VISTA_SURFACE_H

#include <stdbool.h>
#include <stdint.h>

#include "common/arena.h"
#include "common/plane_fit.h"
#include "perceive/cells/cells.h"
#include "perceive/cells/foveation.h"
#include "perceive/frame_view.h"
#include "vista/status.h"
#include "vista/types.h"

/* A surface that leans more than this from the vertical is one to fly along, not into. */
#define VISTA_HORIZONTAL_DEG 55.0

typedef struct vista_inclination vista_inclination;

typedef struct vista_surfaces {
  float *inclination_deg; /* node_count: 0 upright .. 90 horizontal; negative: unknown */
  uint8_t *horizontal; /* node_count: 1 on the ground, or what leans at least VISTA_HORIZONTAL_DEG */
  int32_t *candidates; /* scratch, node_count */
  vista_inclination *inclination; /* scratch */
  bool ground_found; /* there is a plane below that enough cells lie on: the ground, */
  vista_plane ground; /* its disparity, in pixels from the principal point */
} vista_surfaces;

vista_status vista_surfaces_layout(vista_surfaces *surfaces, vista_arena *arena, const vista_foveation *foveation);

void vista_surfaces_compute(const vista_frame_view *frame, const vista_cells *cells, vista_surfaces *surfaces);

/* Lean from the vertical, degrees, of the plane with disparity disparity_px and gradient (slope_u, slope_v) at a
 * pixel; NaN if the plane is degenerate. */
double vista_plane_inclination_deg(const vista_camera *camera, const double up_camera[3], double u_px, double v_px,
                                   double disparity_px, double slope_u, double slope_v);

/* ---- parts of it ---- */

vista_status vista_inclination_layout(const vista_foveation *foveation, vista_arena *arena,
                                      vista_inclination **inclination);

/* Measures how far each cell but the hub leans from the vertical, in degrees: the plane through it and the eight cells
 * that lie lever_px from it, or as few cells away as that takes. Negative: the cell has no disparity, or fewer than
 * five of those cells have one. inclination_deg: node_count. */
void vista_inclination_measure(vista_inclination *inclination, const vista_frame_view *frame, const vista_cells *cells,
                               float *inclination_deg);

/* inclination_deg: of the surface under each cell, negative where unknown (surface.h). candidates: scratch,
 * foveation->max_nodes. The plane's u and v count from the principal point. The outcome depends on the cells alone: the
 * triples are drawn in the same order every time. False: no plane has enough area on it. */
bool vista_find_ground_plane(const vista_frame_view *frame, const vista_cells *cells, const float *inclination_deg,
                             int32_t *candidates, vista_plane *plane);

#endif
