#include "common/median.h"

#include <stdbool.h>
#include <string.h>

#include "common/wide_vectors.h"

#define BLOCK 16384 /* counts of so many words fit int16_t: as wide as the words, so that whole vectors are counted */

static inline int32_t count_above(const int16_t *words, int32_t count, int16_t limit) {
  int32_t sum = 0;
  for (int32_t first = 0; first < count; first += BLOCK) {
    const int32_t end = count - first < BLOCK ? count - first : BLOCK;
    const int16_t *const block = words + first;
    int16_t above = 0;
    for (int32_t i = 0; i < end; ++i) above = (int16_t)(above + (block[i] > limit));
    sum += above;
  }
  return sum;
}

VISTA_WIDE_VECTORS static int32_t count_valid(const int16_t *words, int32_t count) {
  return count_above(words, count, -1);
}

int32_t vista_count_valid(const int16_t *words, int32_t count) { return count_valid(words, count); }

vista_word_range vista_range_of_words(const int16_t *words, int32_t count) {
  vista_word_range range = {0, INT16_MAX, 0};
  for (int32_t i = 0; i < count; ++i) {
    if (words[i] < 0) continue;
    range.valid++;
    if (words[i] < range.least) range.least = words[i];
    if (words[i] > range.most) range.most = words[i];
  }
  return range;
}

static void sort_two(int16_t *a, int16_t *b) {
  const int16_t low = *a < *b ? *a : *b, high = *a < *b ? *b : *a;
  *a = low;
  *b = high;
}

vista_words_median vista_median_of_four(const int16_t words[4]) {
  int16_t w[4] = {words[0], words[1], words[2], words[3]};
  sort_two(&w[0], &w[1]);
  sort_two(&w[2], &w[3]);
  sort_two(&w[0], &w[2]);
  sort_two(&w[1], &w[3]);
  sort_two(&w[1], &w[2]);
  const int32_t valid = (w[0] >= 0) + (w[1] >= 0) + (w[2] >= 0) + (w[3] >= 0), invalid = 4 - valid;
  if (valid == 0) return (vista_words_median){{0, INT16_MAX, 0}, w[0]};
  return (vista_words_median){{valid, w[invalid], w[3]}, w[invalid + (valid + 1) / 2 - 1]};
}

/* Bisection on the value instead of a sort: every pass is one branch-free count that the compiler vectorises, and
 * a cell's disparities span few bits. */
VISTA_WIDE_VECTORS static vista_words_median median_of(const int16_t *words, int32_t count, int16_t *scratch) {
  const int32_t padded = (count + VISTA_MEDIAN_LANES - 1) & -VISTA_MEDIAN_LANES; /* whole vectors, no remainder */
  memcpy(scratch, words, (size_t)count * sizeof *words);
  memset(scratch + count, 0xff, VISTA_MEDIAN_LANES * sizeof *words);
  int16_t low = INT16_MAX, high = 0;
  int32_t valid = padded;
  for (int32_t first = 0; first < padded; first += BLOCK) {
    const int32_t end = padded - first < BLOCK ? padded : first + BLOCK;
    int16_t invalid = 0;
    for (int32_t i = first; i < end; ++i) {
      const int16_t word = scratch[i], none = (int16_t)(word >> 15);
      const int16_t or_largest = (int16_t)((word | none) & INT16_MAX);
      invalid = (int16_t)(invalid - none);
      high = word > high ? word : high;
      low = or_largest < low ? or_largest : low;
    }
    valid -= invalid;
  }
  const vista_word_range range = {valid, low, high};
  const int32_t above = valid / 2; /* the median */
  while (low < high) {
    const int16_t middle = (int16_t)((low + high) / 2);
    const bool reaches = count_above(scratch, padded, middle) <= above;
    high = reaches ? middle : high; /* no branch: which half it is in is hard to foresee */
    low = reaches ? low : (int16_t)(middle + 1);
  }
  return (vista_words_median){range, low};
}

vista_words_median vista_median_word(const int16_t *words, int32_t count, int16_t *scratch) {
  return median_of(words, count, scratch);
}
