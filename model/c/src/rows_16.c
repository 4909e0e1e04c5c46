/* D 16: half a group of the others. */
#include "rows.h"

#ifdef VISTA_ROWS_NEON
#include <string.h>

#include "vista/engine.h"

#define VISTA_TARGET
#define VISTA_INLINE static inline __attribute__((always_inline))

#define VECTORS 2
#include "group_neon.h"
#include "match_group.h"

void vista_match_16(const vista_match_job *job) { match_modes(job, 1); }
#endif

#ifdef VISTA_ROWS_X86 /* AVX2: a group is one vector */
#include <immintrin.h>
#include <string.h>

#include "vista/engine.h"

#define VISTA_TARGET __attribute__((target("avx2,bmi,bmi2")))
#define VISTA_INLINE VISTA_TARGET static inline __attribute__((always_inline))

enum { LANES = 16 };
typedef __m256i group;

VISTA_INLINE group group_fill(uint32_t value) { return _mm256_set1_epi16((short)value); }
VISTA_INLINE group group_fill_pair(uint32_t pair) { return _mm256_set1_epi32((int)pair); }
VISTA_INLINE group group_load(const uint16_t *at) { return _mm256_loadu_si256((const __m256i *)(const void *)at); }
VISTA_INLINE void group_store(uint16_t *at, group a) { _mm256_storeu_si256((__m256i *)(void *)at, a); }
VISTA_INLINE group group_add(group a, group b) { return _mm256_add_epi16(a, b); }
VISTA_INLINE group group_sub(group a, group b) { return _mm256_sub_epi16(a, b); }
VISTA_INLINE group group_min(group a, group b) { return _mm256_min_epu16(a, b); }
VISTA_INLINE group group_or(group a, group b) { return _mm256_or_si256(a, b); }

/* All ones where a <= b: AVX2 compares signed words only. */
VISTA_INLINE group at_most(group a, group b) { return _mm256_cmpeq_epi16(group_min(a, b), a); }

VISTA_INLINE uint32_t mask_bits(group a) {
  const __m128i bytes = _mm_packs_epi16(_mm256_castsi256_si128(a), _mm256_extracti128_si256(a, 1));
  return (uint32_t)_mm_movemask_epi8(bytes);
}

VISTA_INLINE uint32_t group_equal(group a, group b) { return mask_bits(_mm256_cmpeq_epi16(a, b)); }
VISTA_INLINE uint32_t group_at_most(group a, group b) { return mask_bits(at_most(a, b)); }

VISTA_INLINE group group_pad(int first) {
  uint16_t lanes[16];
  for (int i = 0; i < 16; ++i) lanes[i] = i >= first ? 0xFFFF : 0;
  return group_load(lanes);
}

VISTA_INLINE uint32_t group_top(group a) { return (uint32_t)_mm256_extract_epi16(a, 15); }

VISTA_INLINE group group_up(group a, group below) {
  return _mm256_alignr_epi8(a, _mm256_permute2x128_si256(below, a, 0x21), 14);
}

VISTA_INLINE group group_pick(group low, group high, group a, group b) {
  return _mm256_blendv_epi8(b, a, at_most(low, high));
}

/* |left_in - right_in| - |left_out - right_out|. Prefiltered pixels are below 127: signed bytes hold the difference. */
VISTA_INLINE group group_cost_change(uint8_t left_in, uint8_t left_out, const uint8_t *right_in,
                                     const uint8_t *right_out, int full_range) {
  const __m128i l_in = _mm_set1_epi8((char)left_in), l_out = _mm_set1_epi8((char)left_out);
  const __m128i r_in = _mm_loadu_si128((const __m128i *)(const void *)right_in);
  const __m128i r_out = _mm_loadu_si128((const __m128i *)(const void *)right_out);
  if (full_range) {
    const __m128i enters = _mm_sub_epi8(_mm_max_epu8(l_in, r_in), _mm_min_epu8(l_in, r_in));
    const __m128i leaves = _mm_sub_epi8(_mm_max_epu8(l_out, r_out), _mm_min_epu8(l_out, r_out));
    return _mm256_sub_epi16(_mm256_cvtepu8_epi16(enters), _mm256_cvtepu8_epi16(leaves));
  }
  const __m128i enters = _mm_abs_epi8(_mm_sub_epi8(l_in, r_in));
  const __m128i leaves = _mm_abs_epi8(_mm_sub_epi8(l_out, r_out));
  return _mm256_cvtepi8_epi16(_mm_sub_epi8(enters, leaves));
}

#include "items_x86.h"
#include "match_group.h"

VISTA_TARGET void vista_match_16(const vista_match_job *job) { match_modes(job, 1); }
#endif
