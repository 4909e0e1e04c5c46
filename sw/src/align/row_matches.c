#include "align/row_matches.h"

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <string.h>

#include "align/place.h"
#include "common/numbers.h"
#include "common/wide_vectors.h"

#define TILE VISTA_TILE            /* side at a quarter of the size, px */
#define TILE_PIXELS (TILE * TILE)
#define NEAR_ROWS 2                /* up and down at a quarter of the size: 10 px of the image */
#define LANES 16                   /* columns of a search that are correlated at once */
#define DISPARITY_SHARE 5          /* disparities up to one in so many of the width */
#define GRADIENT_MIN 2.5           /* root mean square along the weaker axis, grey levels a pixel, of a corner */
#define GRADIENT_NOISE 0.45/* the same against the image's noise, which is a quarter at a quarter of the size */
#define CORRELATION_MIN 0.7f
#define AMBIGUOUS_SHARE 0.75f/* the best place lacks less than so much of what the second best lacks to 1 */
#define ROUNDING 0.003f            /* by which correlations that should be equal differ */
#define ALIKE 0.85f                /* a correlation by which texture that repeats itself differs from chance */
#define FLAT_SPREAD 4.0f /* of a tile that tells nothing, and would correlate by chance */
#define TURN_STEP 7919U /* a prime: tiles are visited in an order that differs from pair to pair */

void vista_level_layout(int32_t width_px, int32_t height_px, vista_arena *arena, vista_level *level) {
  *level = (vista_level){.width_px = width_px, .height_px = height_px};
  level->pixels = vista_arena_take(arena, (size_t)width_px * (size_t)height_px, 1);
}

static int32_t columns_of(const vista_row_matches *m) { return m->reach_columns + 1; }

void vista_row_matches_layout(int32_t width_px, int32_t height_px, double reach_px, vista_arena *arena,
                              vista_row_matches *m) {
  *m = (vista_row_matches){.reach_rows = (int32_t)ceil(reach_px / 4.0) + 1,
                           .reach_columns = width_px / DISPARITY_SHARE / 4};
  for (int side = 0; side < 2; ++side) {
    vista_level_layout(width_px / 2, height_px / 2, arena, &m->half[side]);
    vista_level_layout(width_px / 4, height_px / 4, arena, &m->quarter[side]);
  }
  const size_t width = (size_t)width_px / 4, height = (size_t)height_px / 4;
  m->spread = vista_arena_take(arena, width * height, sizeof *m->spread);
  m->grey = vista_arena_take(arena, width * height + LANES, sizeof *m->grey); /* a search reads whole lanes */
  m->row_sums = vista_arena_take(arena, 2 * width, sizeof *m->row_sums);
  const size_t places = (size_t)(2 * m->reach_rows + 1) * (size_t)columns_of(m);
  m->scores = vista_arena_take(arena, places, sizeof *m->scores);
}

/* Means of 2 x 2 pixels. */
VISTA_WIDE_VECTORS static void halve(const uint8_t *pixels, ptrdiff_t stride, const vista_level *out) {
  for (int32_t v = 0; v < out->height_px; ++v) {
    const uint8_t *const a = pixels + 2 * v * stride, *const b = a + stride;
    uint8_t *const row = out->pixels + (ptrdiff_t)v * out->width_px;
    for (int32_t u = 0; u < out->width_px; ++u)
      row[u] = (uint8_t)((a[2 * u] + a[2 * u + 1] + b[2 * u] + b[2 * u + 1] + 2) >> 2);
  }
}

void vista_level_halve(const uint8_t *pixels, ptrdiff_t stride, const vista_level *out) { halve(pixels, stride, out); }

/* Not for keeping secrets: two images of a camera that works differ in so many pixels that it cannot miss it. */
static uint64_t digest_of(const vista_level *level) {
  uint64_t digest = UINT64_C(14695981039346656037);
  const size_t bytes = (size_t)level->width_px * (size_t)level->height_px;
  for (size_t k = 0; k + sizeof digest <= bytes; k += sizeof digest) {
    uint64_t word;
    memcpy(&word, level->pixels + k, sizeof word);
    digest = (digest ^ word) * UINT64_C(1099511628211);
    digest ^= digest >> 29;
  }
  return digest;
}

VISTA_WIDE_VECTORS static void widen(const vista_level *level, float *grey) {
  const ptrdiff_t count = (ptrdiff_t)level->width_px * level->height_px;
  for (ptrdiff_t k = 0; k < count; ++k) grey[k] = level->pixels[k];
}

/* Measures the spread of the tile that begins at each pixel of the right image. */
VISTA_WIDE_VECTORS static void measure_spread(const vista_level *right, int32_t *sums, float *spread) {
  const int32_t width = right->width_px, last = width - TILE;
  int32_t *const plain = sums, *const squares = sums + width;
  memset(sums, 0, 2 * (size_t)width * sizeof *sums);
  for (int32_t v = 0; v < right->height_px; ++v) {
    const uint8_t *const row = right->pixels + (ptrdiff_t)v * width;
    const uint8_t *const old = v >= TILE ? row - (ptrdiff_t)TILE * width : NULL;
    for (int32_t u = 0; u < width; ++u) {
      const int32_t in = row[u], out = old != NULL ? old[u] : 0;
      plain[u] += in - out;
      squares[u] += in * in - out * out;
    }
    if (v < TILE - 1) continue;
    float *const target = spread + (ptrdiff_t)(v - TILE + 1) * width;
    for (int32_t u = 0; u <= last; ++u) {
      int32_t sum = 0, square = 0;
      for (int32_t k = 0; k < TILE; ++k) {
        sum += plain[u + k];
        square += squares[u + k];
      }
      target[u] = sqrtf((float)(square * TILE_PIXELS - sum * sum) * (1.0f / TILE_PIXELS));
    }
  }
}

bool vista_tile_has_corners(const vista_level *left, int32_t u0, int32_t v0, double least) {
  int32_t uu = 0, uv = 0, vv = 0;
  const ptrdiff_t width = left->width_px;
  for (int32_t v = v0; v < v0 + TILE; ++v) {
    const uint8_t *const row = left->pixels + v * width;
    for (int32_t u = u0; u < u0 + TILE; ++u) {
      const int32_t gu = row[u + 1] - row[u - 1], gv = row[u + width] - row[u - width];
      uu += gu * gu;
      uv += gu * gv;
      vv += gv * gv;
    }
  }
  const double half_sum = 0.5 * (uu + vv), half_difference = 0.5 * (uu - vv);
  const double weaker = half_sum - sqrt(half_difference * half_difference + (double)uv * uv);
  return weaker > 4.0 * TILE_PIXELS * least * least; /* the differences are across two pixels */
}

/* Correlation of the left tile with the right tiles in one row, from disparity `most` down to 0. */
VISTA_WIDE_VECTORS static void correlate(const float tile[TILE_PIXELS], const float *right, ptrdiff_t width,
                                         const float *spread, float tile_spread, int32_t columns, float *scores) {
  for (int32_t first = 0; first < columns; first += LANES) {
    float sums[LANES] = {0};
    for (int32_t y = 0; y < TILE; ++y)
      for (int32_t x = 0; x < TILE; ++x) {
        const float grey = tile[y * TILE + x], *const at = right + y * width + x + first;
        for (int32_t k = 0; k < LANES; ++k) sums[k] += grey * at[k];
      }
    const int32_t count = columns - first < LANES ? columns - first : LANES;
    for (int32_t k = 0; k < count; ++k) {
      const float of_right = spread[first + k];
      scores[first + k] = of_right > FLAT_SPREAD ? sums[k] / (tile_spread * of_right) : 0.0f;
    }
  }
}

typedef struct found_place {
  float score, second;
  int32_t column, row; /* of the search */
} found_place;

static found_place best_of(const float *scores, int32_t columns, int32_t rows) {
  found_place best = {.score = -1.0f, .second = -1.0f};
  for (int32_t k = 0; k < rows * columns; ++k)
    if (scores[k] > best.score) best = (found_place){scores[k], -1.0f, k % columns, k / columns};
  for (int32_t row = 0; row < rows; ++row)
    for (int32_t column = 0; column < columns; ++column) {
      const int32_t du = column - best.column, dv = row - best.row;
      if (du >= -2 && du <= 2 && dv >= -2 && dv <= 2) continue;
      best.second = vista_larger(best.second, scores[row * columns + column]);
    }
  return best;
}

/* Finds the tile in the right image. False: nowhere, or nothing tells where. */
static bool search(vista_row_matches *m, int32_t reach_rows, int32_t u0, int32_t v0, vista_place *place) {
  const vista_level *const left = &m->quarter[0], *const right = &m->quarter[1];
  const int32_t width = left->width_px;
  float tile[TILE_PIXELS], sum = 0.0f, squares = 0.0f;
  for (int32_t k = 0; k < TILE_PIXELS; ++k)
    sum += tile[k] = left->pixels[(ptrdiff_t)(v0 + k / TILE) * width + u0 + k % TILE];
  for (int32_t k = 0; k < TILE_PIXELS; ++k) {
    tile[k] -= sum / TILE_PIXELS;
    squares += tile[k] * tile[k];
  }
  const int32_t first_u = u0 > m->reach_columns ? u0 - m->reach_columns : 0, columns = u0 - first_u + 1;
  const int32_t last_v = right->height_px - TILE;
  const int32_t first_v = v0 > reach_rows ? v0 - reach_rows : 0;
  const int32_t end_v = v0 + reach_rows < last_v ? v0 + reach_rows + 1 : last_v + 1;
  for (int32_t v = first_v; v < end_v; ++v) {
    const ptrdiff_t at = (ptrdiff_t)v * width + first_u;
    correlate(tile, m->grey + at, width, m->spread + at, sqrtf(squares), columns, m->scores + (v - first_v) * columns);
  }
  const found_place best = best_of(m->scores, columns, end_v - first_v);
  if (best.score < CORRELATION_MIN) return false;
  if (1.0f - best.score + ROUNDING > AMBIGUOUS_SHARE * (1.0f - best.second)) {
    m->ambiguous += best.score > ALIKE;
    return false;
  }
  *place = (vista_place){.u0 = 2 * u0,
                         .v0 = 2 * v0,
                         .du = 2.0f * (float)(first_u + best.column - u0),
                         .dv = 2.0f * (float)(first_v + best.row - v0)};
  return true;
}

static void look_for(vista_row_matches *m, int32_t reach_rows, int32_t u0, int32_t v0) {
  vista_place place;
  ++m->features;
  if (!search(m, reach_rows, u0, v0, &place) || !vista_place_refine(&m->half[0], &m->half[1], &place)) return;
  const float middle = (float)VISTA_PLACE_SIDE; /* of the tile, from its first pixel, in pixels of the image */
  m->matches[m->count++] = (vista_row_match){.u_px = 2.0f * ((float)place.u0 + place.du) + middle - 0.5f,
                                             .v_px = 2.0f * ((float)place.v0 + place.dv) + middle - 0.5f,
                                             .row_error_px = 2.0f * place.dv,
                                             .sigma_px = 2.0f * place.sigma_v};
}

void vista_row_matches_find(const vista_image *left, const vista_image *right, double noise_sigma, bool wide,
                            vista_row_matches *m) {
  const vista_image *const images[2] = {left, right};
  m->features = m->ambiguous = m->count = 0;
  m->frozen = false;
  for (int side = 0; side < 2; ++side) {
    vista_level_halve(images[side]->data, images[side]->stride, &m->half[side]);
    vista_level_halve(m->half[side].pixels, m->half[side].width_px, &m->quarter[side]);
    const uint64_t digest = digest_of(&m->quarter[side]);
    m->frozen |= digest == m->digests[side];
    m->digests[side] = digest;
  }
  if (m->frozen) return;
  widen(&m->quarter[1], m->grey);
  measure_spread(&m->quarter[1], m->row_sums, m->spread);
  const vista_level *const level = &m->quarter[0];
  /* Tiles at the rim have no gradients all round. */
  const uint32_t across = (uint32_t)(level->width_px - 2) / TILE, down = (uint32_t)(level->height_px - 2) / TILE;
  const uint32_t tiles = across * down, step = tiles % TURN_STEP == 0 ? 1 : TURN_STEP;
  const double least = fmax(GRADIENT_MIN, GRADIENT_NOISE * noise_sigma);
  const int32_t reach_near = m->reach_rows < NEAR_ROWS ? m->reach_rows : NEAR_ROWS;
  /* NOLINTNEXTLINE(clang-analyzer-core.DivideZero): images without a tile are refused before */
  uint32_t tile = m->turn++ * 31U % tiles;
  for (uint32_t k = 0; k < tiles && m->features < VISTA_ROW_MATCHES_MOST; ++k, tile = (tile + step) % tiles) {
    const int32_t u0 = 1 + (int32_t)(tile % across) * TILE, v0 = 1 + (int32_t)(tile / across) * TILE;
    if (vista_tile_has_corners(level, u0, v0, least)) look_for(m, wide ? m->reach_rows : reach_near, u0, v0);
  }
}
