#include "perceive/line/thin.h"

#include <math.h>
#include <stddef.h>

#include "perceive/line/flat_lines.h"
#include "perceive/line/line_depth.h"
#include "perceive/line/straight_lines.h"

#define CONTRAST_NOISE 3.0 /* the contrast that counts in full is at least this many sigmas of the image's noise */

struct vista_thin {
  int32_t width_px, height_px;
  vista_straight_lines image;
  vista_flat_lines flat;
  vista_line_sample *samples; /* scratch: the longer side of the image */
  vista_thin_line *items;
  int32_t count;
};

vista_status vista_thin_layout(vista_thin **thin, vista_arena *arena, int32_t width_px, int32_t height_px) {
  *thin = NULL;
  if (width_px < 1 || height_px < 1 || width_px > INT16_MAX || height_px > INT16_MAX) return VISTA_ERROR_SIZE;
  vista_thin *const made = vista_arena_take(arena, 1, sizeof *made);
  vista_thin parts = {.width_px = width_px, .height_px = height_px};
  vista_straight_lines_layout(&parts.image, arena, width_px, height_px);
  vista_flat_lines_layout(&parts.flat, arena, width_px, height_px);
  parts.samples =
      vista_arena_take(arena, (size_t)(width_px > height_px ? width_px : height_px), sizeof(vista_line_sample));
  parts.items = vista_arena_take(arena, VISTA_STRAIGHT_LINES_MAX, sizeof(vista_thin_line));
  if (arena->base == NULL) return VISTA_OK;
  if (arena->used > arena->size) return VISTA_ERROR_MEMORY;
  *made = parts;
  *thin = made;
  return VISTA_OK;
}

/* Adds those lines of the image along which the words tell of a thin thing. */
static void add_things(const vista_frame_view *frame, const vista_surfaces *surfaces, const vista_straight_lines *lines,
                       vista_thin *thin) {
  const vista_line_view view = {frame, surfaces, &lines->ridge, thin->samples};
  for (int32_t i = 0; i < lines->count && thin->count < VISTA_THIN_MAX; ++i)
    thin->count += vista_line_depth(&view, &lines->items[i], &thin->items[thin->count]);
}

void vista_thin_search(const vista_frame_view *frame, const vista_surfaces *surfaces, vista_thin *thin) {
  const vista_thin_params *const params = &frame->params->thin;
  thin->count = 0;
  if (params->find == VISTA_THIN_FIND_OFF || thin->width_px <= 2 * VISTA_RIDGE_REACH) return;
  const double contrast = fmax(params->contrast, CONTRAST_NOISE * frame->noise.sigma);
  vista_straight_lines_find(&frame->image, contrast, &thin->image);
  add_things(frame, surfaces, &thin->image, thin);
  vista_flat_lines_find(frame, contrast, &thin->flat);
  add_things(frame, surfaces, &thin->flat.lines, thin);
}

vista_thin_lines vista_thin_found(const vista_thin *thin) { return (vista_thin_lines){thin->items, thin->count}; }
