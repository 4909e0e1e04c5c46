/* How far a seed reaches: bridges between its parts, its shell (seeds.h). Internal to libvista. */
#ifndef VISTA_SRC_SEED_EXTENT_H
#define VISTA_SRC_SEED_EXTENT_H

#include "perceive/cells/cells.h"
#include "perceive/cells/surface.h"
#include "perceive/cut/seeds.h"
#include "perceive/frame_view.h"

/* Joins the sets of standing cells of about the same disparity, up to bridge_m apart, where a way between them leads
 * over cells without disparity: plain faces are matched only at their edges. Before the seeds are numbered. */
void vista_seeds_bridge(const vista_frame_view *frame, const vista_cells *cells, const vista_surfaces *surfaces,
                        vista_seeds *seeds);

/* seeds->shell: members within shell_px of an edge of depth and of an inner member. */
void vista_seeds_find_shell(const vista_frame_view *frame, const vista_cells *cells, vista_seeds *seeds);

#endif
