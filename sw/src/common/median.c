#include "common/median.h"

#include <string.h>

#define BLOCK 16384 /* counts of so many words fit int16_t: as wide as the words, so that whole vectors are counted */

static int32_t whole_vectors(int32_t count) { return (count + VISTA_WORD_LANES - 1) & -VISTA_WORD_LANES; }

void vista_words_pad(int16_t *words, int32_t count) { memset(words + count, 0xff, VISTA_WORD_LANES * sizeof *words); }

static int32_t count_above(const int16_t *words, int32_t count, int16_t limit) {
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

int32_t vista_count_valid(const int16_t *words, int32_t count) { return count_above(words, count, -1); }

static void sort_two(int16_t *a, int16_t *b) {
  const int16_t low = *a < *b ? *a : *b, high = *a < *b ? *b : *a;
  *a = low;
  *b = high;
}

static int16_t median_of_four(const int16_t words[4], int32_t rank) {
  int16_t w[4] = {words[0], words[1], words[2], words[3]};
  sort_two(&w[0], &w[1]);
  sort_two(&w[2], &w[3]);
  sort_two(&w[0], &w[2]);
  sort_two(&w[1], &w[3]);
  sort_two(&w[1], &w[2]);
  return w[rank - 1];
}

/* Bisection on the value instead of a sort: every pass is one branch-free count that the compiler vectorises, and
 * a cell's disparities span few bits. */
int16_t vista_median_word(const int16_t *words, int32_t count, int32_t valid) {
  if (count == 4) return median_of_four(words, count - valid + (valid + 1) / 2);
  const int32_t padded = whole_vectors(count), above = valid / 2; /* the median */
  int16_t low = INT16_MAX, high = 0;
  for (int32_t i = 0; i < padded; ++i) {
    const int16_t word = words[i], or_largest = word < 0 ? INT16_MAX : word;
    high = word > high ? word : high;
    low = or_largest < low ? or_largest : low;
  }
  while (low < high) {
    const int16_t middle = (int16_t)((low + high) / 2);
    if (count_above(words, padded, middle) <= above)
      high = middle;
    else
      low = (int16_t)(middle + 1);
  }
  return low;
}
