/* Steps 2, 3, 5 and 6 in vectors, and the rivals of step 8, written once over `group`: LANES costs of 16 bits of one
 * pixel, d rising.
 *
 * The including file defines VISTA_TARGET, VISTA_INLINE, LANES (16 or 32), the type and, with the meaning of their
 * names,
 *   group_fill (an item of 16 bits), group_fill_pair (two, by turns), group_load, group_store, group_add, group_sub,
 *   group_min, group_pad (a group with the lanes from `first` up at 65535, the others 0), group_or, group_equal and
 *   group_at_most (masks, bit d),
 *   group_top (the uppermost lane), group_up (every lane moves up by one, the lowest comes from `below`'s uppermost),
 *   group_pick (a where low <= high, else b), group_cost_change (see there);
 * and includes items_x86.h or items_neon.h. */
#ifndef VISTA_ENGINE_MATCH_GROUP_H
#define VISTA_ENGINE_MATCH_GROUP_H

/* Costs of so many neighbouring pixels are kept and then looked at in several passes, so that no pixel waits for
 * another and no vector is read while its items are still being written: a strip stays in the first-level cache. */
enum { STRIP = 32, MAX_GROUPS = VISTA_ENGINE_MAX_DISPARITIES / LANES };

/* Masks of where the costs of a strip equal the smallest, and where they are within the limit of step 5: bit d of
 * group g. */
typedef struct strip_masks {
  uint32_t equal[MAX_GROUPS][STRIP], close[MAX_GROUPS][STRIP];
} strip_masks __attribute__((aligned(32)));

/* dL of 8 pixels: the highest d that is equal to the smallest. */
VISTA_INLINE items8 best_of_8(const strip_masks *masks, int groups, int i) {
  items8 bits = items_load(masks->equal[0] + i), first = items_fill(0);
  for (int g = 1; g < groups; ++g) {
    const items8 equal = items_load(masks->equal[g] + i), none = items_zero(equal);
    bits = items_pick(none, bits, equal);
    first = items_pick(none, first, items_fill(LANES * g));
  }
  return items_add(first, highest_bits(bits));
}

/* Step 5 for 8 pixels: 1 where no d but dL and its neighbours is within the limit. The three neighbouring bits may lie
 * across the ends of a group. */
VISTA_INLINE items8 unique_of_8(const strip_masks *masks, int groups, int i, items8 best) {
  const items8 three = items_fill(7);
  items8 rivals = items_fill(0);
  for (int g = 0; g < groups; ++g) {
    const items8 near = items_shift(three, items_sub(best, items_fill(LANES * g + 1)));
    rivals = items_or(rivals, items_without(items_load(masks->close[g] + i), near));
  }
  return items_and(items_zero(rivals), items_fill(1));
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
    const words8 least = smallest_of_8(costs + i * lanes, lanes);
    store_twice(leasts + i, least);
    store_twice(limits + i, limits_of_8(least, ratio));
    items_store(winner->cost + x + i, items_widen(least));
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
    const items8 best = best_of_8(&masks, groups, i);
    items_store(bests + i, best);
    store_bytes(winner->best + x + i, best);
    store_bytes(winner->unique + x + i, ratio == 0 ? items_fill(1) : unique_of_8(&masks, groups, i, best));
  }
#pragma GCC unroll 8
  for (int i = 0; i < STRIP; ++i) /* S(dL-1) .. S(dL+2) */
    memcpy(around + i, costs + i * lanes + bests[i] - 1, sizeof *around);
  for (int i = 0; i < STRIP; i += 4) { /* both neighbours at once, each then 32 bits wide */
    items_store(winner->around + 2 * (x + i), items_and(items_load(around + i), items_fill(0xFFFF)));
  }
}

/* The rivals of step 8 for the pixels of a strip whose winners are known; hides these and their neighbours in `costs`.
 * Not inlined: it is seldom wanted, and registers are scarce where it is called. */
VISTA_TARGET static __attribute__((noinline)) void pick_rivals(const vista_winner_row *winner, uint16_t *costs,
                                                               int groups, int32_t x) {
  const int lanes = LANES * groups;
  uint32_t leasts[STRIP] __attribute__((aligned(32)));
  strip_masks masks;
  for (int i = 0; i < STRIP; ++i) {
    const int best = winner->best[x + i], first = best > 0 ? best - 1 : 0, last = best < lanes - 1 ? best + 1 : best;
    for (int d = first; d <= last; ++d) costs[i * lanes + d] = 0xFFFF;
  }
  for (int i = 0; i < STRIP; i += 8) {
    const words8 least = smallest_of_8(costs + i * lanes, lanes);
    store_twice(leasts + i, least);
    items_store(winner->rival_cost + x + i, items_widen(least));
  }
  for (int i = 0; i < STRIP; ++i) {
    const group all_least = group_fill_pair(leasts[i]);
    for (int g = 0; g < groups; ++g)
      masks.equal[g][i] = group_equal(group_load(costs + i * lanes + LANES * g), all_least);
  }
  for (int i = 0; i < STRIP; i += 8) store_bytes(winner->rival + x + i, best_of_8(&masks, groups, i));
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
    if (first >= complete) {
      pick_winners(&winner, costs, groups, ratio, first - radius);
      if (winner.rival) pick_rivals(&winner, costs, groups, first - radius);
    }
    first = end;
  }
  if (!check) return;
  for (int g = 0; g < groups; ++g) { /* right pixels that the end of the row cuts short */
    group_store(costs, right_best[g]);
    /* NOLINTNEXTLINE(clang-analyzer-core.uninitialized.Assign): group_store filled them */
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
