/* AVX-512BW: a group is one vector. */
#include "rows.h"

#ifdef VISTA_ROWS_X86
#include <immintrin.h>

#define VISTA_TARGET __attribute__((target("avx2,bmi,bmi2,avx512f,avx512bw,avx512vl")))
#define VISTA_INLINE VISTA_TARGET static inline __attribute__((always_inline))
#include "row_steps.h"

enum { LANES = 32 };

typedef __m512i group;

VISTA_INLINE group group_fill(uint32_t value) { return _mm512_set1_epi16((short)value); }
VISTA_INLINE group group_fill_pair(uint32_t pair) { return _mm512_set1_epi32((int)pair); }
VISTA_INLINE group group_load(const uint16_t *at) { return _mm512_loadu_si512(at); }
VISTA_INLINE void group_store(uint16_t *at, group a) { _mm512_storeu_si512(at, a); }
VISTA_INLINE group group_add(group a, group b) { return _mm512_add_epi16(a, b); }
VISTA_INLINE group group_sub(group a, group b) { return _mm512_sub_epi16(a, b); }
VISTA_INLINE group group_min(group a, group b) { return _mm512_min_epu16(a, b); }
VISTA_INLINE group group_or(group a, group b) { return _mm512_or_si512(a, b); }
VISTA_INLINE uint32_t group_equal(group a, group b) { return _mm512_cmpeq_epi16_mask(a, b); }
VISTA_INLINE uint32_t group_at_most(group a, group b) { return _mm512_cmple_epu16_mask(a, b); }

VISTA_INLINE group group_pad(int first) { return _mm512_maskz_set1_epi16((__mmask32)(0xFFFFFFFFull << first), -1); }

VISTA_INLINE uint32_t group_top(group a) { return (uint32_t)_mm_extract_epi16(_mm512_extracti32x4_epi32(a, 3), 7); }

VISTA_INLINE group group_up(group a, group below) {
  static const uint16_t source[32] = {63, 0,  1,  2,  3,  4,  5,  6,  7,  8,  9,  10, 11, 12, 13, 14,
                                      15, 16, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26, 27, 28, 29, 30};
  return _mm512_permutex2var_epi16(a, _mm512_loadu_si512(source), below);
}

VISTA_INLINE group group_pick(group low, group high, group a, group b) {
  return _mm512_mask_blend_epi16(_mm512_cmple_epu16_mask(low, high), b, a);
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
    return _mm512_sub_epi16(_mm512_cvtepu8_epi16(enters), _mm512_cvtepu8_epi16(leaves));
  }
  const __m256i enters = _mm256_abs_epi8(_mm256_sub_epi8(l_in, r_in));
  const __m256i leaves = _mm256_abs_epi8(_mm256_sub_epi8(l_out, r_out));
  return _mm512_cvtepi8_epi16(_mm256_sub_epi8(enters, leaves));
}

#include "items_x86.h"
#include "match_sizes.h"

#define VISTA_ROW_CODE vista_rows_avx512
#include "row_code.h"
#endif
