/* The state of a connection to a board, and the packets that go over it. Packets: rtl/board/wire.toml. */
#ifndef VISTA_BOARD_CONNECTION_H
#define VISTA_BOARD_CONNECTION_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "link/board/frame_layout.h"
#include "vista/board.h"
#include "wire.h"

enum {
  CHUNK_WORDS = WIRE_CHUNK_BYTES / 4,
  CHUNK_PIXELS = WIRE_CHUNK_BYTES / 2,
  BITMAP_WORDS = WIRE_MAX_CHUNKS_IN / 32,
  PACKET_WORDS = WIRE_HEADER_WORDS + CHUNK_WORDS + 1, /* the check of a chunk of words is the last */
};

/* A packet: the words of the header and of the payload, each in the order of bytes on the wire. */
typedef struct packet {
  uint8_t bytes[4 * PACKET_WORDS];
  int32_t words; /* header included */
} packet;

typedef struct slot_status {
  uint32_t frame, state, chunks;
  int64_t began_us; /* of the pair of the cameras, on the board's clock */
} slot_status;

/* The newest status that the board sent. */
typedef struct board_status {
  uint32_t token, session, credits, cameras, busy, held, last_write, refused_left, refused_right;
  slot_status slot[WIRE_SLOTS];
  uint32_t frame; /* that the bitmap is of */
  uint32_t bitmap[BITMAP_WORDS];
  int64_t now_us;  /* on the board's clock, which goes on where the counter of the board goes round */
  int64_t came_ns; /* when the status came, on the clock of this machine */
} board_status;

struct vista_board {
  int socket;
  int32_t timeout_ms, retry_ms;
  uint32_t token; /* of the packet sent last */
  int64_t sent_ns; /* when it was */
  uint32_t session; /* 0: none */
  uint32_t session_token; /* of the request that began it: older statuses tell of other sessions */
  uint32_t writes; /* of this session */
  uint32_t next_frame; /* to be submitted, or received from the cameras */
  uint32_t waiting[WIRE_SLOTS]; /* frames to be collected, the oldest first */
  int32_t waiting_count;
  bool cameras; /* the pairs of this session are those of the board's cameras */
  frame_layout layout; /* of this session */
  board_status status;
  packet out, in;
  uint32_t sent_as[WIRE_MAX_CHUNKS_IN]; /* token with which each chunk was sent last; 0: not sent */
  uint8_t received[WIRE_MAX_CHUNKS_OUT];
  vista_board_counts counts;
};

/* The number after `token`, never 0. */
uint32_t connection_next_token(uint32_t token);

/* Whether token a is not later than b. */
static inline bool token_reached(uint32_t a, uint32_t b) { return (int32_t)(b - a) >= 0; }

/* Word `index` of a packet, the header included. */
uint32_t packet_word(const packet *p, int32_t index);
void packet_set_word(packet *p, int32_t index, uint32_t value);

/* A field as wire.h names it: of the header, or of the payload, whose words begin at `first_word`. */
uint32_t packet_field(const packet *p, int32_t first_word, uint32_t field);
void packet_set_field(packet *p, int32_t first_word, uint32_t field, uint32_t value);

/* Begins board->out as a request of the present session with payload_words zeros. */
void connection_begin(vista_board *board, uint32_t kind, uint32_t frame, int32_t payload_words);

/* Sends board->out with a token of its own. What cannot be sent is lost, as on the wire. */
void connection_send(vista_board *board);

/* Waits for a packet up to wait_ms and puts it into board->in; a status is taken over into board->status if it is not
 * older than that. Anything else than an answer to one of our requests is skipped.
 *
 * VISTA_ERROR_NO_ANSWER: nothing came. VISTA_ERROR_BOARD: another version of the protocol. */
vista_status connection_receive(vista_board *board, int32_t wait_ms);

int64_t connection_now_ns(void);

#endif
