/* A stereo engine on a board, reached over UDP: raw pairs go out, or are those of the board's own cameras; the
 * disparities of all levels come back.
 *
 *   vista_board *board;
 *   vista_board_connect(memory, vista_board_bytes(), "192.168.1.50", VISTA_BOARD_PORT, 2000, &board);
 *   vista_board_configure(board, &settings);
 *   for each pair:
 *     vista_board_submit(board, left, right, settings.width_px);
 *     vista_board_collect(board, words, word_count);
 *   vista_board_disconnect(board);
 *
 * With settings.cameras, in place of submit and collect:
 *
 *   vista_board_start(board);
 *   for each pair of the cameras: vista_board_receive(board, words, word_count, &pair);
 *   vista_board_stop(board);
 *
 * Packets that are lost are sent again, those that come twice are recognised. A function that hears nothing from the
 * board for the agreed time returns VISTA_ERROR_NO_ANSWER; its frame is lost then, and the next one can be submitted as
 * if nothing had happened. A board is used by one thread at a time. Only connecting allocates memory. */
#ifndef VISTA_BOARD_H
#define VISTA_BOARD_H

#include <stddef.h>
#include <stdint.h>

#include "vista/api.h"
#include "vista/status.h"

VISTA_BEGIN

/* The UDP port that boards listen on. */
#define VISTA_BOARD_PORT 22099

/* Frames that may be submitted and not yet collected. */
#define VISTA_BOARD_FRAMES 2

/* A connection to a board. */
typedef struct vista_board vista_board;

/* What the board was built with. */
typedef struct vista_board_build {
  int32_t version_major, version_minor; /* of the engine's registers */
  int32_t num_disparities;
  int32_t block_size; /* px */
  int32_t max_width_px, max_height_px;
  int32_t max_pixels; /* of an image */
  int32_t rectify_rows; /* of the line buffer of rectification */
  int32_t map_points; /* control points of a camera that there is memory for */
  int32_t cameras; /* 1: two cameras of its own */
} vista_board_build;

/* What a session does with its pairs. The numbers are those of the contract of the engine. */
typedef struct vista_board_settings {
  int32_t width_px, height_px;
  int32_t xsobel; /* 1: x-Sobel, 0: plain grey values */
  int32_t prefilter_cap; /* 1 .. 63 */
  int32_t texture_threshold; /* 0: off */
  int32_t uniqueness_ratio; /* 0 .. 100 percent */
  int32_t lr_max_diff; /* -1: off */
  int32_t smooth; /* 1: images are smoothed before they are matched */
  int32_t levels; /* 1 .. 4 */
  int32_t cameras; /* 1: the pairs are those of the board's cameras, which have this size; none are submitted */
  const int16_t *left_map, *right_map; /* control points {dx, dy} of each camera, row by row; null: no rectification */
} vista_board_settings;

/* What has happened since vista_board_connect. */
typedef struct vista_board_counts {
  int64_t frames; /* collected */
  int64_t lost; /* frames that were begun and not collected, and pairs of the cameras that had no room or broke off */
  int64_t refused_left, refused_right; /* frames of the board's cameras that found no partner */
  int64_t chunks_sent, chunks_sent_again;
  int64_t chunks_received, chunks_received_again;
  int64_t chunks_wrong; /* that were not of the frame, by their check, and fetched again */
  int64_t retries; /* requests that were repeated */
} vista_board_counts;

/* A pair of the board's cameras. */
typedef struct vista_board_pair {
  int64_t number; /* from the start of the session on, those that were lost included */
  int64_t t_ns; /* when its first pixel came, on the clock of the board, in steps of 1 us */
  int64_t came_ns; /* the same moment on CLOCK_MONOTONIC of this machine, at most the time of an answer too late */
} vista_board_pair;

/* The number of bytes that vista_board_connect needs. */
VISTA_API size_t vista_board_bytes(void);

/* Opens the way to a board in the memory given, which may have any alignment, and asks the board for an answer.
 *
 * host: an IPv4 address, or localhost: names are not looked up. timeout_ms: silence after which a function gives up, from
 * 1 on.
 *
 * - VISTA_ERROR_ADDRESS: the host is no address, or the system gives no socket.
 * - VISTA_ERROR_NO_ANSWER: nobody answers there.
 * - VISTA_ERROR_BOARD: what answers speaks another version of the protocol.
 * - VISTA_ERROR_MEMORY: there are too few bytes.
 * - VISTA_ERROR_RANGE: the port or the time is out of range. */
VISTA_API vista_status vista_board_connect(void *memory, size_t bytes, const char *host, int32_t port,
                                           int32_t timeout_ms, vista_board **board);

/* Closes the way to the board. The memory may be given back then. Null is allowed. */
VISTA_API void vista_board_disconnect(vista_board *board);

/* Reads what the board was built with.
 *
 * - VISTA_ERROR_BOARD: no stereo engine of a major version that is known.
 * - VISTA_ERROR_NO_ANSWER: the board is silent. */
VISTA_API vista_status vista_board_identify(vista_board *board, vista_board_build *build);

/* Begins a session with these settings and loads the map. Frames that were not collected are lost. From
 * then on this client holds the board until it disconnects or has been silent for 3 s, and no other client's session
 * begins. Settings and map are not needed any more afterwards.
 *
 * - VISTA_ERROR_RANGE: a number is out of range.
 * - VISTA_ERROR_SIZE: the board has no room for such frames, or for so many control points.
 * - VISTA_ERROR_CAPACITY: the map needs more rows than the line buffer of the board has.
 * - VISTA_ERROR_BOARD: no stereo engine of a major version that is known, or no cameras, which are asked for.
 * - VISTA_ERROR_HELD: another client holds the board.
 * - VISTA_ERROR_NO_ANSWER: the board is silent; there is no session then. */
VISTA_API vista_status vista_board_configure(vista_board *board, const vista_board_settings *settings);

/* The words of a frame of this session: those of all levels. 0 without a session. */
VISTA_API int64_t vista_board_words(const vista_board *board);

/* Sends a pair. stride: pixels from one row to the next, of both images. Returns when all of it has arrived.
 *
 * - VISTA_ERROR_CAPACITY: VISTA_BOARD_FRAMES frames have to be collected first.
 * - VISTA_ERROR_ORDER: the pairs of this session are those of the cameras.
 * - VISTA_ERROR_SESSION: there is no session, or the board has another: it was restarted, or another client took it.
 * - VISTA_ERROR_SIZE: the stride is less than the width.
 * - VISTA_ERROR_NO_ANSWER: the board is silent; the frame is lost. */
VISTA_API vista_status vista_board_submit(vista_board *board, const uint8_t *left, const uint8_t *right,
                                          ptrdiff_t stride);

/* Receives the words of the frame that was submitted first: level 0 first, each level without gaps, of
 * (width + 1) / 2 x (height + 1) / 2 words and so on; in 1/16 px, negative where there is none. On an error the frame is
 * lost and the words mean nothing.
 *
 * - VISTA_ERROR_ORDER: no frame was submitted.
 * - VISTA_ERROR_MEMORY: word_count is less than vista_board_words.
 * - VISTA_ERROR_SESSION: the board has another session, see vista_board_submit.
 * - VISTA_ERROR_FRAME: the engine did not finish the frame, or its words go on being others by their check.
 * - VISTA_ERROR_NO_ANSWER: the board is silent. */
VISTA_API vista_status vista_board_collect(vista_board *board, int16_t *words, int64_t word_count);

/* Lets the board take the pairs of its cameras, from the next one on. It keeps two frames until they are received;
 * pairs that come meanwhile are lost.
 *
 * - VISTA_ERROR_ORDER: the settings of the session name no cameras.
 * - VISTA_ERROR_SESSION, VISTA_ERROR_NO_ANSWER: see vista_board_submit. */
VISTA_API vista_status vista_board_start(vista_board *board);

/* Lets the board take no more pairs, and waits until it has finished what it was at. That can be received still. */
VISTA_API vista_status vista_board_stop(vista_board *board);

/* Receives the words of the next pair of the cameras, as vista_board_collect does. A number that is left out is that of a
 * lost pair; frames that found no partner are counted by vista_board_count. A pair keeps its time for half an hour,
 * however late it is received.
 *
 * - VISTA_ERROR_ORDER: the settings of the session name no cameras.
 * - VISTA_ERROR_FRAME: no pair came within the agreed time, the engine did not finish this one, or its words go on being
 *   others by their check.
 * - VISTA_ERROR_MEMORY, VISTA_ERROR_SESSION, VISTA_ERROR_NO_ANSWER: see vista_board_collect. */
VISTA_API vista_status vista_board_receive(vista_board *board, int16_t *words, int64_t word_count,
                                           vista_board_pair *pair);

/* What has happened so far. */
VISTA_API vista_board_counts vista_board_count(const vista_board *board);

VISTA_END

#endif
