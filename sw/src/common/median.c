#include "common/median.h"

int32_t vista_count_valid(const int16_t *words, int32_t count) {
  int32_t valid = 0;
  for (int32_t i = 0; i < count; ++i) valid += words[i] >= 0;
  return valid;
}

/* Bisection on the value instead of a sort: every pass is one branch-free count that the compiler vectorises, and
 * a cell's disparities span few bits. Invalid words are negative, so they only shift the rank. */
int16_t vista_median_word(const int16_t *words, int32_t count, int32_t valid) {
  const int32_t rank = count - valid + (valid + 1) / 2; /* 1-based */
  int16_t low = 0, high = 0;
  for (int32_t i = 0; i < count; ++i) high = words[i] > high ? words[i] : high;
  while (low < high) {
    const int16_t middle = (int16_t)((low + high) / 2);
    int32_t not_above = 0;
    for (int32_t i = 0; i < count; ++i) not_above += words[i] <= middle;
    if (not_above >= rank)
      high = middle;
    else
      low = (int16_t)(middle + 1);
  }
  return low;
}
