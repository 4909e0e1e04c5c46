#define _POSIX_C_SOURCE 200809L
#include "link/board/stream.h"

#include <stddef.h>
#include <time.h>

#include "link/board/request.h"
#include "link/board/session.h"
#include "link/board/words.h"

enum { PAUSE_NS = 200000 /* between two questions whether there is a frame */, NS_PER_US = 1000 };

vista_status stream_switch(vista_board *board, bool on) {
  if (board->session == 0) return VISTA_ERROR_SESSION;
  if (!board->cameras) return VISTA_ERROR_ORDER;
  const uint32_t value = on;
  const vista_status status = request_write(board, WIRE_CAMERAS, &value, 1);
  return status == VISTA_OK && !on ? session_wait_until_idle(board) : status;
}

static bool is_over(const slot_status *slot) {
  return slot->state == WIRE_STATE_DONE || slot->state == WIRE_STATE_FAILED;
}

/* The slot of the first frame that is over; null: there is none. */
static const slot_status *first_over(const board_status *status) {
  const slot_status *found = NULL;
  for (int32_t s = 0; s < WIRE_SLOTS; s++) {
    const slot_status *const slot = &status->slot[s];
    if (is_over(slot) && (!found || token_reached(slot->frame, found->frame))) found = slot;
  }
  return found;
}

/* Asks until a frame is over that was not seen before. One that was is still there if its release was not answered. */
static vista_status wait_for_frame(vista_board *board, slot_status *over) {
  const int64_t begin_ns = connection_now_ns();
  vista_status status = VISTA_OK;
  while (status == VISTA_OK) {
    const slot_status *const found = first_over(&board->status);
    if (found && token_reached(board->next_frame, found->frame)) {
      *over = *found;
      return VISTA_OK;
    }
    if (found) {
      status = request_release(board, found->frame);
      continue;
    }
    if (request_has_waited(board, begin_ns)) return VISTA_ERROR_FRAME;
    const struct timespec pause = {.tv_nsec = PAUSE_NS};
    nanosleep(&pause, NULL);
    status = request_status(board, 0);
  }
  return status;
}

vista_status stream_receive(vista_board *board, int16_t *words, vista_board_pair *pair) {
  slot_status over;
  vista_status status = wait_for_frame(board, &over);
  if (status != VISTA_OK) return status;
  const board_status *const known = &board->status;
  *pair = (vista_board_pair){.number = over.frame,
                             .t_ns = NS_PER_US * over.began_us,
                             .came_ns = known->came_ns - NS_PER_US * (known->now_us - over.began_us)};
  board->counts.lost += over.frame - board->next_frame;
  board->next_frame = over.frame + 1;
  status = over.state == WIRE_STATE_DONE ? words_fetch(board, over.frame, words) : VISTA_ERROR_FRAME;
  if (status == VISTA_OK)
    board->counts.frames++;
  else
    board->counts.lost++;
  if (status != VISTA_OK && status != VISTA_ERROR_FRAME) return status;
  const vista_status released = request_release(board, over.frame);
  return status == VISTA_OK ? released : status;
}
