/* What goes before the matching, to the bit: rectification, smoothing and pyramid of the contract.
 *
 * Each takes one 8-bit image and writes another, of any size from 1x1 on, without scratch or state. A pair is matched
 * at several levels by calls in turn: level 0 is rectified, level k+1 is vista_frontend_reduce of level k; each level,
 * smoothed by itself if wanted, goes to vista_engine_compute, and its words stay in 1/16 px of that level. */
#ifndef VISTA_FRONTEND_H
#define VISTA_FRONTEND_H

#include "vista/engine.h"

#define VISTA_FRONTEND_MAX_LEVELS 4
#define VISTA_FRONTEND_GRID_STEP_PX 16 /* from one control point to the next */
#define VISTA_FRONTEND_GRID_SCALE 32   /* of offsets: units a pixel */

VISTA_BEGIN

/* An 8-bit grey image; stride counts pixels from one row to the next. */
typedef struct vista_frontend_image {
  const uint8_t *pixels;
  int32_t width, height; /* px */
  ptrdiff_t stride;
} vista_frontend_image;

/* Side of the next level: (side_px + 1) / 2. */
VISTA_API int32_t vista_frontend_reduced_px(int32_t side_px);

/* Writes width x height pixels, [1 2 1] in both directions. The output must not overlap the image. */
VISTA_API vista_engine_status vista_frontend_smooth(const vista_frontend_image *image, uint8_t *out,
                                                    ptrdiff_t out_stride, vista_engine_isa isa);

/* Writes (width + 1) / 2 x (height + 1) / 2 pixels, [1 4 6 4 1] in both directions at every second row and column.
 * The output must not overlap the image. */
VISTA_API vista_engine_status vista_frontend_reduce(const vista_frontend_image *image, uint8_t *out,
                                                    ptrdiff_t out_stride, vista_engine_isa isa);

/* A control point of rectification: the pixel there is taken from so far to the right and below, in 1/32 px. */
typedef struct vista_frontend_offset {
  int16_t dx, dy;
} vista_frontend_offset;

/* Control points along a side: one every VISTA_FRONTEND_GRID_STEP_PX from 0 on, the last on or beyond the far edge. */
VISTA_API int32_t vista_frontend_grid_points(int32_t side_px);

/* Writes width x height pixels, each interpolated where the grid tells; sources beyond the image are moved to its edge.
 * The grid holds its points row by row without gaps. The output must not overlap the image. */
VISTA_API vista_engine_status vista_frontend_rectify(const vista_frontend_image *image,
                                                     const vista_frontend_offset *grid, uint8_t *out,
                                                     ptrdiff_t out_stride);

/* The first row of an image of this size with a control point that a line buffer of so many rows does not reach; -1
 * when it reaches all. Hardware built with that buffer refuses a grid that has such a row. */
VISTA_API int32_t vista_frontend_row_beyond(const vista_frontend_offset *grid, int32_t width, int32_t height,
                                            int32_t buffer_rows);

VISTA_END

#endif
