/* Exact order statistics of engine words (1/16 px, negative = invalid), internal to libvista. */
#ifndef VISTA_SRC_MEDIAN_H
#define VISTA_SRC_MEDIAN_H

#include <stdint.h>

/* How many of the words are valid. */
int32_t vista_count_valid(const int16_t *words, int32_t count);

#define VISTA_WORD_LANES 8

/* Fills the vector after the last word with invalid ones, so that loops over whole vectors need no remainder. */
void vista_words_pad(int16_t *words, int32_t count);

/* Lower median of the valid words; `valid` of the `count` words are, at least 1. The words are padded. */
int16_t vista_median_word(const int16_t *words, int32_t count, int32_t valid);

#endif
