/* What each cell of the grid (foveation.h) shows of a frame: the mean of its grey levels and the median of its words. */
#ifndef VISTA_CELLS_H
#define VISTA_CELLS_H

#include <stdint.h>

#include "common/arena.h"
#include "common/median.h"
#include "common/team.h"
#include "perceive/cells/foveation.h"
#include "perceive/frame_view.h"
#include "vista/status.h"

/* One value a node. */
typedef struct vista_cells {
  float *intensity; /* grey level 0 .. 255, mean over the cell (bilinear sample for point cells) */
  float *disparity_px; /* median of the valid pixels; negative: too few of them */
  float *valid_fraction; /* of the cell's pixels that have a disparity, 0 .. 1 */
  vista_word_range *range; /* of the words of the cell's own pixels */
  int16_t *words; /* the engine words as foveation->first_pixel lists pixels, and VISTA_WORD_BLOCK more */
  uint8_t *greys; /* the grey levels, listed the same way */
  int16_t *of_cell[VISTA_MOST_WORKERS]; /* scratch: the words of one cell */
  vista_team *team; /* null: the calling thread alone */
} vista_cells;

vista_status vista_cells_layout(vista_cells *cells, vista_arena *arena, const vista_foveation *foveation);

/* Averages the image and the words of a frame over the receptive field of every cell. */
void vista_foveate(const vista_frame_view *frame, vista_cells *cells);

#endif
