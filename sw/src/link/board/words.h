/* Receives the words of a frame: asks for them in parts, and again for those that did not arrive. */
#ifndef VISTA_BOARD_WORDS_H
#define VISTA_BOARD_WORDS_H

#include "link/board/connection.h"

/* All words of this frame, as vista_board_collect gives them; waits until the engine has them. */
vista_status words_fetch(vista_board *board, uint32_t frame, int16_t *words);

#endif
