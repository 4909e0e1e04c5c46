#include "erosion.h"

#include <string.h>

static uint16_t smaller(uint16_t a, uint16_t b) { return a < b ? a : b; }

/* out[i] = min(out[i], in[i]); as unsigned numbers invalid words, which are negative, exceed all others. */
static void take_smaller(uint16_t *out, const uint16_t *in, int32_t count) {
  for (int32_t i = 0; i < count; ++i) out[i] = smaller(out[i], in[i]);
}

void vista_erode(const vista_disparity_image *disparity, int32_t radius_px, uint16_t *rows, uint16_t *eroded) {
  const int32_t width = disparity->width_px, height = disparity->height_px;
  for (int32_t v = 0; v < height; ++v) {
    const uint16_t *const words = (const uint16_t *)(disparity->data + v * disparity->stride);
    uint16_t *const out = rows + (size_t)v * (size_t)width;
    memcpy(out, words, (size_t)width * sizeof *out);
    for (int32_t shift = 1; shift <= radius_px && shift < width; ++shift) {
      take_smaller(out, words + shift, width - shift);
      take_smaller(out + shift, words, width - shift);
    }
  }
  for (int32_t v = 0; v < height; ++v) {
    const uint16_t *const words = (const uint16_t *)(disparity->data + v * disparity->stride);
    uint16_t *const out = eroded + (size_t)v * (size_t)width;
    const int32_t first = v < radius_px ? 0 : v - radius_px;
    const int32_t last = v + radius_px < height ? v + radius_px : height - 1;
    memcpy(out, rows + (size_t)first * (size_t)width, (size_t)width * sizeof *out);
    for (int32_t w = first + 1; w <= last; ++w) take_smaller(out, rows + (size_t)w * (size_t)width, width);
    for (int32_t u = 0; u < width; ++u) out[u] = words[u] > INT16_MAX ? words[u] : out[u];
  }
}
