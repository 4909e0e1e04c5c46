/* Steps 2, 3, 5 and 6 in vectors, written once over `group`: LANES costs of 16 bits of one pixel, d rising.
 *
 * The including file defines VISTA_TARGET, VISTA_INLINE, LANES (16 or 32), the type and, with the meaning of their
 * names,
 *   group_fill (an item of 16 bits), group_fill_pair (two, by turns), group_load, group_store, group_add, group_sub,
 *   group_min, group_pad (a group with the lanes from `first` up at 65535, the others 0), group_or, group_equal and
 *   group_at_most (masks, bit d),
 *   group_top (the uppermost lane), group_up (every lane moves up by one, the lowest comes from `below`'s uppermost),
 *   group_pick (a where low <= high, else b), group_cost_change (see there). */
#ifndef VISTA_ENGINE_MATCH_GROUP_H
#define VISTA_ENGINE_MATCH_GROUP_H

/* Costs of so many neighbouring pixels are kept and then looked at in several passes, so that no pixel waits for
 * another and no vector is read while its items are still being written: a strip stays in the first-level cache. */
enum { STRIP = 32, MAX_GROUPS = VISTA_ENGINE_MAX_DISPARITIES / LANES };

VISTA_INLINE __m256i load_vector(const void *at) { return _mm256_load_si256((const __m256i *)at); }

/* From two vectors of partial minima, those of `a` in the even lanes and those of `b` in the odd ones. */
VISTA_INLINE __m256i merge_smallest(__m256i a, __m256i b) {
  return _mm256_min_epu16(_mm256_unpacklo_epi16(a, b), _mm256_unpackhi_epi16(a, b));
}

/* The smallest cost of each of 8 pixels of `lanes` costs. */
VISTA_INLINE __m128i smallest_of_8(const uint16_t *costs, int lanes) {
  __m256i partial[8];
  for (int i = 0; i < 8; ++i) {
    partial[i] = load_vector(costs + i * lanes);
    for (int d = 16; d < lanes; d += 16) partial[i] = _mm256_min_epu16(partial[i], load_vector(costs + i * lanes + d));
  }
  const __m256i even = merge_smallest(merge_smallest(partial[0], partial[4]), merge_smallest(partial[2], partial[6]));
  const __m256i odd = merge_smallest(merge_smallest(partial[1], partial[5]), merge_smallest(partial[3], partial[7]));
  const __m256i halves = merge_smallest(even, odd);
  return _mm_min_epu16(_mm256_castsi256_si128(halves), _mm256_extracti128_si256(halves, 1));
}

/* Smin + floor(Smin*u/100) of 8 pixels. u/100 in 16 bits of fraction, rounded down, is less than 2^-16 too small: the
 * product misses at most one, and then leaves a remainder of 100 or more. Costs are below 65534, padding above. */
VISTA_INLINE __m128i limits_of_8(__m128i least, uint32_t ratio) {
  const __m128i fraction = _mm_set1_epi16((short)(ratio == 100 ? 65535 : ratio * 65536 / 100));
  const __m128i share = _mm_mulhi_epu16(least, fraction);
  const __m128i rest =
      _mm_sub_epi16(_mm_mullo_epi16(least, _mm_set1_epi16((short)ratio)), _mm_mullo_epi16(share, _mm_set1_epi16(100)));
  const __m128i missed = _mm_cmpgt_epi16(rest, _mm_set1_epi16(99));
  const __m128i limit = _mm_adds_epu16(least, _mm_sub_epi16(share, missed));
  return _mm_min_epu16(limit, _mm_set1_epi16(-2));
}

/* Every item twice, so that one item of 32 bits fills a group. */
VISTA_INLINE void store_twice(uint32_t *at, __m128i items) {
  _mm_store_si128((__m128i *)(void *)at, _mm_unpacklo_epi16(items, items));
  _mm_store_si128((__m128i *)(void *)(at + 4), _mm_unpackhi_epi16(items, items));
}

/* 8 items of 32 bits, each from 0 to 255, as bytes. */
VISTA_INLINE void store_bytes(uint8_t *at, __m256i items) {
  const __m128i words = _mm_packus_epi32(_mm256_castsi256_si128(items), _mm256_extracti128_si256(items, 1));
  _mm_storel_epi64((__m128i *)(void *)at, _mm_packus_epi16(words, words));
}

/* The number of the highest one of each item that is not 0. From the exponent of a float: of half the item, lest it be
 * negative, and without its second bit, lest it be rounded up. */
VISTA_INLINE __m256i highest_bits(__m256i items) {
  const __m256i half = _mm256_srli_epi32(items, 1);
  const __m256i top = _mm256_andnot_si256(_mm256_srli_epi32(half, 1), half);
  const __m256i exponent = _mm256_srli_epi32(_mm256_castps_si256(_mm256_cvtepi32_ps(top)), 23);
  return _mm256_max_epi32(_mm256_sub_epi32(exponent, _mm256_set1_epi32(126)), _mm256_setzero_si256());
}

/* Where the costs of a strip equal the smallest, and where they are within the limit of step 5: bit d of group g. */
typedef struct strip_masks {
  uint32_t equal[MAX_GROUPS][STRIP], close[MAX_GROUPS][STRIP];
} strip_masks __attribute__((aligned(32)));

/* dL of 8 pixels: the highest d that is equal to the smallest. */
VISTA_INLINE __m256i best_of_8(const strip_masks *masks, int groups, int i) {
  __m256i bits = load_vector(masks->equal[0] + i), first = _mm256_setzero_si256();
  for (int g = 1; g < groups; ++g) {
    const __m256i equal = load_vector(masks->equal[g] + i);
    const __m256i none = _mm256_cmpeq_epi32(equal, _mm256_setzero_si256());
    bits = _mm256_blendv_epi8(equal, bits, none);
    first = _mm256_blendv_epi8(_mm256_set1_epi32(LANES * g), first, none);
  }
  return _mm256_add_epi32(first, highest_bits(bits));
}

/* Step 5 for 8 pixels: 1 where no d but dL and its neighbours is within the limit. The three neighbouring bits may lie
 * across the ends of a group; shifts out of 0..31 give 0. */
VISTA_INLINE __m256i unique_of_8(const strip_masks *masks, int groups, int i, __m256i best) {
  const __m256i three = _mm256_set1_epi32(7);
  __m256i rivals = _mm256_setzero_si256();
  for (int g = 0; g < groups; ++g) {
    const __m256i second = _mm256_set1_epi32(LANES * g + 1);
    const __m256i near = _mm256_or_si256(_mm256_sllv_epi32(three, _mm256_sub_epi32(best, second)),
                                         _mm256_srlv_epi32(three, _mm256_sub_epi32(second, best)));
    rivals = _mm256_or_si256(rivals, _mm256_andnot_si256(near, load_vector(masks->close[g] + i)));
  }
  return _mm256_and_si256(_mm256_cmpeq_epi32(rivals, _mm256_setzero_si256()), _mm256_set1_epi32(1));
}

/* Steps 3 and 5, and what step 7 needs, for the pixels of a strip from x on. Always a whole strip: rows have room for
 * it. `costs` has LANES spare items at both ends. */
VISTA_INLINE void pick_winners(const vista_winner_row *winner, const uint16_t *costs, int groups, uint32_t ratio,
                               int32_t x) {
  const int lanes = LANES * groups;
  uint32_t leasts[STRIP] __attribute__((aligned(32))), limits[STRIP] __attribute__((aligned(32)));
  int32_t bests[STRIP] __attribute__((aligned(32)));
  uint64_t around[STRIP] __attribute__((aligned(32)));
  strip_masks masks;
  for (int i = 0; i < STRIP; i += 8) {
    const __m128i least = smallest_of_8(costs + i * lanes, lanes);
    store_twice(leasts + i, least);
    store_twice(limits + i, limits_of_8(least, ratio));
    _mm256_storeu_si256((__m256i *)(void *)(winner->cost + x + i), _mm256_cvtepu16_epi32(least));
  }
#pragma GCC unroll 8
  for (int i = 0; i < STRIP; ++i) {
    const group all_least = group_fill_pair(leasts[i]), all_limit = group_fill_pair(limits[i]);
    for (int g = 0; g < groups; ++g) {
      const group here = group_load(costs + i * lanes + LANES * g);
      masks.equal[g][i] = group_equal(here, all_least);
      masks.close[g][i] = group_at_most(here, all_limit);
    }
  }
  for (int i = 0; i < STRIP; i += 8) {
    const __m256i best = best_of_8(&masks, groups, i);
    _mm256_store_si256((__m256i *)(void *)(bests + i), best);
    store_bytes(winner->best + x + i, best);
    store_bytes(winner->unique + x + i, ratio == 0 ? _mm256_set1_epi32(1) : unique_of_8(&masks, groups, i, best));
  }
#pragma GCC unroll 8
  for (int i = 0; i < STRIP; ++i) /* S(dL-1) .. S(dL+2) */
    memcpy(around + i, costs + i * lanes + bests[i] - 1, sizeof *around);
  for (int i = 0; i < STRIP; i += 4) { /* both neighbours at once, each then 32 bits wide */
    const __m256i both = _mm256_and_si256(load_vector(around + i), _mm256_set1_epi64x(0x0000FFFF0000FFFF));
    _mm256_storeu_si256((__m256i *)(void *)(winner->around + 2 * (x + i)), both);
  }
}

/* Step 6. Lane d of `cost` and `best` belongs to right pixel x - d: both move up a lane from one x to the next, and a
 * right pixel leaves at the top when all its candidates have come by, d rising. */
VISTA_INLINE void update_right(const group *sums, int groups, group *cost, group *best) {
  static const uint16_t numbers[32] = {0,  1,  2,  3,  4,  5,  6,  7,  8,  9,  10, 11, 12, 13, 14, 15,
                                       16, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26, 27, 28, 29, 30, 31};
  const group lanes = group_load(numbers), none = group_fill(0xFFFF);
  for (int g = groups - 1; g >= 0; --g) {
    const group old_cost = group_up(cost[g], g > 0 ? cost[g - 1] : none);
    const group old_best = group_up(best[g], g > 0 ? best[g - 1] : none);
    const group candidates = group_add(lanes, group_fill((uint32_t)(LANES * g)));
    best[g] = group_pick(sums[g], old_cost, candidates, old_best);
    cost[g] = group_min(sums[g], old_cost);
  }
}

VISTA_INLINE void match_groups(const vista_match_job *job, int groups, int full_range, int check) {
  const int32_t D = job->num_disparities, W = job->width, block = job->block_size, radius = block / 2;
  const int32_t lanes = LANES * groups;
  const uint32_t ratio = (uint32_t)job->uniqueness_ratio;
  const vista_winner_row winner = job->winner;
  const uint8_t *const left_row_in = job->left_in, *const left_row_out = job->left_out;
  const uint8_t *const right_row_in = job->right_in + (W - 1), *const right_row_out = job->right_out + (W - 1);
  uint16_t *const columns = job->columns;
  uint8_t *const right_row = job->winner.right_best;
  const group padding = group_pad(D - LANES * (groups - 1));
  uint16_t strip[STRIP * LANES * MAX_GROUPS + 2 * LANES] __attribute__((aligned(64)));
  uint16_t *const costs = strip + LANES;
  group sums[MAX_GROUPS], right_cost[MAX_GROUPS], right_best[MAX_GROUPS];
  for (int g = 0; g < groups; ++g) {
    sums[g] = right_best[g] = group_fill(0);
    right_cost[g] = group_fill(0xFFFF);
  }
  const int32_t complete = D - 1 + block - 1; /* the first entering column that completes a block */
  for (int32_t first = D - 1; first < W;) {
    const int32_t end = first < complete ? complete : first + STRIP < W ? first + STRIP : W;
    for (int32_t x = first; x < end; ++x) {
      const uint8_t *right_in = right_row_in - x, *right_out = right_row_out - x;
      uint16_t *column = columns + (ptrdiff_t)x * lanes;
      for (int g = 0; g < groups; ++g) {
        const group change =
            group_cost_change(left_row_in[x], left_row_out[x], right_in + LANES * g, right_out + LANES * g, full_range);
        const group entering = group_add(group_load(column + LANES * g), change);
        group_store(column + LANES * g, entering);
        sums[g] = group_add(sums[g], entering);
      }
      if (x < complete) continue;

      const uint16_t *leaving = column - (ptrdiff_t)(block - 1) * lanes;
      uint16_t *const here = costs + (x - first) * lanes;
      group costs_here[MAX_GROUPS];
      for (int g = 0; g < groups; ++g) {
        costs_here[g] = g == groups - 1 ? group_or(sums[g], padding) : sums[g];
        group_store(here + LANES * g, costs_here[g]);
        sums[g] = group_sub(sums[g], group_load(leaving + LANES * g));
      }
      if (check) {
        update_right(costs_here, groups, right_cost, right_best);
        right_row[x - radius - (lanes - 1)] = (uint8_t)group_top(right_best[groups - 1]);
      }
    }
    if (first >= complete) pick_winners(&winner, costs, groups, ratio, first - radius);
    first = end;
  }
  if (!check) return;
  for (int g = 0; g < groups; ++g) { /* right pixels that the end of the row cuts short */
    group_store(costs, right_best[g]);
    for (int32_t i = 0; i < LANES; ++i) right_row[W - 1 - radius - LANES * g - i] = (uint8_t)costs[i];
  }
}

/* One instance for each mode. */
VISTA_INLINE void match_modes(const vista_match_job *job, int groups) {
  if (job->full_range)
    match_groups(job, groups, 1, job->check);
  else if (job->check)
    match_groups(job, groups, 0, 1);
  else
    match_groups(job, groups, 0, 0);
}

#endif
