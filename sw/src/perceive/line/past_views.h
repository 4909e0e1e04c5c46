/* What the camera saw from places that it has left: the thin lines of its images, and poses; internal to libvista.
 *
 * A pixel holds how much it is on a line, as the ridge of straight_lines.h does, upright and flat, in grey levels.
 * Views are kept by way and not by time: what a line is looked for in is what the camera's motion shows of it.
 */
#ifndef VISTA_PAST_VIEWS_H
#define VISTA_PAST_VIEWS_H

#include <stdint.h>

#include "common/arena.h"
#include "perceive/frame_view.h"
#include "perceive/line/straight_lines.h"

#define VISTA_PAST_VIEWS 5
#define VISTA_PAST_VIEW_STEP_M 0.4 /* least way from one to the next */
#define VISTA_PAST_VIEW_FULL 7 /* grey levels of contrast: more is no more evidence */

/* The ridge at the middle one of three pixels. */
static inline int8_t vista_past_view_ridge(int16_t before, int16_t here, int16_t after) {
  const int16_t ridge = vista_ridge_of(before, here, after), full = VISTA_PAST_VIEW_FULL;
  const int16_t most = ridge > full ? full : ridge;
  return (int8_t)(most < -full ? -full : most);
}

typedef struct vista_past_view {
  int8_t *ridge[2]; /* height * width: upright, flat; 0 nearer to the rim than the ridge's sides */
  vista_pose pose;
} vista_past_view;

typedef struct vista_past_views {
  int32_t width_px, height_px;
  int32_t count, next;
  vista_past_view items[VISTA_PAST_VIEWS]; /* in no order */
} vista_past_views;

void vista_past_views_layout(vista_past_views *views, vista_arena *arena, int32_t width_px, int32_t height_px);

/* Forgets those that do not fit this frame: all of them where poses are not known or continue at another place. */
void vista_past_views_begin(vista_past_views *views, const vista_frame_view *frame);

/* Keeps what this frame shows, if it is far enough from the newest, in place of the oldest. */
void vista_past_views_keep(vista_past_views *views, const vista_frame_view *frame);

#endif
