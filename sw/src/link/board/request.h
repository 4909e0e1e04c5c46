/* Requests that are repeated until they are answered. */
#ifndef VISTA_BOARD_REQUEST_H
#define VISTA_BOARD_REQUEST_H

#include "link/board/connection.h"

/* Sends board->out, again and again, until a reply of this kind to it has come, or the board has been silent for the
 * agreed time: VISTA_ERROR_NO_ANSWER. In place of the reply a status may come that tells of another session:
 * VISTA_ERROR_SESSION. */
vista_status request_reply(vista_board *board, uint32_t kind);

/* Waits once for a packet, as long as it pays before the request is repeated. A request that was not answered is
 * repeated later each time. silent_since_ns: when the board was heard last, or the wait began.
 *
 * VISTA_OK: board->in holds a packet. VISTA_ERROR_NO_ANSWER: silent for the agreed time. VISTA_ERROR_ORDER: nothing yet,
 * repeat the request. VISTA_ERROR_SESSION: a status tells of another session. */
vista_status request_wait(vista_board *board, int64_t *silent_since_ns);

/* Whether the agreed time has passed since then. */
bool request_has_waited(const vista_board *board, int64_t since_ns);

/* A status with the bitmap of this frame. */
vista_status request_status(vista_board *board, uint32_t frame);

/* Tells the board that nobody needs a frame any more; the answer is a status. */
vista_status request_release(vista_board *board, uint32_t frame);

/* Gives up frames until the slot of `frame` waits for it. */
vista_status request_slot(vista_board *board, uint32_t frame);

/* `count` registers from this address on, at most CHUNK_WORDS. */
vista_status request_read(vista_board *board, uint32_t address, uint32_t *values, int32_t count);

/* Values, at most CHUNK_WORDS, one after the other into one register: each exactly once. */
vista_status request_write(vista_board *board, uint32_t address, const uint32_t *values, int32_t count);

#endif
