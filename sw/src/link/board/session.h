/* Settings of a session as the registers of the engine, which rtl/csr/registers.md describes. */
#ifndef VISTA_BOARD_SESSION_H
#define VISTA_BOARD_SESSION_H

#include "link/board/connection.h"

/* What vista_board_identify does. */
vista_status session_identify(vista_board *board, vista_board_build *build);

/* Whether the settings are in range, and fit this build. */
vista_status session_check(const vista_board_settings *settings, const vista_board_build *build);

/* Takes the board over for frames of board->layout. VISTA_ERROR_HELD: another client holds it. */
vista_status session_open(vista_board *board, const vista_board_settings *settings);

/* Asks for statuses until the engine has finished what it was at. */
vista_status session_wait_until_idle(vista_board *board);

/* Tells the board that nobody holds it any more; does not wait for an answer. */
void session_close(vista_board *board);

/* Writes the registers of an open session, and loads the map. */
vista_status session_set_up(vista_board *board, const vista_board_settings *settings);

#endif
