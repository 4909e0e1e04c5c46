#define _POSIX_C_SOURCE 200809L
#include "link/board/words.h"

#include <string.h>
#include <time.h>

#include "link/board/request.h"

enum {
  FETCH_CHUNKS = 32,   /* less than what the system holds for a socket that nobody reads for a moment */
  PAUSE_NS = 200000,   /* between two questions whether a frame is done */
};

typedef struct fetching {
  uint32_t frame;
  int16_t *words;
  int64_t pairs;
  int64_t begin_ns;
  int32_t chunks, first, count; /* asked for last: count chunks from `first` on */
} fetching;

/* The first chunk that is missing, and how many are missing there; false: none. */
static bool next_part(const vista_board *board, fetching *f) {
  while (f->first < f->chunks && board->received[f->first]) f->first++;
  f->count = 0;
  while (f->count < FETCH_CHUNKS && f->first + f->count < f->chunks && !board->received[f->first + f->count])
    f->count++;
  return f->count > 0;
}

static void ask(vista_board *board, const fetching *f) {
  connection_begin(board, WIRE_REQUEST_FETCH, f->frame, 0);
  packet_set_field(&board->out, 0, WIRE_HEADER_INDEX, (uint32_t)f->first);
  packet_set_field(&board->out, 0, WIRE_HEADER_COUNT, (uint32_t)f->count);
  connection_send(board);
}

/* Whether a chunk of that many words is the one that the board made of this frame. */
static bool is_checked(const vista_board *board, const fetching *f, int32_t chunk, int64_t count) {
  uint32_t check = board->session ^ f->frame ^ (uint32_t)chunk << 16;
  for (int32_t i = 0; i < count; i++)
    check = (check << 1 | check >> 31) + packet_word(&board->in, WIRE_HEADER_WORDS + i);
  return check == packet_word(&board->in, WIRE_HEADER_WORDS + CHUNK_WORDS);
}

/* Takes over a chunk that came; whether it is the last one of those asked for, so that what is missing is lost. */
static bool take_chunk(vista_board *board, const fetching *f) {
  const packet *const in = &board->in;
  const int32_t chunk = (int32_t)packet_field(in, 0, WIRE_HEADER_INDEX);
  if (packet_field(in, 0, WIRE_HEADER_FRAME) != f->frame || chunk >= f->chunks ||
      !token_reached(board->session_token, packet_field(in, 0, WIRE_HEADER_TOKEN)))
    return false; /* of a frame before, or of another session's */
  board->counts.chunks_received++;
  board->counts.chunks_received_again += board->received[chunk];
  const int64_t first = (int64_t)chunk * CHUNK_WORDS, left_over = f->pairs - first;
  const int64_t count = left_over < CHUNK_WORDS ? left_over : CHUNK_WORDS;
  const bool checked = is_checked(board, f, chunk, count);
  if (checked && !board->received[chunk])
    frame_layout_unpack(&board->layout, first, count, in->bytes + (size_t)4 * WIRE_HEADER_WORDS, f->words);
  board->counts.chunks_wrong += !checked;
  board->received[chunk] |= checked;
  return packet_field(in, 0, WIRE_HEADER_TOKEN) == board->token && chunk == f->first + f->count - 1;
}

/* A status in place of words: the frame is not done. VISTA_ERROR_ORDER: ask again. */
static vista_status look_at_status(const vista_board *board, const fetching *f) {
  const slot_status *const slot = &board->status.slot[f->frame % WIRE_SLOTS];
  if (slot->frame != f->frame || slot->state == WIRE_STATE_FILLING) return VISTA_ERROR_SESSION;
  if (slot->state == WIRE_STATE_FAILED || request_has_waited(board, f->begin_ns)) return VISTA_ERROR_FRAME;
  const struct timespec pause = {.tv_nsec = PAUSE_NS};
  nanosleep(&pause, NULL);
  return VISTA_ERROR_ORDER;
}

/* Waits until the part that was asked for has come, or has to be asked for again: VISTA_OK. */
static vista_status receive_part(vista_board *board, const fetching *f, int64_t *silent_since_ns) {
  vista_status status = VISTA_OK;
  while (status == VISTA_OK) {
    status = request_wait(board, silent_since_ns);
    if (status != VISTA_OK) break;
    const uint32_t kind = packet_field(&board->in, 0, WIRE_HEADER_KIND);
    if (kind == WIRE_REPLY_WORDS && take_chunk(board, f)) return VISTA_OK;
    if (kind == WIRE_REPLY_STATUS && packet_field(&board->in, 0, WIRE_HEADER_TOKEN) == board->token)
      status = look_at_status(board, f);
  }
  return status == VISTA_ERROR_ORDER ? VISTA_OK : status;
}

vista_status words_fetch(vista_board *board, uint32_t frame, int16_t *words) {
  fetching f = {.frame = frame, .words = words, .pairs = board->layout.pairs, .begin_ns = connection_now_ns()};
  f.chunks = (int32_t)((f.pairs + CHUNK_WORDS - 1) / CHUNK_WORDS);
  memset(board->received, 0, sizeof board->received);
  frame_layout_fill_unsent(&board->layout, words);
  int64_t silent_since_ns = f.begin_ns;
  vista_status status = VISTA_OK;
  while (status == VISTA_OK && next_part(board, &f)) {
    ask(board, &f);
    const int64_t wrong = board->counts.chunks_wrong;
    status = receive_part(board, &f, &silent_since_ns);
    if (status == VISTA_OK && board->counts.chunks_wrong > wrong && request_has_waited(board, f.begin_ns))
      status = VISTA_ERROR_FRAME;
  }
  return status;
}
