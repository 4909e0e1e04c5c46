/* The steps that are plain loops along x, compiled once for each instruction set by the compiler's vectoriser.
 * The including file defines VISTA_TARGET, the target attribute of its functions. */
#ifndef VISTA_ENGINE_ROW_STEPS_H
#define VISTA_ENGINE_ROW_STEPS_H

#include <string.h>

#include "rows.h"
#include "vista/engine.h"

VISTA_TARGET static void xsobel_row(const uint8_t *restrict above, const uint8_t *restrict row,
                                    const uint8_t *restrict below, int32_t width, int32_t cap, uint8_t *restrict out) {
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

/* Step 2 for a row that only enters. */
VISTA_TARGET static void add_row(const vista_match_job *job) {
  const int32_t D = job->num_disparities, W = job->width;
  for (int32_t x = D - 1; x < W; ++x) {
    const uint8_t *restrict right = job->right_in + (W - 1 - x);
    const int32_t left = job->left_in[x];
    uint16_t *restrict column = job->columns + (size_t)x * (size_t)job->lanes;
    for (int32_t d = 0; d < D; ++d)
      column[d] = (uint16_t)(column[d] + (left > right[d] ? left - right[d] : right[d] - left));
  }
}

VISTA_TARGET static uint32_t uniqueness_limit(uint32_t cost, uint32_t ratio) { return cost + cost * ratio / 100u; }

/* Step 7 for every x. With m = max(p, n) - Smin the fraction 256(p-n)/q is 128(p-n)/m. Single precision truncates it
 * exactly: both operands are exact below 2^24, and a quotient below 128 that is no integer misses the next one by at
 * least 1/m > 2^-17, twice the rounding error. m = 0 only with p = n: fraction 0. */
VISTA_TARGET static void subpixel_row(const vista_finish_job *job) {
  const int32_t last = job->num_disparities - 1;
  const uint32_t *restrict cost = job->winner.cost;
  const uint32_t *restrict around = job->winner.around;
  const uint8_t *restrict best = job->winner.best;
  int16_t *restrict disparity = job->disparity;
  for (int32_t x = job->first; x < job->end; ++x) {
    const int32_t d = best[x], low = (int32_t)around[2 * x], high = (int32_t)around[2 * x + 1];
    const int32_t p = d == 0 ? high : low, n = d == last ? low : high;
    const int32_t m = (p > n ? p : n) - (int32_t)cost[x];
    const int32_t denominator = m + (m == 0);
    const int32_t fraction = (int32_t)((float)(128 * (p - n)) / (float)denominator);
    disparity[x] = (int16_t)((256 * d + fraction + 15) >> 4);
  }
}

/* Step 6. */
VISTA_TARGET static void check_row(const vista_finish_job *job) {
  const uint8_t *best = job->winner.best, *right_best = job->winner.right_best;
  const int32_t end = job->end, most = job->lr_max_diff;
  uint8_t *restrict valid = job->valid;
  for (int32_t x = job->first; x < end; ++x) {
    const int32_t difference = best[x] - right_best[x - best[x]];
    const int32_t distance = difference < 0 ? -difference : difference;
    valid[x] = distance <= most;
  }
}

/* Step 4, and the word of what fails any step. */
VISTA_TARGET static void verdict_row(const vista_finish_job *job) {
  const uint8_t *restrict unique = job->winner.unique, *restrict valid = job->valid;
  const uint16_t *restrict texture = job->texture;
  int16_t *restrict disparity = job->disparity;
  const int32_t least_texture = job->texture_threshold;
  for (int32_t x = job->first; x < job->end; ++x) {
    const int32_t good = valid[x] & unique[x] & (texture[x] >= least_texture);
    disparity[x] = good ? disparity[x] : VISTA_DISPARITY_INVALID;
  }
}

/* Step 8. Margin and length of the texture are counted: so the loop is one of vectors. */
VISTA_TARGET static void confidence_row(const vista_finish_job *job) {
  const uint32_t *restrict cost = job->winner.cost, *restrict rival_cost = job->winner.rival_cost;
  const uint8_t *restrict best = job->winner.best, *restrict rival = job->winner.rival;
  const uint16_t *restrict texture = job->texture;
  uint16_t *restrict confidence = job->confidence;
  for (int32_t x = job->first; x < job->end; ++x) {
    const int32_t far = rival[x] - best[x], near = far > INT8_MAX ? INT8_MAX : far;
    const int32_t distance = near < INT8_MIN ? INT8_MIN : near;
    const uint32_t more = 32 * (rival_cost[x] - cost[x]);
    uint32_t margin = 0, bits = 0;
    for (uint32_t k = 1; k <= 15; ++k) margin += more > k * cost[x];
    for (uint32_t b = 0; b < 15; ++b) bits += (uint32_t)texture[x] >> b != 0;
    confidence[x] = (uint16_t)((uint32_t)distance << 8 | margin << 4 | bits);
  }
}

VISTA_TARGET static void finish_row(const vista_finish_job *job) {
  subpixel_row(job);
  if (job->lr_max_diff >= 0)
    check_row(job);
  else
    memset(job->valid + job->first, 1, (size_t)(job->end - job->first));
  verdict_row(job);
  if (job->confidence) confidence_row(job);
}

#endif
