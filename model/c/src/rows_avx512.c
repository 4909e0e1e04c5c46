/* AVX-512BW: 32 costs of a pixel in a vector, one instance of the loop for each number of vectors. */
#include "rows.h"

#ifdef VISTA_ROWS_X86
#include <immintrin.h>

#define VISTA_TARGET __attribute__((target("avx2,bmi,bmi2,lzcnt,popcnt,avx512f,avx512bw,avx512vl,avx512dq")))
#define VISTA_INLINE VISTA_TARGET static inline __attribute__((always_inline))
#include "row_steps.h"
#include "add_plain.h"

#define VISTA_COST uint32_t
#define VISTA_MATCH_PLAIN match_wide
#include "match_plain.h"

enum { LANES = 32, MAX_VECTORS = VISTA_ENGINE_MAX_DISPARITIES / LANES };

/* |left_in - right_in| - |left_out - right_out| for 32 d. Prefiltered pixels stay below 127: signed bytes hold all. */
VISTA_INLINE __m512i cost_change(__m256i left_in, __m256i left_out, const uint8_t *right_in, const uint8_t *right_out,
                                 int full_range) {
  const __m256i in = _mm256_loadu_si256((const __m256i *)(const void *)right_in);
  const __m256i out = _mm256_loadu_si256((const __m256i *)(const void *)right_out);
  if (full_range) {
    const __m256i enters = _mm256_sub_epi8(_mm256_max_epu8(left_in, in), _mm256_min_epu8(left_in, in));
    const __m256i leaves = _mm256_sub_epi8(_mm256_max_epu8(left_out, out), _mm256_min_epu8(left_out, out));
    return _mm512_sub_epi16(_mm512_cvtepu8_epi16(enters), _mm512_cvtepu8_epi16(leaves));
  }
  const __m256i enters = _mm256_abs_epi8(_mm256_sub_epi8(left_in, in));
  const __m256i leaves = _mm256_abs_epi8(_mm256_sub_epi8(left_out, out));
  return _mm512_cvtepi8_epi16(_mm256_sub_epi8(enters, leaves));
}

VISTA_INLINE uint32_t smallest(const __m512i *sums, int vectors) {
  __m512i least = sums[0];
  for (int v = 1; v < vectors; ++v) least = _mm512_min_epu16(least, sums[v]);
  const __m256i half = _mm256_min_epu16(_mm512_castsi512_si256(least), _mm512_extracti64x4_epi64(least, 1));
  const __m128i quarter = _mm_min_epu16(_mm256_castsi256_si128(half), _mm256_extracti128_si256(half, 1));
  return (uint32_t)_mm_cvtsi128_si32(_mm_minpos_epu16(quarter)) & 0xFFFFu;
}

/* Steps 2 and 3 for one pixel whose costs are in `sums`. */
VISTA_INLINE void pick_winner(const vista_match_job *job, const __m512i *sums, int vectors, int32_t x,
                              uint16_t *costs) {
  const uint32_t least = smallest(sums, vectors);
  const uint32_t limit = uniqueness_limit(least, (uint32_t)job->uniqueness_ratio);
  const __m512i least_all = _mm512_set1_epi16((short)least);
  const __m512i limit_all = _mm512_set1_epi16((short)(limit < 0xFFFFu ? limit : 0xFFFEu)); /* below the padding */
  uint32_t close = 0, best = 0;
  for (int v = 0; v < vectors; ++v) {
    const uint32_t equal = _mm512_cmpeq_epi16_mask(sums[v], least_all);
    best = equal ? (uint32_t)(LANES * v) + 31u - (uint32_t)__builtin_clz(equal) : best;
    close += (uint32_t)__builtin_popcount(_mm512_cmple_epu16_mask(sums[v], limit_all));
    _mm512_store_si512(costs + 32 + LANES * v, sums[v]);
  }
  job->winner.cost[x] = least;
  job->winner.close[x] = (uint16_t)close;
  job->winner.best[x] = (uint8_t)best;
  job->winner.before[x] = costs[32 + best - 1];
  job->winner.after[x] = costs[32 + best + 1];
}

/* Step 6: lane d of `cost` and `best` belongs to right pixel x - d, so both move up a lane from one x to the next
 * and a right pixel leaves at the top lane with all its candidates seen, by rising d. */
VISTA_INLINE void update_right(const __m512i *sums, int vectors, __m512i *cost, __m512i *best) {
  static const uint16_t up[LANES] = {63, 0,  1,  2,  3,  4,  5,  6,  7,  8,  9,  10, 11, 12, 13, 14,
                                     15, 16, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26, 27, 28, 29, 30};
  static const uint16_t lane[LANES] = {0,  1,  2,  3,  4,  5,  6,  7,  8,  9,  10, 11, 12, 13, 14, 15,
                                       16, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26, 27, 28, 29, 30, 31};
  const __m512i shift = _mm512_loadu_si512(up), first = _mm512_loadu_si512(lane);
  for (int v = vectors - 1; v >= 0; --v) {
    const __m512i below_cost = v > 0 ? cost[v - 1] : _mm512_set1_epi16(-1), below_best = v > 0 ? best[v - 1] : first;
    const __m512i old_cost = _mm512_permutex2var_epi16(cost[v], shift, below_cost);
    const __m512i old_best = _mm512_permutex2var_epi16(best[v], shift, below_best);
    const __mmask32 better = _mm512_cmple_epu16_mask(sums[v], old_cost);
    cost[v] = _mm512_min_epu16(sums[v], old_cost);
    best[v] = _mm512_mask_add_epi16(old_best, better, first, _mm512_set1_epi16((short)(LANES * v)));
  }
}

VISTA_INLINE void match_vectors(const vista_match_job *job, int vectors, int full_range, int check) {
  const int32_t D = job->num_disparities, W = job->width, block = job->block_size, radius = block / 2;
  const int32_t lanes = LANES * vectors;
  const __m512i padding =
      _mm512_maskz_set1_epi16(D % LANES ? 0xFFFFFFFFu << (D % LANES) : 0, -1);
  uint16_t costs[32 + VISTA_ENGINE_MAX_DISPARITIES + 32] __attribute__((aligned(64)));
  __m512i sums[MAX_VECTORS], right_cost[MAX_VECTORS], right_best[MAX_VECTORS];
  for (int v = 0; v < vectors; ++v) {
    sums[v] = _mm512_setzero_si512();
    right_cost[v] = _mm512_set1_epi16(-1);
    right_best[v] = _mm512_setzero_si512();
  }
  const int32_t complete = D - 1 + block - 1; /* the first entering column that completes a block */
  for (int32_t x = D - 1; x < W; ++x) {
    const __m256i left_in = _mm256_set1_epi8((char)job->left_in[x]);
    const __m256i left_out = _mm256_set1_epi8((char)job->left_out[x]);
    const uint8_t *right_in = job->right_in + (W - 1 - x), *right_out = job->right_out + (W - 1 - x);
    uint16_t *column = job->columns + (ptrdiff_t)x * lanes;
    for (int v = 0; v < vectors; ++v) {
      const __m512i change =
          cost_change(left_in, left_out, right_in + LANES * v, right_out + LANES * v, full_range);
      const __m512i entering = _mm512_add_epi16(_mm512_load_si512(column + LANES * v), change);
      _mm512_store_si512(column + LANES * v, entering);
      sums[v] = _mm512_add_epi16(sums[v], entering);
    }
    if (x < complete) continue;

    const int32_t center = x - radius;
    const uint16_t *leaving = column - (ptrdiff_t)(block - 1) * lanes;
    __m512i real[MAX_VECTORS];
    for (int v = 0; v < vectors; ++v) {
      real[v] = v == vectors - 1 ? _mm512_or_si512(sums[v], padding) : sums[v];
      sums[v] = _mm512_sub_epi16(sums[v], _mm512_load_si512(leaving + LANES * v));
    }
    pick_winner(job, real, vectors, center, costs);
    if (check) {
      update_right(real, vectors, right_cost, right_best);
      job->winner.right_best[center - (lanes - 1)] = (uint8_t)_mm_extract_epi16(
          _mm512_extracti32x4_epi32(right_best[vectors - 1], 3), 7);
    }
  }
  if (!check) return;
  for (int v = 0; v < vectors; ++v) { /* right pixels that the end of the row cuts short */
    _mm512_store_si512(costs, right_best[v]);
    for (int32_t i = 0; i < LANES; ++i)
      job->winner.right_best[W - 1 - radius - LANES * v - i] = (uint8_t)costs[i];
  }
}

#define MATCH_CASE(vectors)                                  \
  VISTA_TARGET static void match_##vectors(const vista_match_job *job) { \
    if (job->full_range)                                     \
      match_vectors(job, vectors, 1, job->check);            \
    else if (job->check)                                     \
      match_vectors(job, vectors, 0, 1);                     \
    else                                                     \
      match_vectors(job, vectors, 0, 0);                     \
  }
MATCH_CASE(1)
MATCH_CASE(2)
MATCH_CASE(3)
MATCH_CASE(4)
MATCH_CASE(5)
MATCH_CASE(6)
MATCH_CASE(7)
MATCH_CASE(8)

VISTA_TARGET static void match(const vista_match_job *job) {
  static void (*const cases[MAX_VECTORS])(const vista_match_job *) = {match_1, match_2, match_3, match_4,
                                                                      match_5, match_6, match_7, match_8};
  if (job->wide)
    match_wide(job);
  else
    cases[job->lanes / LANES - 1](job);
}

const vista_row_code vista_rows_avx512 = {
    .xsobel = xsobel_row,
    .mirror = mirror_row,
    .texture_columns = texture_columns_row,
    .texture_sums = texture_sums_row,
    .add_row = add_row,
    .match = match,
    .finish = finish_row,
};
#endif
