/* A matcher to set beside the engine's: the cost of a pixel is aggregated along the four paths that come from where a
 * camera's raster has been (from the left, upper left, above, upper right), in one pass with one row of memory. Its words
 * are in the engine's format, and follow steps 3 and 5 to 7 of the engine's contract on the aggregated costs. */
#ifndef VISTA_EVAL_FOUR_PATHS_H
#define VISTA_EVAL_FOUR_PATHS_H

#include <stddef.h>
#include <stdint.h>

enum { VISTA_PATHS_MAX_DISPARITIES = 64, VISTA_PATHS_INVALID = -16 };

typedef enum vista_paths_cost {
  VISTA_PATHS_CENSUS, /* bits that differ: which of 5x5 pixels are darker than the middle */
  VISTA_PATHS_SAD     /* of 3x3 pixels of the engine's horizontal Sobel response, clamped to 31; a quarter of it */
} vista_paths_cost;

typedef struct vista_paths_params {
  int32_t num_disparities; /* 32 or 64 */
  vista_paths_cost cost;
  int32_t near, far;        /* penalties of a change by 1 px and of any change: P1 and P2 */
  int32_t texture_threshold;
  int32_t uniqueness_ratio; /* percent, 0: off */
  int32_t lr_max_diff;      /* px, -1: off */
} vista_paths_params;

/* What is wrong with parameters or size, in words; NULL: nothing. */
const char *vista_paths_refused(const vista_paths_params *params, int32_t width, int32_t height);

/* Bytes that a match needs; 0: refused. */
size_t vista_paths_scratch_bytes(const vista_paths_params *params, int32_t width, int32_t height);

/* Matches two images without gaps between rows. Matched are pixels whose window and all of whose candidates lie within
 * both images; all others are invalid. scratch: aligned to 64 bytes, of the size above. Returns what is refused. */
const char *vista_paths_match(const vista_paths_params *params, const uint8_t *left, const uint8_t *right,
                              int32_t width, int32_t height, int16_t *words, uint8_t *scratch);

#endif
