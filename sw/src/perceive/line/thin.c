#include "perceive/line/thin.h"

#include <stddef.h>

#include "common/frame.h"
#include "common/parameters_check.h"
#include "perceive/line/line_depth.h"
#include "perceive/line/straight_lines.h"

struct vista_thin {
  int32_t width_px, height_px;
  vista_straight_lines image;
  vista_line_sample *samples; /* scratch: a row */
  vista_thin_line *items;
  int32_t count;
};

vista_status vista_thin_layout(vista_thin **thin, vista_arena *arena, int32_t width_px, int32_t height_px) {
  if (thin == NULL || arena == NULL) return VISTA_ERROR_ARGUMENT;
  *thin = NULL;
  if (width_px < 1 || height_px < 1 || width_px > INT16_MAX || height_px > INT16_MAX) return VISTA_ERROR_SIZE;
  vista_thin *const made = vista_arena_take(arena, 1, sizeof *made);
  vista_thin parts = {.width_px = width_px, .height_px = height_px};
  vista_straight_lines_layout(&parts.image, arena, width_px, height_px);
  parts.samples = vista_arena_take(arena, (size_t)height_px, sizeof(vista_line_sample));
  parts.items = vista_arena_take(arena, VISTA_STRAIGHT_LINES_MAX, sizeof(vista_thin_line));
  if (arena->base == NULL) return VISTA_OK;
  if (arena->used > arena->size) return VISTA_ERROR_MEMORY;
  *made = parts;
  *thin = made;
  return VISTA_OK;
}

vista_status vista_thin_search(const vista_thin_params *params, const vista_camera *camera, const vista_thin_view *view,
                               vista_thin *thin) {
  if (params == NULL || camera == NULL || view == NULL || thin == NULL || view->image == NULL || view->words == NULL)
    return VISTA_ERROR_ARGUMENT;
  vista_status status = VISTA_CHECK_SECTION(thin, params);
  if (status == VISTA_OK) status = vista_frame_check_camera(camera);
  if (status == VISTA_OK) status = vista_frame_check_image(view->image, thin->width_px, thin->height_px);
  if (status == VISTA_OK) status = vista_frame_check_disparity(view->words, thin->width_px, thin->height_px);
  if (status != VISTA_OK) return status;
  thin->count = 0;
  if (params->find == VISTA_THIN_FIND_OFF || thin->width_px <= 2 * VISTA_RIDGE_REACH) return VISTA_OK;
  vista_straight_lines_find(view->image, params, view->noise.sigma, &thin->image);
  for (int32_t i = 0; i < thin->image.count; ++i)
    if (vista_line_depth(params, camera, view, &thin->image.ridge, &thin->image.items[i], thin->samples,
                         &thin->items[thin->count]))
      ++thin->count;
  return VISTA_OK;
}

const vista_thin_line *vista_thin_lines(const vista_thin *thin, int32_t *count) {
  *count = thin->count;
  return thin->items;
}
