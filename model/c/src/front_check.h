/* What every function of the front end asks of its images. */
#ifndef VISTA_ENGINE_FRONT_CHECK_H
#define VISTA_ENGINE_FRONT_CHECK_H

#include "vista/frontend.h"

/* Pointers and the size of the image to read. */
vista_engine_status vista_front_check_image(const vista_frontend_image *image, const uint8_t *out);

/* Strides, and that an image of this size to write does not overlap the one to read. */
vista_engine_status vista_front_check_memory(const vista_frontend_image *image, const uint8_t *out, int32_t out_width,
                                             int32_t out_height, ptrdiff_t out_stride);

#endif
