/* Engine words in blocks of a fixed length, internal to libvista. The pixels of a cell are short runs of a row, about
 * nine long: a loop over a run is hardly ever worth a vector, one over a block that covers the run and counts only its
 * pixels is vectors throughout. */
#ifndef VISTA_SRC_WORD_BLOCKS_H
#define VISTA_SRC_WORD_BLOCKS_H

#include <stdint.h>

#include "vista/types.h"

#define VISTA_WORD_BLOCK 16

/* The block that starts with *words, of which `room` are left in the row: where they are or, at the end of the row, in
 * `copy`, with invalid ones behind. */
static inline const int16_t *vista_word_block(const int16_t *words, int32_t room, int16_t copy[VISTA_WORD_BLOCK]) {
  if (room >= VISTA_WORD_BLOCK) return words;
  for (int32_t i = 0; i < VISTA_WORD_BLOCK; ++i) copy[i] = i < room ? words[i] : VISTA_DISPARITY_INVALID;
  return copy;
}

#endif
