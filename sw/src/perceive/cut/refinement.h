/* Regions at the resolution of the image: cells are up to tens of pixels wide, what stands there is not made of them.
 *
 * A pixel of a cell at the border of its region joins that cell, of its own and those next to it, which minimises
 *     min(|I(p) - I(cell)| / sigma_I, limit) + mixed * [cell is at a border] + compactness * |p - centre|^2 / size^2
 *     + min(max(d(cell) - d(p), 0) / sigma_d, limit_d)    where both have a disparity
 * and takes its region: cells become superpixels where it matters (one assignment of Achanta's SLIC, with the grid
 * for its seeds). Block matching makes things larger than they are, never smaller: a pixel that is farther than a cell
 * does not belong to it, while one that is nearer may well show the background. All other pixels, and those of cells
 * of a pixel's size, have the region of their cell. */
#ifndef VISTA_REFINEMENT_H
#define VISTA_REFINEMENT_H

#include <stdint.h>

#include "common/arena.h"
#include "common/team.h"
#include "perceive/cells/cells.h"
#include "perceive/cells/foveation.h"
#include "perceive/frame_view.h"
#include "vista/status.h"

typedef struct vista_refinement {
  int32_t *label;   /* height * width: region of each pixel, VISTA_NO_LABEL where its cell has none */
  uint8_t *border;  /* node_count: next to a cell of another region; elsewhere pixels have their cell's region */
  /* Region of each pixel of cells with a border, as foveation->first_pixel lists them; VISTA_WORD_BLOCK more. */
  int32_t *listed;
  vista_team *team; /* null: the calling thread alone */
} vista_refinement;

vista_status vista_refinement_layout(vista_refinement *refinement, vista_arena *arena,
                                     const vista_foveation *foveation);

/* Draws the regions. region_of_cell: node_count, negative: none. */
void vista_refine(const vista_frame_view *frame, const vista_cells *cells, const int32_t *region_of_cell,
                  vista_refinement *refinement);

#endif
