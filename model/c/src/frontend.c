/* Smoothing and pyramid, row by row: borders, sizes and strides here, the loops along x in front_steps.h. */
#include "front_check.h"
#include "mirror.h"
#include "rows.h"

int32_t vista_frontend_reduced_px(int32_t side_px) { return (side_px + 1) / 2; }

static int in_range(int32_t side_px) { return side_px >= 1 && side_px <= VISTA_ENGINE_MAX_SIDE_PX; }

/* Bytes from the first pixel of an image to behind its last. */
static uintptr_t extent(int32_t width, int32_t height, ptrdiff_t stride) {
  return (uintptr_t)(height - 1) * (uintptr_t)stride + (uintptr_t)width;
}

vista_engine_status vista_front_check_memory(const vista_frontend_image *image, const uint8_t *out, int32_t out_width,
                                             int32_t out_height, ptrdiff_t out_stride) {
  if (image->stride < image->width || out_stride < out_width) return VISTA_ENGINE_ERROR_STRIDE;
  const uintptr_t from = (uintptr_t)image->pixels, to = (uintptr_t)out;
  if (from < to + extent(out_width, out_height, out_stride) &&
      to < from + extent(image->width, image->height, image->stride))
    return VISTA_ENGINE_ERROR_OVERLAP;
  return VISTA_ENGINE_OK;
}

vista_engine_status vista_front_check_image(const vista_frontend_image *image, const uint8_t *out) {
  if (!image || !image->pixels || !out) return VISTA_ENGINE_ERROR_ARGUMENT;
  return in_range(image->width) && in_range(image->height) ? VISTA_ENGINE_OK : VISTA_ENGINE_ERROR_SIZE;
}

static vista_engine_status check(const vista_frontend_image *image, const uint8_t *out, int32_t out_width,
                                 int32_t out_height, ptrdiff_t out_stride, vista_engine_isa isa) {
  if (!vista_engine_isa_available(isa)) return VISTA_ENGINE_ERROR_ISA;
  return vista_front_check_memory(image, out, out_width, out_height, out_stride);
}

/* The row that stands for row y, inside the image or not. */
static const uint8_t *row_at(const vista_frontend_image *image, int32_t y) {
  return image->pixels + vista_mirror(y, image->height) * image->stride;
}

vista_engine_status vista_frontend_smooth(const vista_frontend_image *image, uint8_t *out, ptrdiff_t out_stride,
                                          vista_engine_isa isa) {
  vista_engine_status status = vista_front_check_image(image, out);
  if (status == VISTA_ENGINE_OK) status = check(image, out, image->width, image->height, out_stride, isa);
  if (status != VISTA_ENGINE_OK) return status;
  const vista_row_code *code = vista_row_code_of(isa);
  for (int32_t y = 0; y < image->height; ++y) {
    const uint8_t *const rows[3] = {row_at(image, y - 1), row_at(image, y), row_at(image, y + 1)};
    code->smooth(rows, image->width, out + y * out_stride);
  }
  return VISTA_ENGINE_OK;
}

vista_engine_status vista_frontend_reduce(const vista_frontend_image *image, uint8_t *out, ptrdiff_t out_stride,
                                          vista_engine_isa isa) {
  vista_engine_status status = vista_front_check_image(image, out);
  if (status != VISTA_ENGINE_OK) return status;
  const int32_t width = vista_frontend_reduced_px(image->width), height = vista_frontend_reduced_px(image->height);
  status = check(image, out, width, height, out_stride, isa);
  if (status != VISTA_ENGINE_OK) return status;
  const vista_row_code *code = vista_row_code_of(isa);
  for (int32_t y = 0; y < height; ++y) {
    const uint8_t *rows[5];
    for (int32_t i = 0; i < 5; ++i) rows[i] = row_at(image, 2 * y + i - 2);
    code->reduce(rows, image->width, out + y * out_stride);
  }
  return VISTA_ENGINE_OK;
}
