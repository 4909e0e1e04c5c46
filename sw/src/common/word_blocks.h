/* Engine words in blocks of a fixed length, internal to libvista. The pixels of a cell are short runs of a row, about
 * nine long: a loop over a run is hardly ever worth a vector, one over a block that covers the run and counts only its
 * pixels is vectors throughout. */
#ifndef VISTA_SRC_WORD_BLOCKS_H
#define VISTA_SRC_WORD_BLOCKS_H

#include <stdint.h>

#include "vista/types.h"

#define VISTA_WORD_BLOCK 16

/* Stands before a loop over a block: GCC unrolls so short a loop, and then finds no vector in it. */
#if defined(__GNUC__) && !defined(__clang__)
#define VISTA_BLOCK_LOOP _Pragma("GCC unroll 1")
#else
#define VISTA_BLOCK_LOOP
#endif

/* The words u .. u + VISTA_WORD_BLOCK - 1 of a row: where they are or, where the row does not reach so far, in `copy`,
 * with invalid ones outside it. */
static inline const int16_t *vista_word_block(const int16_t *row, int32_t u, int32_t width,
                                              int16_t copy[VISTA_WORD_BLOCK]) {
  if (u >= 0 && u + VISTA_WORD_BLOCK <= width) return row + u;
  VISTA_BLOCK_LOOP
  for (int32_t i = 0; i < VISTA_WORD_BLOCK; ++i)
    copy[i] = u + i >= 0 && u + i < width ? row[u + i] : VISTA_DISPARITY_INVALID;
  return copy;
}

#endif
