/* Sends pairs: in chunks, as many ahead as the board has room for, those that did not arrive once more. */
#ifndef VISTA_BOARD_PIXELS_H
#define VISTA_BOARD_PIXELS_H

#include "link/board/connection.h"

typedef struct raw_pair {
  const uint8_t *left, *right;
  ptrdiff_t stride;
} raw_pair;

/* Sends the pair as this frame, whose slot waits for it, until the board has all of it. */
vista_status pixels_send(vista_board *board, uint32_t frame, const raw_pair *pair);

#endif
