/* Eight pixels at a time in vectors of x86: what match_group.h does once the costs are there. items_neon.h has the same.
 *
 * words8: 8 items of 16 bits. items8: 8 items of 32 bits. The including file defines VISTA_INLINE. */
#ifndef VISTA_ENGINE_ITEMS_X86_H
#define VISTA_ENGINE_ITEMS_X86_H

#include <immintrin.h>
#include <stdint.h>

typedef __m128i words8;
typedef __m256i items8;

VISTA_INLINE items8 items_load(const void *at) { return _mm256_load_si256((const __m256i *)at); }
VISTA_INLINE void items_store(void *at, items8 a) { _mm256_storeu_si256((__m256i *)at, a); }
VISTA_INLINE items8 items_fill(int32_t value) { return _mm256_set1_epi32(value); }
VISTA_INLINE items8 items_add(items8 a, items8 b) { return _mm256_add_epi32(a, b); }
VISTA_INLINE items8 items_sub(items8 a, items8 b) { return _mm256_sub_epi32(a, b); }
VISTA_INLINE items8 items_and(items8 a, items8 b) { return _mm256_and_si256(a, b); }
VISTA_INLINE items8 items_or(items8 a, items8 b) { return _mm256_or_si256(a, b); }
VISTA_INLINE items8 items_without(items8 a, items8 bits) { return _mm256_andnot_si256(bits, a); }
VISTA_INLINE items8 items_widen(words8 a) { return _mm256_cvtepu16_epi32(a); }

/* All ones where an item is 0. */
VISTA_INLINE items8 items_zero(items8 a) { return _mm256_cmpeq_epi32(a, _mm256_setzero_si256()); }

/* a where the mask is all ones, else b. */
VISTA_INLINE items8 items_pick(items8 mask, items8 a, items8 b) { return _mm256_blendv_epi8(b, a, mask); }

/* Shifted to the left by so many bits, or to the right where that is negative; beyond 31 gives 0. */
VISTA_INLINE items8 items_shift(items8 a, items8 by) {
  const __m256i back = _mm256_sub_epi32(_mm256_setzero_si256(), by);
  return _mm256_or_si256(_mm256_sllv_epi32(a, by), _mm256_srlv_epi32(a, back));
}

/* Merges two vectors of partial minima, those of `a` in the even lanes and those of `b` in the odd ones. */
VISTA_INLINE __m256i merge_smallest(__m256i a, __m256i b) {
  return _mm256_min_epu16(_mm256_unpacklo_epi16(a, b), _mm256_unpackhi_epi16(a, b));
}

/* The smallest cost of each of 8 pixels of `lanes` costs. */
VISTA_INLINE words8 smallest_of_8(const uint16_t *costs, int lanes) {
  __m256i partial[8];
  for (int i = 0; i < 8; ++i) {
    partial[i] = items_load(costs + i * lanes);
    for (int d = 16; d < lanes; d += 16) partial[i] = _mm256_min_epu16(partial[i], items_load(costs + i * lanes + d));
  }
  const __m256i even = merge_smallest(merge_smallest(partial[0], partial[4]), merge_smallest(partial[2], partial[6]));
  const __m256i odd = merge_smallest(merge_smallest(partial[1], partial[5]), merge_smallest(partial[3], partial[7]));
  const __m256i halves = merge_smallest(even, odd);
  return _mm_min_epu16(_mm256_castsi256_si128(halves), _mm256_extracti128_si256(halves, 1));
}

/* Smin + floor(Smin*u/100) of 8 pixels. u/100 in 16 bits of fraction, rounded down, is less than 2^-16 too small: the
 * product misses at most one, and then leaves a remainder of 100 or more. Costs are below 65534, padding above. */
VISTA_INLINE words8 limits_of_8(words8 least, uint32_t ratio) {
  const __m128i fraction = _mm_set1_epi16((short)(ratio == 100 ? 65535 : ratio * 65536 / 100));
  const __m128i share = _mm_mulhi_epu16(least, fraction);
  const __m128i rest =
      _mm_sub_epi16(_mm_mullo_epi16(least, _mm_set1_epi16((short)ratio)), _mm_mullo_epi16(share, _mm_set1_epi16(100)));
  const __m128i missed = _mm_cmpgt_epi16(rest, _mm_set1_epi16(99));
  const __m128i limit = _mm_adds_epu16(least, _mm_sub_epi16(share, missed));
  return _mm_min_epu16(limit, _mm_set1_epi16(-2));
}

/* Every item twice, so that one item of 32 bits fills a group. */
VISTA_INLINE void store_twice(uint32_t *at, words8 items) {
  _mm_store_si128((__m128i *)(void *)at, _mm_unpacklo_epi16(items, items));
  _mm_store_si128((__m128i *)(void *)(at + 4), _mm_unpackhi_epi16(items, items));
}

/* 8 items of 32 bits, each from 0 to 255, as bytes. */
VISTA_INLINE void store_bytes(uint8_t *at, items8 items) {
  const __m128i words = _mm_packus_epi32(_mm256_castsi256_si128(items), _mm256_extracti128_si256(items, 1));
  _mm_storel_epi64((__m128i *)(void *)at, _mm_packus_epi16(words, words));
}

/* The number of the highest one of each item that is not 0. From the exponent of a float: of half the item, lest it be
 * negative, and without its second bit, lest it be rounded up. */
VISTA_INLINE items8 highest_bits(items8 items) {
  const __m256i half = _mm256_srli_epi32(items, 1);
  const __m256i top = _mm256_andnot_si256(_mm256_srli_epi32(half, 1), half);
  const __m256i exponent = _mm256_srli_epi32(_mm256_castps_si256(_mm256_cvtepi32_ps(top)), 23);
  return _mm256_max_epi32(_mm256_sub_epi32(exponent, _mm256_set1_epi32(126)), _mm256_setzero_si256());
}

#endif
