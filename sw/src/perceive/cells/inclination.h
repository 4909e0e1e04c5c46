/* The inclination of the surface under each cell, ring by ring. Internal to libvista. */
#ifndef VISTA_SRC_INCLINATION_H
#define VISTA_SRC_INCLINATION_H

#include <stdint.h>

#include "common/arena.h"
#include "perceive/cells/cells.h"
#include "perceive/cells/foveation.h"
#include "perceive/cells/surface.h"
#include "perceive/frame_view.h"
#include "vista/status.h"

vista_status vista_inclination_layout(const vista_foveation *foveation, vista_arena *arena,
                                      vista_inclination **inclination);

/* Measures how far each cell but the hub leans from the vertical, in degrees: the plane through it and the eight cells
 * that lie lever_px from it, or as few cells away as that takes. Negative: the cell has no disparity, or fewer than
 * five of those cells have one. inclination_deg: node_count. */
void vista_inclination_measure(vista_inclination *inclination, const vista_frame_view *frame, const vista_cells *cells,
                               float *inclination_deg);

#endif
