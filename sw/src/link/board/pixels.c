#include "link/board/pixels.h"

#include <string.h>

#include "link/board/request.h"

typedef struct sending {
  uint32_t frame;
  const raw_pair *pair;
  int64_t pixels;
  int32_t chunks, next; /* chunk to look at next */
} sending;

static bool has(const vista_board *board, int32_t chunk) { return board->status.bitmap[chunk / 32] >> chunk % 32 & 1u; }

/* What was sent before the token of the newest status and has not arrived is lost. */
static bool is_due(const vista_board *board, int32_t chunk) {
  const uint32_t sent_as = board->sent_as[chunk];
  return !has(board, chunk) && (sent_as == 0 || token_reached(sent_as, board->status.token));
}

/* The next chunk that has to be sent, from s->next on and then from the first one on; -1: none at the moment. */
static int32_t next_due(const vista_board *board, const sending *s) {
  for (int32_t i = 0; i < s->chunks; i++) {
    const int32_t chunk = (s->next + i) % s->chunks;
    if (is_due(board, chunk)) return chunk;
  }
  return -1;
}

static void put_pixels(vista_board *board, const sending *s, int32_t chunk) {
  const int64_t width = board->layout.level[0].width_px, first = (int64_t)chunk * CHUNK_PIXELS;
  const int64_t left_over = s->pixels - first, count = left_over < CHUNK_PIXELS ? left_over : CHUNK_PIXELS;
  uint8_t *out = board->out.bytes + (size_t)4 * WIRE_HEADER_WORDS;
  int64_t x = first % width;
  ptrdiff_t row = (ptrdiff_t)(first / width) * s->pair->stride;
  for (int64_t i = 0; i < count; i++) {
    *out++ = s->pair->left[row + x];
    *out++ = s->pair->right[row + x];
    if (++x == width) x = 0, row += s->pair->stride;
  }
}

static void send_chunk(vista_board *board, const sending *s, int32_t chunk, bool ask) {
  connection_begin(board, WIRE_REQUEST_PIXELS, s->frame, CHUNK_WORDS);
  packet_set_field(&board->out, 0, WIRE_HEADER_FLAGS, ask);
  packet_set_field(&board->out, 0, WIRE_HEADER_INDEX, (uint32_t)chunk);
  packet_set_field(&board->out, 0, WIRE_HEADER_COUNT, CHUNK_WORDS);
  put_pixels(board, s, chunk);
  connection_send(board);
}

/* Sends what is due while there are credits, and asks for a status halfway and at the end. */
static void send_burst(vista_board *board, sending *s) {
  const uint32_t credits = board->status.credits, half = credits > 1 ? credits / 2 : 1;
  uint32_t on_the_way = board->token - board->status.token;
  int32_t chunk = next_due(board, s);
  while (chunk >= 0 && on_the_way < credits) {
    const int32_t now = chunk;
    board->counts.chunks_sent++;
    board->counts.chunks_sent_again += board->sent_as[now] != 0;
    board->sent_as[now] = connection_next_token(board->token);
    s->next = (now + 1) % s->chunks;
    chunk = next_due(board, s);
    on_the_way++;
    send_chunk(board, s, now, chunk < 0 || on_the_way == credits || on_the_way % half == 0);
  }
}

vista_status pixels_send(vista_board *board, uint32_t frame, const raw_pair *pair) {
  const level_layout *const image = &board->layout.level[0];
  const slot_status *const slot = &board->status.slot[frame % WIRE_SLOTS];
  sending s = {.frame = frame, .pair = pair, .pixels = (int64_t)image->width_px * image->height_px};
  s.chunks = (int32_t)((s.pixels + CHUNK_PIXELS - 1) / CHUNK_PIXELS);
  memset(board->sent_as, 0, sizeof board->sent_as);
  int64_t silent_since_ns = connection_now_ns(), came_ns = silent_since_ns;
  uint32_t came = 0; /* chunks, and when there were more than before */
  while (slot->frame == frame && slot->state == WIRE_STATE_FILLING) {
    if (slot->chunks != came) came = slot->chunks, came_ns = connection_now_ns();
    if (request_has_waited(board, came_ns)) return VISTA_ERROR_NO_ANSWER; /* it answers, and takes nothing */
    send_burst(board, &s);
    const vista_status status = request_wait(board, &silent_since_ns);
    if (status == VISTA_ERROR_ORDER) {
      connection_begin(board, WIRE_REQUEST_STATUS, frame, 0);
      connection_send(board);
    } else if (status != VISTA_OK) {
      return status;
    }
  }
  return slot->frame == frame ? VISTA_OK : VISTA_ERROR_SESSION;
}
