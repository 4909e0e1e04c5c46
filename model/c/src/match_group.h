/* Steps 2, 3 and 6 in vectors, written once over `group`: 32 costs of 16 bits of one pixel, d rising.
 *
 * The including file defines VISTA_TARGET, VISTA_INLINE, the type and, with the meaning of their names,
 *   group_fill, group_load, group_store, group_add, group_sub, group_min, group_pad (a group with the lanes from
 *   `first` up at 65535, the others 0), group_or, group_narrow (the minima of lanes 8 apart), group_equal and
 *   group_at_most (32-bit masks, bit d),
 *   group_top (the uppermost lane), group_up (every lane moves up by one, the lowest comes from `below`'s uppermost),
 *   group_pick (a where low <= high, else b), group_cost_change (see there). */
#ifndef VISTA_ENGINE_MATCH_GROUP_H
#define VISTA_ENGINE_MATCH_GROUP_H

/* Costs of so many neighbouring pixels are kept, so that the winners can be found pixel by pixel without waiting for
 * one another: a strip of them stays in the first-level cache. */
enum { LANES = VISTA_ROWS_LANES, MAX_GROUPS = VISTA_ENGINE_MAX_DISPARITIES / LANES, STRIP = 16 };

/* From two vectors of partial minima, those of `a` in the even lanes and those of `b` in the odd ones. */
VISTA_INLINE __m128i merge_smallest(__m128i a, __m128i b) {
  return _mm_min_epu16(_mm_unpacklo_epi16(a, b), _mm_unpackhi_epi16(a, b));
}

/* The smallest cost of each of 8 pixels. */
VISTA_INLINE __m128i smallest_of_8(const uint16_t *costs, int groups) {
  __m128i partial[8];
  for (int i = 0; i < 8; ++i) {
    group least = group_load(costs + i * LANES * groups);
    for (int g = 1; g < groups; ++g) least = group_min(least, group_load(costs + LANES * (i * groups + g)));
    partial[i] = group_narrow(least);
  }
  const __m128i even = merge_smallest(merge_smallest(partial[0], partial[4]), merge_smallest(partial[2], partial[6]));
  const __m128i odd = merge_smallest(merge_smallest(partial[1], partial[5]), merge_smallest(partial[3], partial[7]));
  return merge_smallest(even, odd);
}

/* Smin + floor(Smin*u/100) of 8 pixels. The product is below 2^24 and so exact in single precision; its hundredth,
 * below 2^16, misses the next integer by 1/100, more than the rounding error. Costs are below 65534, padding above. */
VISTA_INLINE __m128i limits_of_8(__m128i least, uint32_t ratio) {
  const __m256i cost = _mm256_cvtepu16_epi32(least);
  const __m256i product = _mm256_mullo_epi32(cost, _mm256_set1_epi32((int)ratio));
  const __m256 part = _mm256_div_ps(_mm256_cvtepi32_ps(product), _mm256_set1_ps(100.0f));
  __m256i limit = _mm256_add_epi32(cost, _mm256_cvttps_epi32(part));
  limit = _mm256_min_epi32(limit, _mm256_set1_epi32(0xFFFE));
  return _mm_packus_epi32(_mm256_castsi256_si128(limit), _mm256_extracti128_si256(limit, 1));
}

/* Step 3 for `count` pixels from x on, and what steps 5 and 7 need to know of their costs. `costs` has LANES spare
 * items at both ends. */
VISTA_INLINE void pick_winners(const vista_winner_row *winner, const uint16_t *costs, int groups, uint32_t ratio,
                               int32_t x, int32_t count) {
  uint16_t leasts[STRIP], limits[STRIP];
  for (int32_t i = 0; i < STRIP; i += 8) {
    const __m128i least = smallest_of_8(costs + i * LANES * groups, groups);
    _mm_storeu_si128((__m128i *)(void *)(leasts + i), least);
    _mm_storeu_si128((__m128i *)(void *)(limits + i), limits_of_8(least, ratio));
    _mm256_storeu_si256((__m256i *)(void *)(winner->cost + x + i), _mm256_cvtepu16_epi32(least));
  }
  for (int32_t i = 0; i < count; ++i) {
    const uint16_t *at = costs + i * LANES * groups;
    const group all_least = group_fill(leasts[i]), all_limit = group_fill(limits[i]);
    uint32_t close = 0, best = 0;
    for (int g = 0; g < groups; ++g) {
      const group here = group_load(at + LANES * g);
      const uint32_t equal = group_equal(here, all_least);
      const uint32_t highest = (uint32_t)(LANES * g) + 31u - _lzcnt_u32(equal);
      best = g == 0 || equal ? highest : best;
      close += (uint32_t)_mm_popcnt_u32(group_at_most(here, all_limit));
    }
    winner->close[x + i] = (uint16_t)close;
    winner->best[x + i] = (uint8_t)best;
    uint64_t around; /* S(dL-1) .. S(dL+2); both neighbours at once, each then 32 bits wide */
    memcpy(&around, at + (int32_t)best - 1, sizeof around);
    around &= 0x0000FFFF0000FFFFu;
    memcpy(winner->around + 2 * (x + i), &around, sizeof around);
  }
}

/* Step 6. Lane d of `cost` and `best` belongs to right pixel x - d: both move up a lane from one x to the next, and a
 * right pixel leaves at the top when all its candidates have come by, d rising. */
VISTA_INLINE void update_right(const group *sums, int groups, group *cost, group *best) {
  static const uint16_t numbers[LANES] = {0,  1,  2,  3,  4,  5,  6,  7,  8,  9,  10, 11, 12, 13, 14, 15,
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
        const group change = group_cost_change(left_row_in[x], left_row_out[x], right_in + LANES * g,
                                               right_out + LANES * g, full_range);
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
    if (first >= complete) pick_winners(&winner, costs, groups, ratio, first - radius, end - first);
    first = end;
  }
  if (!check) return;
  for (int g = 0; g < groups; ++g) { /* right pixels that the end of the row cuts short */
    group_store(costs, right_best[g]);
    for (int32_t i = 0; i < LANES; ++i) right_row[W - 1 - radius - LANES * g - i] = (uint8_t)costs[i];
  }
}

/* One instance for each number of groups: all sums stay in registers. */
#define MATCH_INSTANCE(groups)                                          \
  VISTA_TARGET static void match_##groups(const vista_match_job *job) { \
    if (job->full_range)                                                \
      match_groups(job, groups, 1, job->check);                         \
    else if (job->check)                                                \
      match_groups(job, groups, 0, 1);                                  \
    else                                                                \
      match_groups(job, groups, 0, 0);                                  \
  }
MATCH_INSTANCE(1)
MATCH_INSTANCE(2)
MATCH_INSTANCE(3)
MATCH_INSTANCE(4)
MATCH_INSTANCE(5)
MATCH_INSTANCE(6)
MATCH_INSTANCE(7)
MATCH_INSTANCE(8)
#undef MATCH_INSTANCE

VISTA_TARGET static void match_narrow(const vista_match_job *job) {
  static void (*const instances[MAX_GROUPS])(const vista_match_job *) = {match_1, match_2, match_3, match_4,
                                                                         match_5, match_6, match_7, match_8};
  instances[job->lanes / LANES - 1](job);
}

#endif
