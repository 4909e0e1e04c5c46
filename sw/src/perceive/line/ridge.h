/* Pixels where an image is a thin line that is no nearer to horizontal than vista_ridge's sums look for; internal to
 * libvista.
 *
 * A pixel is on a ridge when it is brighter, or darker, than both pixels VISTA_RIDGE_REACH beside it along its row; the
 * smaller of the two steps counts. An edge has one side that does not differ, so it is none. In units of one seventh of
 * the contrast from which on more contrast is no more evidence, with sign. */
#ifndef VISTA_RIDGE_H
#define VISTA_RIDGE_H

#include <stdbool.h>
#include <stdint.h>

#include "common/arena.h"
#include "vista/types.h"

#define VISTA_RIDGE_REACH 5 /* px to both sides: lines up to about 8 px wide along a row */
#define VISTA_RIDGE_FULL 7 /* of a pixel; 16 of them fit an int8_t */
#define VISTA_STRIP_ROWS 16 /* over which a line is summed up */
#define VISTA_STRIP_LEAN 56 /* columns that it passes at most on the way: 16 degrees from the horizontal */
#define VISTA_RIDGE_PAD 32 /* columns of zeros to both sides */

typedef struct vista_ridge {
  int32_t width_px, height_px;
  bool flat; /* of a turned image, whose rows are columns of the camera's: */
  int32_t across_px, along_px; /* where its first column and row lie in the image of the camera */
  int32_t lean_max; /* of the leans that are summed up */
  int32_t strips; /* whole ones; the rows below the last are not looked at */
  int32_t row; /* values from one row to the next */
  int8_t *value; /* strips * VISTA_STRIP_ROWS rows */
  uint8_t *best; /* width: of the strip that was summed up last, the largest sum over all leans, without its sign */
  int8_t *lean; /* width: of that sum, in columns to the right per VISTA_STRIP_ROWS rows downward; the middle of all
                 * leans with it: a line that is strong and wide adds up in full along several */
  int8_t *last_lean; /* scratch, width */
  int8_t *sum; /* scratch, width: along one lean */
} vista_ridge;

void vista_ridge_layout(vista_ridge *ridge, vista_arena *arena, int32_t width_px, int32_t height_px);

/* Fills `value`. full_levels: the contrast in grey levels that counts in full. */
void vista_ridge_find(const vista_image *image, double full_levels, vista_ridge *ridge);

/* Sums of the strip along straight lines through each column of its middle; fills best and lean. */
void vista_ridge_sum(vista_ridge *ridge, int32_t strip);

/* The value at a pixel. */
static inline int8_t vista_ridge_at(const vista_ridge *ridge, int32_t u, int32_t v) {
  return ridge->value[v * ridge->row + VISTA_RIDGE_PAD + u];
}

#endif
