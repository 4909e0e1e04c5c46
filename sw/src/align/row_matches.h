/* Features of the left image that are found in the right one, with the distance of each from its row.
 *
 * Tiles of the left image with corners in them are looked for at a quarter of the size, by normalized correlation over all
 * disparities and over the rows that a turn can move them by; what fits in two places is left out. At half the size the
 * place is made exact by least squares of the grey levels (Lucas and Kanade), with its uncertainty. Internal to
 * libvista. */
#ifndef VISTA_SRC_ALIGNMENT_ROW_MATCHES_H
#define VISTA_SRC_ALIGNMENT_ROW_MATCHES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "common/arena.h"
#include "vista/status.h"
#include "vista/types.h"

#define VISTA_ROW_MATCHES_MOST 128 /* features that are looked for in a pair */

typedef struct vista_row_match {
  float u_px, v_px; /* in the right image */
  float row_error_px;  /* v right - v left */
  float sigma_px;      /* of row_error_px, from the texture and from how well it fits */
} vista_row_match;

/* A grey image of a lower level; pixel i covers pixels 2 i and 2 i + 1 of the level below. */
typedef struct vista_level {
  uint8_t *pixels; /* without gaps */
  int32_t width_px, height_px;
} vista_level;

void vista_level_layout(int32_t width_px, int32_t height_px, vista_arena *arena, vista_level *level);

/* Means of 2 x 2 pixels. */
void vista_level_halve(const uint8_t *pixels, ptrdiff_t stride, const vista_level *out);

/* Whether a tile shows corners: its gradients, root mean square, are more than `least` in both directions. */
bool vista_tile_has_corners(const vista_level *level, int32_t u0, int32_t v0, double least);

typedef struct vista_row_matches {
  int32_t reach_rows;       /* at a quarter of the size: up and down */
  int32_t reach_columns;    /* the same: largest disparity */
  vista_level half[2], quarter[2]; /* left, right */
  float *spread;            /* of the right tile at each pixel: sqrt(sum of (grey - mean)^2), or 0 */
  float *grey; /* right image at a quarter of the size */
  int32_t *row_sums;        /* scratch: 2 rows of sums */
  float *scores;            /* scratch: correlation at every place of a search */
  uint64_t digests[2];      /* of the last pair's images at a quarter of the size */
  uint32_t turn;            /* which tiles come first when there are too many */
  /* Results of the last pair: */
  bool frozen;              /* an image is as it was in the pair before: nothing was looked for */
  int32_t features, count;
  int32_t ambiguous; /* features that look alike in two places */
  vista_row_match matches[VISTA_ROW_MATCHES_MOST];
} vista_row_matches;

/* Images of at least 64 x 64 px. reach_px: how far apart rows may be. Nothing is kept of the images given later. */
void vista_row_matches_layout(int32_t width_px, int32_t height_px, double reach_px, vista_arena *arena,
                              vista_row_matches *matches);

/* Images of that size. noise_sigma: grey levels of a pixel. wide: in all rows within reach; otherwise, in less time, in
 * those up to 10 px away. */
void vista_row_matches_find(const vista_image *left, const vista_image *right, double noise_sigma, bool wide,
                            vista_row_matches *matches);

#endif
