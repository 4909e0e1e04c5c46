/* Smallest valid disparity around every pixel, internal to libvista.
 *
 * A matched block that straddles an edge of depth takes the disparity of whichever side has more texture: things look
 * fatter by up to half a block. What is nearer than its surroundings is therefore worn down before cells average it. */
#ifndef VISTA_SRC_EROSION_H
#define VISTA_SRC_EROSION_H

#include <stdint.h>

#include "vista/types.h"

/* Writes to `eroded` (width * height, rows contiguous) the minimum over the valid words of a square of side
 * 2 radius_px + 1, cut off at the image's edges; invalid pixels stay invalid.
 * `rows`: scratch of the same size. */
void vista_erode(const vista_disparity_image *disparity, int32_t radius_px, uint16_t *rows, uint16_t *eroded);

#endif
