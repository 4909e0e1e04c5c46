/* The pairs of a board's own cameras, which the board takes by itself. */
#ifndef VISTA_BOARD_STREAM_H
#define VISTA_BOARD_STREAM_H

#include "link/board/connection.h"

/* What vista_board_start and vista_board_stop do. */
vista_status stream_switch(vista_board *board, bool on);

/* Words of the next pair of the cameras, and what is known of it. Pairs before it that were not received are lost. */
vista_status stream_receive(vista_board *board, int16_t *words, vista_board_pair *pair);

#endif
