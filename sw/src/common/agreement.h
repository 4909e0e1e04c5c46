/* Words that another one agrees with: by chance the engine finds a disparity almost anywhere, but not the same one,
 * within a pixel, a matching block further to the left or to the right; on a surface it mostly does. */
#ifndef VISTA_SRC_AGREEMENT_H
#define VISTA_SRC_AGREEMENT_H

#include <stdint.h>
#include <stdlib.h>

#include "common/matched_area.h"
#include "vista/word.h"

/* Columns between two words that share no matching block. */
static inline int32_t vista_agreement_distance(const vista_matched_area *area) {
  return 2 * (int32_t)area->margin_px + 2;
}

/* Two words of one surface: both valid, a pixel apart at most. */
static inline int32_t vista_words_alike(int32_t a, int32_t b) {
  return (b >= 0) & (abs(a - b) <= VISTA_DISPARITY_SCALE);
}

/* Whether the word in column u is valid and one at the distance on either side agrees; 0 or 1. The row reaches that far
 * to both sides. */
static inline int32_t vista_word_agrees(const int16_t *words, int32_t u, int32_t distance) {
  return (words[u] >= 0) &
         (vista_words_alike(words[u], words[u - distance]) | vista_words_alike(words[u], words[u + distance]));
}

#endif
