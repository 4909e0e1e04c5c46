#include "detector/levels.h"

#include <string.h>

#include "vista/frontend.h"

#define CHECKED_ROWS 4
#define BEYOND_MOST \
  (VISTA_ENGINE_MAX_BLOCK_SIZE / 2 + 3) /* rows that a word depends on: of the block, and of filters */
#define ROW_STRIDE 89U /* a prime: rows are compared in an order that soon has been everywhere */

static vista_engine_params engine_of(const vista_stereo_params *stereo) {
  vista_engine_params engine = vista_engine_defaults();
  engine.num_disparities = stereo->num_disparities;
  engine.block_size = stereo->block_size;
  engine.prefilter =
      stereo->prefilter == VISTA_STEREO_PREFILTER_XSOBEL ? VISTA_ENGINE_PREFILTER_XSOBEL : VISTA_ENGINE_PREFILTER_NONE;
  engine.prefilter_cap = stereo->prefilter_cap;
  engine.texture_threshold = stereo->texture_threshold;
  engine.uniqueness_ratio = stereo->uniqueness_ratio;
  engine.lr_max_diff = stereo->lr_max_diff; /* from VISTA_ENGINE_LR_OFF on */
  return engine;
}

vista_status vista_levels_layout(vista_levels *l, vista_arena *arena, const vista_stereo_params *stereo,
                                 const vista_camera *camera) {
  l->engine = engine_of(stereo);
  l->count = stereo->levels;
  if (l->count < 1 || l->count > VISTA_LEVELS_MOST) return VISTA_ERROR_RANGE;
  l->scratch_bytes = vista_engine_scratch_bytes(&l->engine, camera->width_px, camera->height_px, 1);
  if (l->scratch_bytes == 0) return VISTA_ERROR_RANGE;
  l->scratch = vista_arena_take(arena, 1, l->scratch_bytes);
  l->band = vista_arena_take(arena, (size_t)camera->width_px * (CHECKED_ROWS + 2 * BEYOND_MOST), sizeof *l->band);
  int32_t width = camera->width_px, height = camera->height_px;
  for (int32_t level = 0; level < l->count; ++level) {
    const size_t pixels = (size_t)width * (size_t)height;
    l->width_px[level] = width;
    l->height_px[level] = height;
    for (int side = 0; side < 2; ++side) l->images[side][level] = vista_arena_take(arena, pixels, 1);
    for (int side = 0; side < 2 && level == 0 && stereo->smooth == VISTA_STEREO_SMOOTH_BINOMIAL3; ++side)
      l->smoothed[side] = vista_arena_take(arena, pixels, 1);
    l->words[level] = vista_arena_take(arena, pixels, sizeof(int16_t));
    width = vista_frontend_reduced_px(width);
    height = vista_frontend_reduced_px(height);
  }
  return VISTA_OK;
}

/* What is matched of one side and level: the image, or it smoothed. Null: the engine has no such image. */
static const uint8_t *matched(vista_levels *l, int side, const vista_frontend_image *image) {
  if (l->smoothed[side] == NULL) return image->pixels;
  return vista_frontend_smooth(image, l->smoothed[side], image->width, VISTA_ENGINE_ISA_AUTO) == VISTA_ENGINE_OK
             ? l->smoothed[side]
             : NULL;
}

static vista_engine_status match_level(vista_levels *l, int32_t level) {
  const int32_t width = l->width_px[level], height = l->height_px[level];
  const vista_frontend_image sides[2] = {{l->images[0][level], width, height, width},
                                         {l->images[1][level], width, height, width}};
  const vista_engine_images images = {matched(l, 0, &sides[0]), matched(l, 1, &sides[1]), width, height, width, width};
  const vista_engine_output output = {.disparity = l->words[level], .disparity_stride = width};
  vista_engine_status status = vista_engine_compute(&l->engine, &images, &output, l->scratch, l->scratch_bytes);
  for (int side = 0; side < 2 && level + 1 < l->count && status == VISTA_ENGINE_OK; ++side)
    status = /* NOLINTNEXTLINE(clang-analyzer-security.ArrayBound): count is at most the number of places */
        vista_frontend_reduce(&sides[side], l->images[side][level + 1], l->width_px[level + 1], VISTA_ENGINE_ISA_AUTO);
  return status;
}

vista_status vista_levels_match(vista_levels *l) {
  for (int32_t level = 0; level < l->count; ++level)
    if (match_level(l, level) != VISTA_ENGINE_OK) return VISTA_ERROR_ARGUMENT; /* what else it refuses was checked */
  return VISTA_OK;
}

vista_status vista_levels_take(vista_levels *l, const vista_disparity_image *words) {
  for (int32_t level = 0; level < l->count; ++level) {
    const vista_disparity_image *const given = &words[level];
    const int32_t width = l->width_px[level];
    if (given->data == NULL) return VISTA_ERROR_ARGUMENT;
    if (given->width_px != width || given->height_px != l->height_px[level] || given->stride < width)
      return VISTA_ERROR_SIZE;
    for (int32_t v = 0; v < given->height_px; ++v)
      memcpy(l->words[level] + (ptrdiff_t)v * width, given->data + v * given->stride, (size_t)width * sizeof(int16_t));
  }
  return VISTA_OK;
}

/* Compares the rows from `row` on of a level with the engine's. Returns how many differ; *count: of them all. */
static int64_t compare_rows(vista_levels *l, int32_t level, int32_t row, int64_t *count) {
  const int32_t width = l->width_px[level], beyond = l->engine.block_size / 2 + 2;
  /* An even row: the last row of an image is filtered by whether its height is odd. */
  const int32_t first = row > beyond ? (row - beyond) & ~1 : 0;
  const int32_t last = row + CHECKED_ROWS + beyond, end = last < l->height_px[level] ? last : l->height_px[level];
  const uint8_t *sides[2];
  for (int side = 0; side < 2; ++side) {
    const vista_frontend_image part = {l->images[side][level] + (ptrdiff_t)first * width, width, end - first, width};
    sides[side] = matched(l, side, &part);
  }
  if (sides[0] == NULL || sides[1] == NULL) return 0;
  const vista_engine_images images = {sides[0], sides[1], width, end - first, width, width};
  const vista_engine_output output = {.disparity = l->band, .disparity_stride = width};
  const int32_t from = row - first, to = from + CHECKED_ROWS;
  if (vista_engine_compute_rows(&l->engine, &images, &output, from, to, l->scratch, l->scratch_bytes) !=
      VISTA_ENGINE_OK)
    return 0;
  int64_t differ = 0;
  for (int32_t v = from; v < to; ++v)
    for (int32_t u = 0; u < width; ++u)
      differ += l->band[(ptrdiff_t)v * width + u] != l->words[level][(ptrdiff_t)(first + v) * width + u];
  *count += (int64_t)CHECKED_ROWS * width;
  return differ;
}

double vista_levels_differ(vista_levels *l) {
  int64_t differ = 0, count = 0;
  const uint32_t turn = l->turn++;
  for (int32_t level = 0; level < l->count; ++level) {
    /* Rows at the rim have no words. */
    const int32_t rim = l->engine.block_size / 2, width = l->width_px[level];
    const int32_t rows = l->height_px[level] - CHECKED_ROWS - 2 * rim;
    if (rows > 0) differ += compare_rows(l, level, rim + (int32_t)(turn * ROW_STRIDE % (uint32_t)rows), &count);
    for (int side = 0; side < 2 && level + 1 < l->count; ++side) {
      const vista_frontend_image image = {l->images[side][level], width, l->height_px[level], width};
      if (vista_frontend_reduce(&image, l->images[side][level + 1], l->width_px[level + 1], VISTA_ENGINE_ISA_AUTO) !=
          VISTA_ENGINE_OK)
        return 0.0;
    }
  }
  return count > 0 ? (double)differ / (double)count : 0.0;
}

vista_disparity_image vista_levels_words(const vista_levels *l, int32_t level) {
  const int32_t width = l->width_px[level];
  return (vista_disparity_image){l->words[level], width, l->height_px[level], width};
}
