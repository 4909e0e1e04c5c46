/* The plane of the ground below, internal to libvista.
 *
 * In the image of disparities a plane is affine (plane_fit.h). Triples of cells propose planes (RANSAC); those that
 * lean more than tilt_deg from the horizontal drop out before they are scored. Nothing is seen below the ground: a cell
 * on a plane speaks for it with its area, a cell beyond it speaks against it, so that neither a table nor a hedge nor a
 * chance slope through a street's two sides wins over the road. The best is refined by least squares over the cells
 * near it. */
#ifndef VISTA_SRC_GROUND_PLANE_H
#define VISTA_SRC_GROUND_PLANE_H

#include <stdbool.h>
#include <stdint.h>

#include "common/plane_fit.h"
#include "perceive/cells/cells.h"
#include "perceive/frame_view.h"

/* inclination_deg: of the surface under each cell, negative where unknown (surface.h). candidates: scratch,
 * foveation->max_nodes. The plane's u and v count from the principal point. The outcome depends on the cells alone: the
 * triples are drawn in the same order every time. False: no plane has enough area on it. */
bool vista_find_ground_plane(const vista_frame_view *frame, const vista_cells *cells, const float *inclination_deg,
                             int32_t *candidates, vista_plane *plane);

#endif
