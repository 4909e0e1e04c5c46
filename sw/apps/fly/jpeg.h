/* Pictures of cameras that compress them (Motion JPEG), through libjpeg, where vista-fly was built with it. */
#ifndef VISTA_FLY_JPEG_H
#define VISTA_FLY_JPEG_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Bytes of memory in which a baseline picture of this width is decoded; 0: this program cannot read JPEG. */
size_t jpeg_scratch_bytes(int32_t width_px);

/* Decodes the luma of a picture of exactly this size. Columns from width_px / views on go to right, the others to left,
 * each in rows without gaps; right is not touched if views is 1. Takes no memory but the scratch. Returns whether the
 * picture is whole: of one that is cut off or damaged, what was written is of no use. */
bool jpeg_decode(const unsigned char *data, size_t bytes, int32_t width_px, int32_t height_px, int views, void *scratch,
                 size_t scratch_bytes, uint8_t *left, uint8_t *right);

#endif
