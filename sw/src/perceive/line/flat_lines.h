/* Thin lines that lie flat in the image, near where the flight path leads; internal to libvista.
 *
 * They are looked for from column to column: the image around the path is turned, and searched as straight_lines.h says.
 * What is steeper than 16 degrees is looked for from row to row. */
#ifndef VISTA_FLAT_LINES_H
#define VISTA_FLAT_LINES_H

#include <stdint.h>

#include "common/arena.h"
#include "perceive/frame_view.h"
#include "perceive/line/straight_lines.h"

typedef struct vista_flat_lines {
  uint8_t *turned; /* the part of the image that is searched: a row for each of its columns */
  vista_straight_lines lines;
} vista_flat_lines;

void vista_flat_lines_layout(vista_flat_lines *flat, vista_arena *arena, int32_t width_px, int32_t height_px);

/* Looks for the lines in the image of a frame, into flat->lines. contrast: that counts in full. */
void vista_flat_lines_find(const vista_frame_view *frame, double contrast, vista_flat_lines *flat);

#endif
