/* Straight thin lines of an image, from its ridges; internal to libvista.
 *
 * In each strip of 16 rows the columns whose ridge sum is a local maximum and large enough are pieces. Pieces of
 * following strips that lie on one straight line are linked, from the strongest on, over gaps of a strip; a line is
 * what has enough of them, keeps to a straight line, and shows a ridge in most of its rows. Foliage and texture are
 * full of pieces, but the next one is seldom where the line leads. */
#ifndef VISTA_STRAIGHT_LINES_H
#define VISTA_STRAIGHT_LINES_H

#include <stdbool.h>
#include <stdint.h>

#include "common/arena.h"
#include "perceive/line/thin_line.h"
#include "vista/types.h"

/* Pixels where an image is a thin line that is no nearer to horizontal than vista_ridge's sums look for.
 *
 * A pixel is on a ridge when it is brighter, or darker, than both pixels VISTA_RIDGE_REACH beside it along its row; the
 * smaller of the two steps counts. An edge has one side that does not differ, so it is none. In units of one seventh of
 * the contrast from which on more contrast is no more evidence, with sign. */
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

/* How much a pixel is on a ridge, by the ones to both sides, with sign, in grey levels. */
static inline int16_t vista_ridge_of(int16_t before, int16_t here, int16_t after) {
  const int16_t a = (int16_t)(here - before), b = (int16_t)(here - after);
  const int16_t low = a > b ? b : a, high = a > b ? a : b;
  return (int16_t)((low > 0 ? low : 0) + (high < 0 ? high : 0));
}

void vista_ridge_layout(vista_ridge *ridge, vista_arena *arena, int32_t width_px, int32_t height_px);

/* Fills `value`. full_levels: the contrast in grey levels that counts in full. */
void vista_ridge_find(const vista_image *image, double full_levels, vista_ridge *ridge);

/* Sums of the strip along straight lines through each column of its middle; fills best and lean. */
void vista_ridge_sum(vista_ridge *ridge, int32_t strip);

/* The value at a pixel. */
static inline int8_t vista_ridge_at(const vista_ridge *ridge, int32_t u, int32_t v) {
  return ridge->value[v * ridge->row + VISTA_RIDGE_PAD + u];
}

#define VISTA_PIECES_MAX 4096
#define VISTA_STRAIGHT_LINES_MAX VISTA_THIN_MAX

typedef struct vista_line_piece {
  int16_t u_px; /* in the middle of its strip */
  int8_t lean;  /* columns per strip */
  uint8_t sum;
  int16_t strip;
  bool taken;
} vista_line_piece;

typedef struct vista_straight_lines {
  vista_ridge ridge;
  vista_line_piece *pieces; /* by strip, then column */
  int32_t *first_piece;     /* strips + 1 */
  int32_t *first_of_column; /* strips * columns: the first piece in a column of some pixels of a strip, or after it */
  int32_t columns;
  int32_t *order;           /* scratch: pieces, strongest first; then those of the line that grows */
  vista_thin_line *items; /* as far as the image tells of them, where they are in the image of the camera */
  int32_t count;
} vista_straight_lines;

void vista_straight_lines_layout(vista_straight_lines *lines, vista_arena *arena, int32_t width_px, int32_t height_px);

/* The last coordinate along the line, backward (step -1) or onward (1) from one on it, before the image shows no ridge on
 * it for more than two strips. */
int32_t vista_straight_line_end(const vista_ridge *ridge, const vista_thin_line *line, int32_t from_px, int32_t step);

/* Looks for the lines in an image of the size that `lines` was laid out for. contrast: that counts in full. */
void vista_straight_lines_find(const vista_image *image, double contrast, vista_straight_lines *lines);

#endif
