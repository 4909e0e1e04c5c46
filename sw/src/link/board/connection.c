#define _POSIX_C_SOURCE 200809L
#include "link/board/connection.h"

#include <poll.h>
#include <string.h>
#include <sys/socket.h>
#include <time.h>

int64_t connection_now_ns(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (int64_t)now.tv_sec * 1000000000 + now.tv_nsec;
}

uint32_t connection_next_token(uint32_t token) { return token + 1 == 0 ? 1 : token + 1; }

uint32_t packet_word(const packet *p, int32_t index) {
  const uint8_t *const b = p->bytes + (ptrdiff_t)4 * index;
  return b[0] | (uint32_t)b[1] << 8 | (uint32_t)b[2] << 16 | (uint32_t)b[3] << 24;
}

void packet_set_word(packet *p, int32_t index, uint32_t value) {
  for (int32_t i = 0; i < 4; i++) p->bytes[4 * index + i] = (uint8_t)(value >> 8 * i);
}

static int32_t field_word(uint32_t field) { return (int32_t)(field >> 8 & 0xFF); }

static uint32_t field_mask(uint32_t field) { return 0xFFFFFFFFu >> (32 - (field >> 16)); }

uint32_t packet_field(const packet *p, int32_t first_word, uint32_t field) {
  return packet_word(p, first_word + field_word(field)) >> (field & 0xFF) & field_mask(field);
}

void packet_set_field(packet *p, int32_t first_word, uint32_t field, uint32_t value) {
  const int32_t index = first_word + field_word(field);
  const uint32_t low = field & 0xFF, others = packet_word(p, index) & ~(field_mask(field) << low);
  packet_set_word(p, index, others | (value & field_mask(field)) << low);
}

void connection_begin(vista_board *board, uint32_t kind, uint32_t frame, int32_t payload_words) {
  packet *const out = &board->out;
  out->words = WIRE_HEADER_WORDS + payload_words;
  memset(out->bytes, 0, (size_t)out->words * 4);
  packet_set_field(out, 0, WIRE_HEADER_KIND, kind);
  packet_set_field(out, 0, WIRE_HEADER_VERSION, WIRE_VERSION);
  packet_set_field(out, 0, WIRE_HEADER_MAGIC, WIRE_MAGIC);
  packet_set_field(out, 0, WIRE_HEADER_SESSION, board->session);
  packet_set_field(out, 0, WIRE_HEADER_FRAME, frame);
}

void connection_send(vista_board *board) {
  board->token = connection_next_token(board->token);
  packet_set_field(&board->out, 0, WIRE_HEADER_TOKEN, board->token);
  (void)!send(board->socket, board->out.bytes, (size_t)board->out.words * 4, 0);
  board->sent_ns = connection_now_ns();
}

/* Events since the status before, of a counter that goes round. */
static int64_t refused_since(uint32_t now, uint32_t before) { return (uint16_t)(now - before); }

static void take_status(vista_board *board) {
  const packet *const in = &board->in;
  board_status *const status = &board->status;
  const int32_t body = WIRE_HEADER_WORDS;
  status->token = packet_field(in, 0, WIRE_HEADER_TOKEN);
  status->session = packet_field(in, 0, WIRE_HEADER_SESSION);
  status->frame = packet_field(in, 0, WIRE_HEADER_FRAME);
  status->credits = packet_field(in, body, WIRE_STATUS_CREDITS);
  status->cameras = packet_field(in, body, WIRE_STATUS_CAMERAS);
  status->busy = packet_field(in, body, WIRE_STATUS_BUSY);
  status->held = packet_field(in, body, WIRE_STATUS_HELD);
  status->last_write = packet_field(in, body, WIRE_STATUS_LAST_WRITE);
  const uint32_t left = packet_field(in, body, WIRE_STATUS_REFUSED_LEFT);
  const uint32_t right = packet_field(in, body, WIRE_STATUS_REFUSED_RIGHT);
  if (board->session != 0 && status->session == board->session) {
    board->counts.refused_left += refused_since(left, status->refused_left);
    board->counts.refused_right += refused_since(right, status->refused_right);
  }
  const uint32_t now = packet_field(in, body, WIRE_STATUS_NOW);
  /* A session goes on counting where the board's counter goes round; each begins where that is. */
  const int64_t passed_us = (int32_t)(now - (uint32_t)status->now_us);
  status->now_us = board->session != 0 ? status->now_us + passed_us : (int64_t)now;
  status->came_ns = connection_now_ns();
  status->refused_left = left;
  status->refused_right = right;
  for (uint32_t s = 0; s < WIRE_SLOTS; s++) {
    const uint32_t next = (WIRE_STATUS_SLOT_1_FRAME - WIRE_STATUS_SLOT_0_FRAME) * s;
    status->slot[s].frame = packet_field(in, body, WIRE_STATUS_SLOT_0_FRAME + next);
    status->slot[s].state = packet_field(in, body, WIRE_STATUS_SLOT_0_STATE + next);
    status->slot[s].chunks = packet_field(in, body, WIRE_STATUS_SLOT_0_CHUNKS + next);
    const uint32_t began = (WIRE_STATUS_SLOT_1_BEGAN - WIRE_STATUS_SLOT_0_BEGAN) * s + WIRE_STATUS_SLOT_0_BEGAN;
    status->slot[s].began_us = status->now_us - (int64_t)(now - packet_field(in, body, began));
  }
  for (int32_t i = 0; i < BITMAP_WORDS; i++) status->bitmap[i] = packet_word(in, body + WIRE_STATUS_WORDS + i);
}

/* Words that a reply has at least, header included; 0: no reply. */
static int32_t least_words(const packet *in) {
  const int32_t count = (int32_t)packet_field(in, 0, WIRE_HEADER_COUNT);
  switch (packet_field(in, 0, WIRE_HEADER_KIND)) {
    case WIRE_REPLY_STATUS:
      return WIRE_HEADER_WORDS + WIRE_STATUS_WORDS + BITMAP_WORDS;
    case WIRE_REPLY_VALUES:
      return WIRE_HEADER_WORDS + count;
    case WIRE_REPLY_WORDS:
      return PACKET_WORDS;
    default:
      return 0;
  }
}

/* Whether board->in answers a request of ours. */
static bool is_answer(const vista_board *board) {
  const packet *const in = &board->in;
  if (in->words < WIRE_HEADER_WORDS || packet_field(in, 0, WIRE_HEADER_MAGIC) != WIRE_MAGIC) return false;
  const int32_t least = least_words(in);
  return least > 0 && in->words >= least && token_reached(packet_field(in, 0, WIRE_HEADER_TOKEN), board->token);
}

vista_status connection_receive(vista_board *board, int32_t wait_ms) {
  const int64_t until_ns = connection_now_ns() + (int64_t)wait_ms * 1000000;
  for (;;) {
    const int64_t left_ns = until_ns - connection_now_ns();
    struct pollfd ready = {.fd = board->socket, .events = POLLIN};
    const int found = poll(&ready, 1, left_ns > 0 ? (int)((left_ns + 999999) / 1000000) : 0);
    if (found == 0) return VISTA_ERROR_NO_ANSWER;
    const ssize_t bytes = recv(board->socket, board->in.bytes, sizeof board->in.bytes, MSG_DONTWAIT);
    if (bytes < 0) { /* interrupted, or nobody listens there at the moment */
      if (left_ns <= 0) return VISTA_ERROR_NO_ANSWER;
      continue;
    }
    board->in.words = (int32_t)(bytes / 4);
    if (!is_answer(board)) { /* a stream of these holds nobody up */
      if (left_ns <= 0) return VISTA_ERROR_NO_ANSWER;
      continue;
    }
    if (packet_field(&board->in, 0, WIRE_HEADER_VERSION) != WIRE_VERSION) return VISTA_ERROR_BOARD;
    const uint32_t token = packet_field(&board->in, 0, WIRE_HEADER_TOKEN);
    if (packet_field(&board->in, 0, WIRE_HEADER_KIND) == WIRE_REPLY_STATUS && token_reached(board->status.token, token))
      take_status(board);
    return VISTA_OK;
  }
}
