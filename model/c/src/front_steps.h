/* Smoothing and pyramid along a row, compiled once for each instruction set by the compiler's vectoriser.
 * The including file defines VISTA_TARGET. A row is taken in chunks whose column sums fit on the stack. */
#ifndef VISTA_ENGINE_FRONT_STEPS_H
#define VISTA_ENGINE_FRONT_STEPS_H

#include "mirror.h"
#include "rows.h"

enum { FRONT_CHUNK = 1024 }; /* output pixels */

VISTA_TARGET static inline uint16_t smooth_column(const uint8_t *const rows[3], int32_t x) {
  return (uint16_t)(rows[0][x] + 2 * rows[1][x] + rows[2][x]);
}

VISTA_TARGET static void smooth_row(const uint8_t *const rows[3], int32_t width, uint8_t *restrict out) {
  const uint8_t *restrict above = rows[0], *restrict row = rows[1], *restrict below = rows[2];
  uint16_t columns[FRONT_CHUNK + 2]; /* of the chunk and of its neighbours, from column first - 1 on */
  for (int32_t first = 0; first < width; first += FRONT_CHUNK) {
    const int32_t count = width - first < FRONT_CHUNK ? width - first : FRONT_CHUNK;
    columns[0] = smooth_column(rows, vista_mirror(first - 1, width));
    for (int32_t i = 0; i < count; ++i)
      columns[i + 1] = (uint16_t)(above[first + i] + 2 * row[first + i] + below[first + i]);
    columns[count + 1] = smooth_column(rows, vista_mirror(first + count, width));
    for (int32_t i = 0; i < count; ++i)
      out[first + i] = (uint8_t)((uint16_t)(columns[i] + 2 * columns[i + 1] + columns[i + 2] + 8) >> 4);
  }
}

VISTA_TARGET static inline uint16_t reduce_column(const uint8_t *const rows[5], int32_t x) {
  return (uint16_t)(rows[0][x] + 4 * rows[1][x] + 6 * rows[2][x] + 4 * rows[3][x] + rows[4][x]);
}

VISTA_TARGET static void reduce_row(const uint8_t *const rows[5], int32_t width, uint8_t *restrict out) {
  const uint8_t *restrict r0 = rows[0], *restrict r1 = rows[1], *restrict r2 = rows[2], *restrict r3 = rows[3],
                          *restrict r4 = rows[4];
  const int32_t out_width = (width + 1) / 2, whole_pairs = width / 2;
  uint16_t even[FRONT_CHUNK + 2], odd[FRONT_CHUNK + 2]; /* columns 2x, 2x + 1 from x = first - 1 on */
  for (int32_t first = 0; first < out_width; first += FRONT_CHUNK) {
    const int32_t count = out_width - first < FRONT_CHUNK ? out_width - first : FRONT_CHUNK;
    const int32_t inside = whole_pairs - first < count ? whole_pairs - first : count;
    for (int32_t i = 0; i < inside; ++i) {
      const int32_t x = 2 * (first + i);
      even[i + 1] = (uint16_t)(r0[x] + r4[x] + 4 * (r1[x] + r3[x]) + 6 * r2[x]);
      odd[i + 1] = (uint16_t)(r0[x + 1] + r4[x + 1] + 4 * (r1[x + 1] + r3[x + 1]) + 6 * r2[x + 1]);
    }
    for (int32_t i = -1; i <= count; i = i < 0 ? inside : i + 1) { /* the pairs at both ends */
      even[i + 1] = reduce_column(rows, vista_mirror(2 * (first + i), width));
      odd[i + 1] = reduce_column(rows, vista_mirror(2 * (first + i) + 1, width));
    }
    for (int32_t i = 0; i < count; ++i)
      out[first + i] =
          (uint8_t)((uint16_t)(even[i] + even[i + 2] + 4 * (odd[i] + odd[i + 1]) + 6 * even[i + 1] + 128) >> 8);
  }
}

#endif
