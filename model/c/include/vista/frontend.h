/* What goes before the matching, to the bit: smoothing and pyramid of model/README.md.
 *
 * Both take one 8-bit image and write another, of any size from 1x1 on, without scratch or state. A pair is matched at
 * several levels by calls in turn: level k+1 is vista_frontend_reduce of level k; each level, smoothed by itself if
 * wanted, goes to vista_engine_compute, and its words stay in 1/16 px of that level. */
#ifndef VISTA_FRONTEND_H
#define VISTA_FRONTEND_H

#include "vista/engine.h"

#define VISTA_FRONTEND_MAX_LEVELS 4

VISTA_BEGIN

/* An image to read; stride counts pixels from one row to the next. */
/* An 8-bit grey image. */
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

VISTA_END

#endif
