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
#include "perceive/line/ridge.h"
#include "perceive/line/thin_line.h"

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
