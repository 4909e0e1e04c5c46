/* AVX2: a group is two vectors. */
#include "rows.h"

#ifdef VISTA_ROWS_X86
#include <immintrin.h>

#define VISTA_TARGET __attribute__((target("avx2,bmi,bmi2")))
#define VISTA_INLINE VISTA_TARGET static inline __attribute__((always_inline))
#include "row_steps.h"

enum { LANES = 32 };

typedef struct group {
  __m256i low, high; /* lanes 0..15, 16..31 */
} group;

VISTA_INLINE group group_fill(uint32_t value) {
  const __m256i all = _mm256_set1_epi16((short)value);
  return (group){all, all};
}

VISTA_INLINE group group_fill_pair(uint32_t pair) {
  const __m256i all = _mm256_set1_epi32((int)pair);
  return (group){all, all};
}

VISTA_INLINE group group_load(const uint16_t *at) {
  const __m256i *vectors = (const __m256i *)(const void *)at;
  return (group){_mm256_loadu_si256(vectors), _mm256_loadu_si256(vectors + 1)};
}

VISTA_INLINE void group_store(uint16_t *at, group a) {
  __m256i *vectors = (__m256i *)(void *)at;
  _mm256_storeu_si256(vectors, a.low);
  _mm256_storeu_si256(vectors + 1, a.high);
}

VISTA_INLINE group group_add(group a, group b) {
  return (group){_mm256_add_epi16(a.low, b.low), _mm256_add_epi16(a.high, b.high)};
}

VISTA_INLINE group group_sub(group a, group b) {
  return (group){_mm256_sub_epi16(a.low, b.low), _mm256_sub_epi16(a.high, b.high)};
}

VISTA_INLINE group group_min(group a, group b) {
  return (group){_mm256_min_epu16(a.low, b.low), _mm256_min_epu16(a.high, b.high)};
}

VISTA_INLINE group group_or(group a, group b) {
  return (group){_mm256_or_si256(a.low, b.low), _mm256_or_si256(a.high, b.high)};
}

/* All ones where a <= b: AVX2 compares signed words only. */
VISTA_INLINE group at_most(group a, group b) {
  const group least = group_min(a, b);
  return (group){_mm256_cmpeq_epi16(least.low, a.low), _mm256_cmpeq_epi16(least.high, a.high)};
}

VISTA_INLINE uint32_t mask_bits(group a) {
  const __m256i bytes = _mm256_permute4x64_epi64(_mm256_packs_epi16(a.low, a.high), 0xD8); /* packed by 128 bits */
  return (uint32_t)_mm256_movemask_epi8(bytes);
}

VISTA_INLINE uint32_t group_equal(group a, group b) {
  return mask_bits((group){_mm256_cmpeq_epi16(a.low, b.low), _mm256_cmpeq_epi16(a.high, b.high)});
}

VISTA_INLINE uint32_t group_at_most(group a, group b) { return mask_bits(at_most(a, b)); }

VISTA_INLINE group group_pad(int first) {
  uint16_t lanes[32];
  for (int i = 0; i < 32; ++i) lanes[i] = i >= first ? 0xFFFF : 0;
  return group_load(lanes);
}

VISTA_INLINE uint32_t group_top(group a) { return (uint32_t)_mm256_extract_epi16(a.high, 15); }

VISTA_INLINE __m256i vector_up(__m256i a, __m256i below) {
  return _mm256_alignr_epi8(a, _mm256_permute2x128_si256(below, a, 0x21), 14);
}

VISTA_INLINE group group_up(group a, group below) {
  return (group){vector_up(a.low, below.high), vector_up(a.high, a.low)};
}

VISTA_INLINE group group_pick(group low, group high, group a, group b) {
  const group where = at_most(low, high);
  return (group){_mm256_blendv_epi8(b.low, a.low, where.low), _mm256_blendv_epi8(b.high, a.high, where.high)};
}

/* |left_in - right_in| - |left_out - right_out|. Prefiltered pixels are below 127: signed bytes hold the difference. */
VISTA_INLINE group group_cost_change(uint8_t left_in, uint8_t left_out, const uint8_t *right_in,
                                     const uint8_t *right_out, int full_range) {
  const __m256i l_in = _mm256_set1_epi8((char)left_in), l_out = _mm256_set1_epi8((char)left_out);
  const __m256i r_in = _mm256_loadu_si256((const __m256i *)(const void *)right_in);
  const __m256i r_out = _mm256_loadu_si256((const __m256i *)(const void *)right_out);
  if (full_range) {
    const __m256i enters = _mm256_sub_epi8(_mm256_max_epu8(l_in, r_in), _mm256_min_epu8(l_in, r_in));
    const __m256i leaves = _mm256_sub_epi8(_mm256_max_epu8(l_out, r_out), _mm256_min_epu8(l_out, r_out));
    const group in = {_mm256_cvtepu8_epi16(_mm256_castsi256_si128(enters)),
                      _mm256_cvtepu8_epi16(_mm256_extracti128_si256(enters, 1))};
    const group out = {_mm256_cvtepu8_epi16(_mm256_castsi256_si128(leaves)),
                       _mm256_cvtepu8_epi16(_mm256_extracti128_si256(leaves, 1))};
    return group_sub(in, out);
  }
  const __m256i enters = _mm256_abs_epi8(_mm256_sub_epi8(l_in, r_in));
  const __m256i leaves = _mm256_abs_epi8(_mm256_sub_epi8(l_out, r_out));
  const __m256i change = _mm256_sub_epi8(enters, leaves);
  return (group){_mm256_cvtepi8_epi16(_mm256_castsi256_si128(change)),
                 _mm256_cvtepi8_epi16(_mm256_extracti128_si256(change, 1))};
}

#include "items_x86.h"
#include "match_sizes.h"

#define VISTA_ROW_CODE vista_rows_avx2
#include "row_code.h"
#endif
