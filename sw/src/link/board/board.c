#define _POSIX_C_SOURCE 200809L
#include "vista/board.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <stdalign.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "link/board/connection.h"
#include "link/board/pixels.h"
#include "link/board/request.h"
#include "link/board/session.h"
#include "link/board/stream.h"
#include "link/board/words.h"

_Static_assert(VISTA_BOARD_PORT == WIRE_PORT, "rtl/board/wire.toml");
_Static_assert(VISTA_BOARD_FRAMES == WIRE_SLOTS, "rtl/board/wire.toml");

enum { FIRST_RETRY_MS = 20, MAX_PORT = 65535 };

size_t vista_board_bytes(void) { return sizeof(vista_board) + alignof(vista_board) - 1; }

/* A socket that speaks with nobody but this host; -1: none. */
static int open_socket(const char *host, int32_t port) {
  struct sockaddr_in to = {.sin_family = AF_INET, .sin_port = htons((uint16_t)port)};
  if (inet_pton(AF_INET, strcmp(host, "localhost") == 0 ? "127.0.0.1" : host, &to.sin_addr) != 1) return -1;
  const int fd = socket(AF_INET, SOCK_DGRAM, 0);
  if (fd < 0 || connect(fd, (const struct sockaddr *)&to, sizeof to) == 0) return fd;
  close(fd);
  return -1;
}

vista_status vista_board_connect(void *memory, size_t bytes, const char *host, int32_t port, int32_t timeout_ms,
                                 vista_board **board) {
  if (!memory || !host || !board) return VISTA_ERROR_ARGUMENT;
  if (port < 1 || port > MAX_PORT || timeout_ms < 1) return VISTA_ERROR_RANGE;
  const size_t skip = (size_t)-(uintptr_t)memory % alignof(vista_board);
  if (bytes < skip + sizeof(vista_board)) return VISTA_ERROR_MEMORY;
  vista_board *const made = (vista_board *)(void *)((char *)memory + skip);
  memset(made, 0, sizeof *made);
  made->timeout_ms = timeout_ms;
  made->retry_ms = FIRST_RETRY_MS;
  made->socket = open_socket(host, port);
  if (made->socket < 0) return VISTA_ERROR_ADDRESS;
  const vista_status status = request_status(made, 0);
  if (status != VISTA_OK) {
    vista_board_disconnect(made);
    return status;
  }
  *board = made;
  return VISTA_OK;
}

void vista_board_disconnect(vista_board *board) {
  if (!board) return;
  session_close(board);
  close(board->socket);
}

vista_status vista_board_identify(vista_board *board, vista_board_build *build) {
  return board && build ? session_identify(board, build) : VISTA_ERROR_ARGUMENT;
}

vista_status vista_board_configure(vista_board *board, const vista_board_settings *settings) {
  if (!board || !settings) return VISTA_ERROR_ARGUMENT;
  vista_board_build build;
  board->session = 0; /* any status is welcome */
  vista_status status = session_identify(board, &build);
  if (status == VISTA_OK) status = session_check(settings, &build);
  if (status != VISTA_OK) return status;
  board->layout = frame_layout_of(settings->width_px, settings->height_px, settings->levels);
  status = session_open(board, settings);
  if (status == VISTA_OK) status = session_set_up(board, settings);
  if (status != VISTA_OK) board->session = 0;
  return status;
}

int64_t vista_board_words(const vista_board *board) { return board && board->session != 0 ? board->layout.words : 0; }

vista_status vista_board_submit(vista_board *board, const uint8_t *left, const uint8_t *right, ptrdiff_t stride) {
  if (!board || !left || !right) return VISTA_ERROR_ARGUMENT;
  if (board->session == 0) return VISTA_ERROR_SESSION;
  if (board->cameras) return VISTA_ERROR_ORDER;
  if (stride < board->layout.level[0].width_px) return VISTA_ERROR_SIZE;
  if (board->waiting_count == WIRE_SLOTS) return VISTA_ERROR_CAPACITY;
  const uint32_t frame = board->next_frame;
  const raw_pair pair = {left, right, stride};
  vista_status status = request_slot(board, frame);
  if (status == VISTA_OK) status = pixels_send(board, frame, &pair);
  /* The number is used up: chunks of a lost frame may still be on their way. The next one takes the same slot, the
   * other may be in use. */
  board->next_frame += status == VISTA_OK ? 1 : WIRE_SLOTS;
  if (status == VISTA_OK)
    board->waiting[board->waiting_count++] = frame;
  else
    board->counts.lost++;
  return status;
}

vista_status vista_board_collect(vista_board *board, int16_t *words, int64_t word_count) {
  if (!board || !words) return VISTA_ERROR_ARGUMENT;
  if (board->session == 0) return VISTA_ERROR_SESSION;
  if (board->waiting_count == 0) return VISTA_ERROR_ORDER;
  if (word_count < board->layout.words) return VISTA_ERROR_MEMORY;
  const vista_status status = words_fetch(board, board->waiting[0], words);
  board->waiting_count--;
  memmove(board->waiting, board->waiting + 1, (size_t)board->waiting_count * sizeof board->waiting[0]);
  if (status == VISTA_OK)
    board->counts.frames++;
  else
    board->counts.lost++;
  return status;
}

vista_status vista_board_start(vista_board *board) { return board ? stream_switch(board, true) : VISTA_ERROR_ARGUMENT; }

vista_status vista_board_stop(vista_board *board) { return board ? stream_switch(board, false) : VISTA_ERROR_ARGUMENT; }

vista_status vista_board_receive(vista_board *board, int16_t *words, int64_t word_count, vista_board_pair *pair) {
  if (!board || !words || !pair) return VISTA_ERROR_ARGUMENT;
  if (board->session == 0) return VISTA_ERROR_SESSION;
  if (!board->cameras) return VISTA_ERROR_ORDER;
  if (word_count < board->layout.words) return VISTA_ERROR_MEMORY;
  return stream_receive(board, words, pair);
}

vista_board_counts vista_board_count(const vista_board *board) {
  return board ? board->counts : (vista_board_counts){0};
}
