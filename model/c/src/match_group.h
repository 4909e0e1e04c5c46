/* Steps 2, 3 and 6 in vectors, written once over `group`: 32 costs of 16 bits of one pixel, d rising.
 *
 * The including file defines VISTA_TARGET, VISTA_INLINE, the type and, with the meaning of their names,
 *   group_fill, group_load, group_store, group_add, group_sub, group_min, group_pad (a group with the lanes from
 *   `first` up at 65535, the others 0), group_or, group_smallest, group_equal and group_at_most (32-bit masks, bit d),
 *   group_top (the uppermost lane), group_up (every lane moves up by one, the lowest comes from `below`'s uppermost),
 *   group_pick (a where low <= high, else b), group_cost_change (see there). */
#ifndef VISTA_ENGINE_MATCH_GROUP_H
#define VISTA_ENGINE_MATCH_GROUP_H

enum { LANES = VISTA_ROWS_LANES, MAX_GROUPS = VISTA_ENGINE_MAX_DISPARITIES / LANES };

/* Step 3 for one pixel, and what steps 5 and 7 need to know of its costs. */
VISTA_INLINE void pick_winner(const vista_winner_row *winner, const group *sums, int groups, uint32_t ratio, int32_t x,
                              uint16_t *costs) {
  group least_of_each = sums[0];
  for (int g = 1; g < groups; ++g) least_of_each = group_min(least_of_each, sums[g]);
  const uint32_t least = group_smallest(least_of_each);
  const uint32_t limit = uniqueness_limit(least, ratio);
  const group all_least = group_fill(least);
  const group all_limit = group_fill(limit < 0xFFFE ? limit : 0xFFFE); /* costs are below, padding is above */
  uint32_t close = 0, best = 0;
  for (int g = 0; g < groups; ++g) {
    const uint32_t equal = group_equal(sums[g], all_least);
    const uint32_t highest = (uint32_t)(LANES * g) + 31u - _lzcnt_u32(equal);
    best = g == 0 || equal ? highest : best;
    close += (uint32_t)_mm_popcnt_u32(group_at_most(sums[g], all_limit));
    group_store(costs + LANES * (g + 1), sums[g]);
  }
  winner->cost[x] = least;
  winner->close[x] = (uint16_t)close;
  winner->best[x] = (uint8_t)best;
  winner->before[x] = costs[LANES + best - 1];
  winner->after[x] = costs[LANES + best + 1];
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
  const group padding = group_pad(D - LANES * (groups - 1));
  uint16_t costs[VISTA_ENGINE_MAX_DISPARITIES + 2 * LANES] __attribute__((aligned(64)));
  group sums[MAX_GROUPS], right_cost[MAX_GROUPS], right_best[MAX_GROUPS];
  for (int g = 0; g < groups; ++g) {
    sums[g] = right_best[g] = group_fill(0);
    right_cost[g] = group_fill(0xFFFF);
  }
  const int32_t complete = D - 1 + block - 1; /* the first entering column that completes a block */
  for (int32_t x = D - 1; x < W; ++x) {
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

    const int32_t center = x - radius;
    const uint16_t *leaving = column - (ptrdiff_t)(block - 1) * lanes;
    group costs_here[MAX_GROUPS];
    for (int g = 0; g < groups; ++g) {
      costs_here[g] = g == groups - 1 ? group_or(sums[g], padding) : sums[g];
      sums[g] = group_sub(sums[g], group_load(leaving + LANES * g));
    }
    pick_winner(&winner, costs_here, groups, ratio, center, costs);
    if (check) {
      update_right(costs_here, groups, right_cost, right_best);
      winner.right_best[center - (lanes - 1)] = (uint8_t)group_top(right_best[groups - 1]);
    }
  }
  if (!check) return;
  for (int g = 0; g < groups; ++g) { /* right pixels that the end of the row cuts short */
    group_store(costs, right_best[g]);
    for (int32_t i = 0; i < LANES; ++i) winner.right_best[W - 1 - radius - LANES * g - i] = (uint8_t)costs[i];
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
