/* Exact order statistics of engine words (1/16 px, negative = invalid), internal to libvista. */
#ifndef VISTA_SRC_MEDIAN_H
#define VISTA_SRC_MEDIAN_H

#include <stdint.h>

/* How many of the words are valid. */
int32_t vista_count_valid(const int16_t *words, int32_t count);

/* How many of some words are valid, and from where to where they reach; least > most without any. */
typedef struct vista_word_range {
  int32_t valid;
  int16_t least, most;
} vista_word_range;

vista_word_range vista_range_of_words(const int16_t *words, int32_t count);

/* The same, and the lower median of the valid ones, if there are any. */
typedef struct vista_words_median {
  vista_word_range range;
  int16_t word;
} vista_words_median;

#define VISTA_MEDIAN_LANES 16

/* scratch: room for `count` words and VISTA_MEDIAN_LANES more. */
vista_words_median vista_median_word(const int16_t *words, int32_t count, int16_t *scratch);

vista_words_median vista_median_of_four(const int16_t words[4]);

#endif
