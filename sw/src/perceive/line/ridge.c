#include "perceive/line/straight_lines.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#include "common/wide_vectors.h"

#define SCALE_BITS 8
#define MOST_LEVELS 63 /* of a step: what is more counts as much */
/* What leans more is wider along a row: beyond the one every other lean does, beyond the other every fourth. */
#define FINE_LEAN 14
#define COARSE_LEAN 36

void vista_ridge_layout(vista_ridge *ridge, vista_arena *arena, int32_t width_px, int32_t height_px) {
  const int32_t strips = height_px / VISTA_STRIP_ROWS, row = width_px + 2 * VISTA_RIDGE_PAD;
  const size_t width = (size_t)width_px;
  *ridge = (vista_ridge){.width_px = width_px,
                         .height_px = height_px,
                         .lean_max = VISTA_STRIP_LEAN,
                         .strips = strips,
                         .row = row,
                         .value = vista_arena_take(arena, (size_t)strips * VISTA_STRIP_ROWS * (size_t)row, 1),
                         .best = vista_arena_take(arena, width, 1),
                         .lean = vista_arena_take(arena, width, 1),
                         .last_lean = vista_arena_take(arena, width, 1),
                         .sum = vista_arena_take(arena, width, 1)};
}

static inline int16_t least(int16_t a, int16_t b) { return a > b ? b : a; }
static inline int16_t most(int16_t a, int16_t b) { return a < b ? b : a; }

VISTA_WIDE_VECTORS
static void find_row(const uint8_t *grey, int32_t count, int16_t scale, int8_t *value) {
  for (int32_t u = 0; u < count; ++u) {
    const int16_t ridge = vista_ridge_of(grey[u - VISTA_RIDGE_REACH], grey[u], grey[u + VISTA_RIDGE_REACH]);
    const int16_t step = most(least(ridge, MOST_LEVELS), -MOST_LEVELS); /* times the scale it fits */
    const int16_t scaled = (int16_t)((int16_t)(step * scale) / (1 << SCALE_BITS));
    value[u] = (int8_t)most(least(scaled, VISTA_RIDGE_FULL), -VISTA_RIDGE_FULL);
  }
}

void vista_ridge_find(const vista_image *image, double full_levels, vista_ridge *ridge) {
  const double most = fmin(full_levels, MOST_LEVELS);
  const double scale = fmin(VISTA_RIDGE_FULL * (1 << SCALE_BITS) / most, 32767.0 / (MOST_LEVELS + 1));
  const int32_t inner = ridge->width_px - 2 * VISTA_RIDGE_REACH;
  for (int32_t v = 0; v < ridge->strips * VISTA_STRIP_ROWS; ++v)
    find_row(image->data + v * image->stride + VISTA_RIDGE_REACH, inner, (int16_t)lround(scale),
             ridge->value + v * ridge->row + VISTA_RIDGE_PAD + VISTA_RIDGE_REACH);
}

/* The sixteen rows, each shifted to where the line meets it. Unsigned, so that compilers keep to bytes. */
VISTA_WIDE_VECTORS
static void add_rows(const uint8_t *restrict first, const int32_t shift[restrict VISTA_STRIP_ROWS], int32_t width,
                     uint8_t *restrict sum) {
  const int32_t a = shift[0], b = shift[1], c = shift[2], d = shift[3], e = shift[4], f = shift[5], g = shift[6],
                h = shift[7], i = shift[8], j = shift[9], k = shift[10], l = shift[11], m = shift[12], n = shift[13],
                o = shift[14], p = shift[15];
  for (int32_t u = 0; u < width; ++u) {
    const uint8_t *const at = first + u;
    const uint8_t upper = (uint8_t)(at[a] + at[b] + at[c] + at[d] + at[e] + at[f] + at[g] + at[h]);
    const uint8_t lower = (uint8_t)(at[i] + at[j] + at[k] + at[l] + at[m] + at[n] + at[o] + at[p]);
    sum[u] = (uint8_t)(upper + lower);
  }
}

/* The first and the last lean with the largest sum; by masks, because compilers turn three choices into branches. */
VISTA_WIDE_VECTORS
static void keep_best(const int8_t *restrict sum, int32_t width, int8_t lean, uint8_t *restrict best,
                      int8_t *restrict first, int8_t *restrict last) {
  for (int32_t u = 0; u < width; ++u) {
    const uint8_t size = (uint8_t)(sum[u] < 0 ? -sum[u] : sum[u]);
    const int8_t more = (int8_t)-(size > best[u]), less = (int8_t)-(size < best[u]);
    first[u] = (int8_t)((lean & more) | (first[u] & ~more));
    last[u] = (int8_t)((lean & ~less) | (last[u] & less));
    best[u] = size > best[u] ? size : best[u];
  }
}

static int step_from(int lean) {
  if (lean < -COARSE_LEAN || lean >= COARSE_LEAN) return 4;
  return lean < -FINE_LEAN || lean >= FINE_LEAN ? 2 : 1;
}

void vista_ridge_sum(vista_ridge *ridge, int32_t strip) {
  memset(ridge->best, 0, (size_t)ridge->width_px);
  memset(ridge->lean, 0, (size_t)ridge->width_px);
  const int8_t *const first = ridge->value + strip * VISTA_STRIP_ROWS * ridge->row + VISTA_RIDGE_PAD;
  for (int lean = -ridge->lean_max; lean <= ridge->lean_max; lean += step_from(lean)) {
    int32_t shift[VISTA_STRIP_ROWS];
    for (int r = 0; r < VISTA_STRIP_ROWS; ++r) /* rounded, from the middle of the strip */
      shift[r] = r * ridge->row + (int32_t)floor(lean * (r - 0.5 * (VISTA_STRIP_ROWS - 1)) / VISTA_STRIP_ROWS + 0.5);
    add_rows((const uint8_t *)first, shift, ridge->width_px, (uint8_t *)ridge->sum);
    keep_best(ridge->sum, ridge->width_px, (int8_t)lean, ridge->best, ridge->lean, ridge->last_lean);
  }
  for (int32_t u = 0; u < ridge->width_px; ++u) ridge->lean[u] = (int8_t)((ridge->lean[u] + ridge->last_lean[u]) / 2);
}
