/* The rectified pair at each level of the pyramid, and the words of each. Internal to libvista. */
#ifndef VISTA_SRC_LEVELS_H
#define VISTA_SRC_LEVELS_H

#include <stdbool.h>

#include "common/arena.h"
#include "vista/engine.h"
#include "vista/parameters.h"
#include "vista/status.h"
#include "vista/types.h"

#define VISTA_LEVELS_MOST (1 + VISTA_COARSER_LEVELS)

/* Left and right; images and words lie row by row without gaps. */
typedef struct vista_levels {
  vista_engine_params engine;
  int32_t count;
  int32_t width_px[VISTA_LEVELS_MOST], height_px[VISTA_LEVELS_MOST];
  uint8_t *images[2][VISTA_LEVELS_MOST]; /* level 0 is the caller's to fill */
  uint8_t *smoothed[2];                  /* null: images are matched as they are */
  int16_t *words[VISTA_LEVELS_MOST];
  int16_t *band; /* scratch: CHECKED_ROWS of words */
  uint32_t turn; /* which rows are compared next */
  void *scratch;
  size_t scratch_bytes;
} vista_levels;

/* VISTA_ERROR_RANGE: parameters that the engine does not take. */
vista_status vista_levels_layout(vista_levels *levels, vista_arena *arena, const vista_stereo_params *stereo,
                                 const vista_camera *camera);

/* Matches all levels of the pair. */
vista_status vista_levels_match(vista_levels *levels);

/* Takes the words of all levels from elsewhere. */
vista_status vista_levels_take(vista_levels *levels, const vista_disparity_image *words);

/* The share of the words in a few rows of each level, other rows each time, that are not those of the engine in C. Level 0
 * of the pair has to be there; the coarser images are made. */
double vista_levels_differ(vista_levels *levels);

/* The words of a level. */
vista_disparity_image vista_levels_words(const vista_levels *levels, int32_t level);

#endif
