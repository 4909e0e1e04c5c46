/* Regions at the resolution of the image: cells are up to tens of pixels wide, what stands there is not made of them.
 *
 * A pixel of a cell at the border of its region joins that cell, of its own and those next to it, which minimises
 *     min(|I(p) - I(cell)| / sigma_I, limit) + mixed * [cell is at a border] + compactness * |p - centre|^2 / size^2
 * and takes its region: cells become superpixels where it matters (one assignment of Achanta's SLIC, with the grid
 * for its seeds). All other pixels, and those of cells of a pixel's size, have the region of their cell. */
#ifndef VISTA_DELINEATION_H
#define VISTA_DELINEATION_H

#include <stdint.h>

#include "vista/arena.h"
#include "vista/foveation.h"
#include "vista/parameters.h"
#include "vista/status.h"
#include "vista/types.h"

typedef struct vista_delineation {
  int32_t *label;  /* height * width: region of each pixel, VISTA_NO_LABEL where its cell has none */
  uint8_t *border; /* node_count, scratch: next to a cell of another region */
} vista_delineation;

vista_status vista_delineation_layout(vista_delineation *delineation, vista_arena *arena,
                                      const vista_foveation *foveation);

/* label: node_count, region of each cell. VISTA_ERROR_SIZE if the image differs from the geometry. */
vista_status vista_delineate(const vista_foveation *foveation, const vista_delineation_params *params,
                             const vista_image *image, const vista_cells *cells, const int32_t *label,
                             vista_delineation *delineation);

#endif
