#include "link/board/request.h"

enum { FIRST_RETRY_MS = 20, LAST_RETRY_MS = 1000 };

static int32_t at_most(int32_t a, int64_t b) { return a < b ? a : (int32_t)b; }

bool request_has_waited(const vista_board *board, int64_t since_ns) {
  return connection_now_ns() - since_ns >= (int64_t)board->timeout_ms * 1000000;
}

vista_status request_wait(vista_board *board, int64_t *silent_since_ns) {
  const int64_t silent_ms = (connection_now_ns() - *silent_since_ns) / 1000000;
  if (silent_ms >= board->timeout_ms) return VISTA_ERROR_NO_ANSWER;
  const vista_status status = connection_receive(board, at_most(board->retry_ms, board->timeout_ms - silent_ms));
  if (status == VISTA_ERROR_NO_ANSWER) {
    board->retry_ms = at_most(LAST_RETRY_MS, (int64_t)2 * board->retry_ms);
    board->counts.retries++;
    return VISTA_ERROR_ORDER;
  }
  if (status != VISTA_OK) return status;
  *silent_since_ns = connection_now_ns();
  if (packet_field(&board->in, 0, WIRE_HEADER_TOKEN) == board->token) { /* else it may answer an earlier one */
    const int64_t trip_ms = (*silent_since_ns - board->sent_ns) / 1000000;
    board->retry_ms = at_most(LAST_RETRY_MS, FIRST_RETRY_MS + 2 * trip_ms);
  }
  const board_status *const known = &board->status;
  const bool other = known->session != board->session && token_reached(board->session_token, known->token);
  return board->session != 0 && other ? VISTA_ERROR_SESSION : VISTA_OK;
}

vista_status request_reply(vista_board *board, uint32_t kind) {
  const uint32_t first = connection_next_token(board->token);
  int64_t silent_since_ns = connection_now_ns();
  vista_status status = VISTA_ERROR_ORDER;
  for (;;) {
    if (status == VISTA_ERROR_ORDER) connection_send(board);
    status = request_wait(board, &silent_since_ns);
    if (status != VISTA_OK && status != VISTA_ERROR_ORDER) return status;
    const packet *const in = &board->in;
    if (status == VISTA_OK && packet_field(in, 0, WIRE_HEADER_KIND) == kind &&
        token_reached(first, packet_field(in, 0, WIRE_HEADER_TOKEN)))
      return VISTA_OK;
  }
}

vista_status request_status(vista_board *board, uint32_t frame) {
  connection_begin(board, WIRE_REQUEST_STATUS, frame, 0);
  return request_reply(board, WIRE_REPLY_STATUS);
}

vista_status request_release(vista_board *board, uint32_t frame) {
  connection_begin(board, WIRE_REQUEST_RELEASE, frame, 0);
  return request_reply(board, WIRE_REPLY_STATUS);
}

vista_status request_slot(vista_board *board, uint32_t frame) {
  const slot_status *const slot = &board->status.slot[frame % WIRE_SLOTS];
  const int64_t begin_ns = connection_now_ns();
  vista_status status = request_status(board, frame);
  while (status == VISTA_OK && slot->frame != frame) {
    if (!token_reached(slot->frame, frame)) return VISTA_ERROR_SESSION; /* somebody else uses it */
    if (request_has_waited(board, begin_ns)) return VISTA_ERROR_FRAME; /* the engine works at it for too long */
    status = request_release(board, slot->frame);
  }
  return status;
}

vista_status request_read(vista_board *board, uint32_t address, uint32_t *values, int32_t count) {
  connection_begin(board, WIRE_REQUEST_READ, 0, 0);
  packet_set_field(&board->out, 0, WIRE_HEADER_INDEX, address);
  packet_set_field(&board->out, 0, WIRE_HEADER_COUNT, (uint32_t)count);
  const vista_status status = request_reply(board, WIRE_REPLY_VALUES);
  if (status != VISTA_OK) return status;
  const packet *const in = &board->in;
  if (packet_field(in, 0, WIRE_HEADER_COUNT) != (uint32_t)count) return VISTA_ERROR_BOARD;
  for (int32_t i = 0; i < count; i++) values[i] = packet_word(in, WIRE_HEADER_WORDS + i);
  return VISTA_OK;
}

vista_status request_write(vista_board *board, uint32_t address, const uint32_t *values, int32_t count) {
  board->writes++;
  connection_begin(board, WIRE_REQUEST_WRITE, board->writes, count);
  packet_set_field(&board->out, 0, WIRE_HEADER_INDEX, address);
  packet_set_field(&board->out, 0, WIRE_HEADER_COUNT, (uint32_t)count);
  for (int32_t i = 0; i < count; i++) packet_set_word(&board->out, WIRE_HEADER_WORDS + i, values[i]);
  const vista_status status = request_reply(board, WIRE_REPLY_STATUS);
  return status != VISTA_OK || board->status.last_write == board->writes ? status : VISTA_ERROR_SESSION;
}
