#include "detector/levels.h"

#include <string.h>

#include "vista/frontend.h"

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
  const vista_engine_output output = {l->words[level], NULL, width, 0};
  vista_engine_status status = vista_engine_compute(&l->engine, &images, &output, l->scratch, l->scratch_bytes);
  for (int side = 0; side < 2 && level + 1 < l->count && status == VISTA_ENGINE_OK; ++side)
    status =
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

vista_disparity_image vista_levels_words(const vista_levels *l, int32_t level) {
  const int32_t width = l->width_px[level];
  return (vista_disparity_image){l->words[level], width, l->height_px[level], width};
}
