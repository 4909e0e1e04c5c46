#include "perceive/line/past_views.h"

#include <stddef.h>

#include "common/numbers.h"
#include "common/wide_vectors.h"

void vista_past_views_layout(vista_past_views *views, vista_arena *arena, int32_t width_px, int32_t height_px) {
  *views = (vista_past_views){.width_px = width_px, .height_px = height_px};
  for (int k = 0; k < VISTA_PAST_VIEWS; ++k)
    for (int flat = 0; flat < 2; ++flat)
      views->items[k].ridge[flat] = vista_arena_take(arena, (size_t)width_px * (size_t)height_px, 1);
}

void vista_past_views_begin(vista_past_views *views, const vista_frame_view *frame) {
  if (!frame->motion.known || frame->motion.restarted) views->count = views->next = 0;
}

static bool is_far_enough(const vista_past_views *views, const vista_frame_view *frame) {
  if (views->count == 0) return true;
  const vista_past_view *const newest = &views->items[(views->next + VISTA_PAST_VIEWS - 1) % VISTA_PAST_VIEWS];
  return vista_distance(newest->pose.translation_m, frame->motion.pose.translation_m) >= VISTA_PAST_VIEW_STEP_M;
}

VISTA_WIDE_VECTORS static void take_row(const uint8_t *restrict before, const uint8_t *restrict here,
                                        const uint8_t *restrict after, int32_t count, int8_t *restrict ridge) {
  for (int32_t u = 0; u < count; ++u) ridge[u] = vista_past_view_ridge(before[u], here[u], after[u]);
}

void vista_past_views_keep(vista_past_views *views, const vista_frame_view *frame) {
  if (!frame->motion.known || !frame->seen || !is_far_enough(views, frame)) return;
  vista_past_view *const view = &views->items[views->next];
  const int32_t reach = VISTA_RIDGE_REACH, width = views->width_px, inner = width - 2 * reach;
  for (int32_t v = reach; v < views->height_px - reach; ++v) {
    const uint8_t *const row = frame->image.data + v * frame->image.stride + reach;
    const ptrdiff_t at = (ptrdiff_t)v * width + reach;
    take_row(row - reach, row, row + reach, inner, view->ridge[0] + at);
    take_row(row - reach * frame->image.stride, row, row + reach * frame->image.stride, inner, view->ridge[1] + at);
  }
  view->pose = frame->motion.pose;
  views->next = (views->next + 1) % VISTA_PAST_VIEWS;
  views->count += views->count < VISTA_PAST_VIEWS;
}
