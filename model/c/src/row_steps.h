/* The steps that are plain loops along x, compiled once for each instruction set by the compiler's vectoriser.
 * The including file defines VISTA_TARGET, the target attribute of its functions. */
#ifndef VISTA_ENGINE_ROW_STEPS_H
#define VISTA_ENGINE_ROW_STEPS_H

#include <string.h>

#include "rows.h"
#include "vista/engine.h"

VISTA_TARGET static void xsobel_row(const uint8_t *restrict above, const uint8_t *restrict row,
                                    const uint8_t *restrict below, int32_t width, int32_t cap,
                                    uint8_t *restrict out) {
  const int16_t low = (int16_t)-cap, high = (int16_t)cap;
  for (int32_t x = 1; x < width - 1; ++x) {
    int16_t g = (int16_t)(above[x + 1] - above[x - 1] + 2 * (row[x + 1] - row[x - 1]) + below[x + 1] - below[x - 1]);
    g = g < low ? low : g;
    g = g > high ? high : g;
    out[x] = (uint8_t)(g + high);
  }
  out[0] = out[width - 1] = (uint8_t)cap;
}

VISTA_TARGET static void mirror_row(const uint8_t *restrict row, int32_t width, uint8_t *restrict out) {
  for (int32_t x = 0; x < width; ++x) out[x] = row[width - 1 - x];
}

VISTA_TARGET static void texture_columns_row(const uint8_t *restrict in, const uint8_t *restrict out, int32_t width,
                                             int32_t cap, uint16_t *restrict columns) {
  const int16_t c = (int16_t)cap;
  for (int32_t x = 0; x < width; ++x) {
    const int16_t enters = (int16_t)(in[x] > c ? in[x] - c : c - in[x]);
    const int16_t leaves = (int16_t)(out[x] > c ? out[x] - c : c - out[x]);
    columns[x] = (uint16_t)(columns[x] + enters - leaves);
  }
}

VISTA_TARGET static void texture_sums_row(const uint16_t *restrict columns, int32_t width, int32_t block_size,
                                          uint16_t *restrict sums) {
  const int32_t radius = block_size / 2, count = width - 2 * radius;
  uint16_t *restrict out = sums + radius;
  for (int32_t x = 0; x < count; ++x) out[x] = (uint16_t)(columns[x] + columns[x + 1] + columns[x + 2]);
  for (int32_t i = 3; i < block_size; i += 2)
    for (int32_t x = 0; x < count; ++x) out[x] = (uint16_t)(out[x] + columns[x + i] + columns[x + i + 1]);
}

VISTA_TARGET static uint32_t uniqueness_limit(uint32_t cost, uint32_t ratio) {
  return cost + cost * ratio / 100u;
}

/* Step 7. With m = max(p, n) - Smin the fraction 256(p-n)/q is 128(p-n)/m. Single precision truncates it exactly:
 * both operands are exact below 2^24, and a quotient below 128 that is no integer misses the next one by at least
 * 1/m > 2^-17, twice the rounding error. m = 0 only with p = n: fraction 0. */
VISTA_TARGET static int32_t subpixel_word(int32_t best, int32_t cost, int32_t before, int32_t after) {
  const int32_t m = (before > after ? before : after) - cost;
  const float fraction = (float)(128 * (before - after)) / (float)(m > 0 ? m : 1);
  return (256 * best + (int32_t)fraction + 15) >> 4;
}

/* Step 6. */
VISTA_TARGET static void check_row(const vista_finish_job *job) {
  const uint8_t *best = job->winner.best, *right_best = job->winner.right_best;
  uint8_t *restrict valid = job->valid;
  for (int32_t x = job->first; x < job->end; ++x) {
    const int32_t difference = best[x] - right_best[x - best[x]];
    const int32_t distance = difference < 0 ? -difference : difference;
    valid[x] = distance <= job->lr_max_diff;
  }
}

VISTA_TARGET static void finish_row(const vista_finish_job *job) {
  const int32_t first = job->first, count = job->end - job->first, last = job->num_disparities - 1;
  const uint32_t *restrict cost = job->winner.cost + first;
  const uint32_t *restrict before = job->winner.before + first;
  const uint32_t *restrict after = job->winner.after + first;
  const uint16_t *restrict close = job->winner.close + first;
  const uint8_t *restrict best = job->winner.best + first;
  const uint16_t *restrict texture = job->texture ? job->texture + first : close;
  uint8_t *restrict valid = job->valid + first;
  int16_t *restrict disparity = job->disparity + first;

  const int32_t least_texture = job->texture ? job->texture_threshold : 0;
  const uint32_t ratio = (uint32_t)job->uniqueness_ratio;
  const int32_t any_number = ratio == 0; /* step 5 is off */
  if (job->lr_max_diff >= 0)
    check_row(job);
  else
    memset(valid, 1, (size_t)count);
  for (int32_t x = 0; x < count; ++x) {
    const int32_t at_low = best[x] == 0, at_high = best[x] == last;
    const uint32_t p = at_low ? after[x] : before[x];
    const uint32_t n = at_high ? before[x] : after[x];
    const uint32_t limit = uniqueness_limit(cost[x], ratio);
    const int32_t neighbours = (int32_t)(!at_low & (p <= limit)) + (int32_t)(!at_high & (n <= limit));
    const int32_t unique = any_number | (close[x] == 1 + neighbours);
    const int32_t good = valid[x] & unique & (texture[x] >= least_texture);
    const int32_t word = subpixel_word(best[x], (int32_t)cost[x], (int32_t)p, (int32_t)n);
    disparity[x] = (int16_t)(good ? word : VISTA_ENGINE_INVALID);
  }
}

#endif
