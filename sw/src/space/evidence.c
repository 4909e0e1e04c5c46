#include "space/evidence.h"

#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#define LOW 0.035 /* 2 degrees below the horizon: lower, there is no sky */
#define FOOT_PX 5 /* least disparity of the ground at which something may be seen to stand */
#define THIN_PX 1 /* by which the engine's own word is nearer than what else is there */
#define AROUND_PX 2 /* of the coarser level: where its words have to agree, */
#define AGREE_PX 1 /* to this */
#define COLUMNS 320 /* of the picture, at least half as many: a place 45 m away is a disc of some 30 of them */

int32_t vista_evidence_step_px(const vista_camera *camera) {
  const int32_t longer_px = camera->width_px > camera->height_px ? camera->width_px : camera->height_px;
  return longer_px >= 2 * COLUMNS ? longer_px / COLUMNS : 1;
}

void vista_evidence_layout(vista_evidence *evidence, vista_arena *arena, const vista_camera *camera) {
  const int32_t step_px = vista_evidence_step_px(camera);
  evidence->step_px = step_px;
  evidence->width = (camera->width_px + step_px - 1) / step_px;
  evidence->height = (camera->height_px + step_px - 1) / step_px;
  const size_t count = (size_t)evidence->width * (size_t)evidence->height;
  evidence->word = vista_arena_take(arena, count, sizeof *evidence->word);
  evidence->kind = vista_arena_take(arena, count, sizeof *evidence->kind);
  evidence->nearest = vista_arena_take(arena, (size_t)camera->width_px, sizeof *evidence->nearest);
  evidence->low = vista_arena_take(arena, (size_t)evidence->width, sizeof *evidence->low);
}

/* The nearest word of each column of the image in the rows of one row of the picture. */
static void nearest_of_rows(const vista_disparity_image *words, int32_t first, int32_t rows,
                            int16_t *restrict nearest) {
  const int16_t *restrict row = words->data + (ptrdiff_t)first * words->stride;
  memcpy(nearest, row, (size_t)words->width_px * sizeof *nearest);
  for (int32_t k = 1; k < rows; ++k) {
    row += words->stride;
    for (int32_t u = 0; u < words->width_px; ++u) nearest[u] = row[u] > nearest[u] ? row[u] : nearest[u];
  }
}

static void add_thin(const vista_disparity_image *words, vista_evidence *evidence) {
  const int32_t step_px = evidence->step_px;
  for (int32_t y = 0; y < evidence->height; ++y) {
    const int32_t left_rows = words->height_px - y * step_px;
    nearest_of_rows(words, y * step_px, left_rows < step_px ? left_rows : step_px, evidence->nearest);
    int16_t *const word = evidence->word + (ptrdiff_t)y * evidence->width;
    uint8_t *const kind = evidence->kind + (ptrdiff_t)y * evidence->width;
    for (int32_t x = 0; x < evidence->width; ++x) {
      const int32_t left_columns = words->width_px - x * step_px,
                    columns = left_columns < step_px ? left_columns : step_px;
      int16_t own = 0;
      for (int32_t k = 0; k < columns; ++k)
        own = evidence->nearest[x * step_px + k] > own ? evidence->nearest[x * step_px + k] : own;
      if (kind[x] == VISTA_SIGHT_OUTSIDE || own <= word[x] + THIN_PX * VISTA_DISPARITY_SCALE) continue;
      word[x] = own;
      kind[x] = VISTA_SIGHT_WORD;
    }
  }
}

/* The word of the next coarser level, in units of level 0, if three of the pixels around agree; else 0. It bounds what is
 * not matched at full size, such as ground whose fine texture drowns in noise; chance matches stand alone. */
static int32_t coarser_word(const vista_disparity_image *coarser, int32_t u_px, int32_t v_px) {
  if (coarser->data == NULL || u_px < AROUND_PX || v_px < AROUND_PX || u_px >= coarser->width_px - AROUND_PX ||
      v_px >= coarser->height_px - AROUND_PX)
    return 0;
  const int16_t *const at = coarser->data + (ptrdiff_t)v_px * coarser->stride + u_px;
  const int32_t word = *at;
  if (word <= 0 || word > INT16_MAX / 2) return 0;
  const ptrdiff_t across = AROUND_PX, down = AROUND_PX * coarser->stride;
  const int32_t around[] = {at[-across], at[across], at[-down], at[down]};
  int agree = 0;
  for (int k = 0; k < 4; ++k) agree += around[k] > 0 && abs(around[k] - word) <= AGREE_PX * VISTA_DISPARITY_SCALE;
  return agree >= 3 ? 2 * word : 0;
}

void vista_evidence_take(const vista_frame_view *frame, const vista_surfaces *surfaces, vista_evidence *evidence) {
  const vista_disparity_image *const words = &frame->words;
  const int32_t *const cell_of_pixel = frame->foveation->cell_of_pixel;
  const int32_t width = evidence->width, height = evidence->height, step_px = evidence->step_px;
  const vista_camera *const camera = frame->camera;
  const double *const up = frame->up_camera;
  const double column_height = up[0] / camera->focal_px;
  evidence->pose = frame->motion.pose;
  evidence->t_ns = frame->t_ns;
  const vista_margins margins = vista_matched_margins(&frame->matched, 0.0);
  const double left_px = margins.left_px, right_px = camera->width_px - 1 - margins.other_px;
  /* Rows are taken from the bottom up: the one below holds the word that bounds each column so far. */
  for (int32_t y = height - 1; y >= 0; --y) {
    const int16_t *const row = words->data + (ptrdiff_t)y * step_px * words->stride;
    const int32_t *const cells = cell_of_pixel + (ptrdiff_t)y * step_px * words->width_px;
    int16_t *const word = evidence->word + (ptrdiff_t)y * width;
    uint8_t *const kind = evidence->kind + (ptrdiff_t)y * width;
    const bool outside = y * step_px < margins.other_px || y * step_px > camera->height_px - 1 - margins.other_px;
    /* Height of the line of sight at depth 1, against gravity: positive above the horizon. */
    const double row_height = up[1] * (y * step_px - camera->center_v_px) / camera->focal_px + up[2];
    for (int32_t x = 0; x < width; ++x) {
      if (x * step_px < left_px || x * step_px > right_px || outside) {
        word[x] = 0;
        kind[x] = VISTA_SIGHT_OUTSIDE;
        continue;
      }
      const int16_t matched = row[x * step_px];
      const int16_t below = y + 1 < height ? word[x + width] : 0;
      /* What lies higher in the image and is nearer than what bounds it hangs, or is wrong. */
      const int32_t coarser =
          matched > 0 ? 0 : coarser_word(&frame->levels[1], (x * step_px + 1) / 2, (y * step_px + 1) / 2);
      const bool bounds = coarser > 0 && (below <= 0 || coarser <= below + AGREE_PX * VISTA_DISPARITY_SCALE);
      word[x] = matched > 0 ? matched : bounds ? (int16_t)coarser : below;
      const double height_of_ray = row_height + column_height * (x * step_px - camera->center_u_px);
      if (matched > 0 || bounds) evidence->low[x] = height_of_ray < -LOW && word[x] < FOOT_PX * VISTA_DISPARITY_SCALE;
      if (matched > 0)
        kind[x] = surfaces->horizontal[cells[x * step_px]] ? VISTA_SIGHT_LEVEL : VISTA_SIGHT_WORD;
      else if (word[x] <= 0)
        kind[x] = VISTA_SIGHT_UNBOUNDED;
      else
        kind[x] = VISTA_SIGHT_BOUNDED;
      if (kind[x] == VISTA_SIGHT_BOUNDED && evidence->low[x] && height_of_ray > 0.0)
        for (int32_t k = 0; y + k < height && kind[x + (ptrdiff_t)k * width] == VISTA_SIGHT_BOUNDED; ++k)
          kind[x + (ptrdiff_t)k * width] = VISTA_SIGHT_HANGING;
    }
  }
  add_thin(&frame->levels[0], evidence);
}
