/* The places of the words of a frame: in the stream of disparities that a board sends, and in the caller's memory. */
#ifndef VISTA_BOARD_FRAME_LAYOUT_H
#define VISTA_BOARD_FRAME_LAYOUT_H

#include <stdint.h>

enum { LAYOUT_MAX_LEVELS = 4 };

typedef struct level_layout {
  int32_t width_px, height_px;
  int64_t first_word; /* of the caller's */
  int64_t first_pair; /* of the stream, which has two disparities to a word */
} level_layout;

typedef struct frame_layout {
  int32_t level_count, sent_count; /* levels that are too small are not sent */
  level_layout level[LAYOUT_MAX_LEVELS];
  int64_t words; /* of the caller's, of all levels */
  int64_t pairs; /* of the stream */
} frame_layout;

frame_layout frame_layout_of(int32_t width_px, int32_t height_px, int32_t levels);

/* Fills in the levels that are not sent. */
void frame_layout_fill_unsent(const frame_layout *layout, int16_t *words);

/* Puts `count` words of the stream, from pair `first` on, where they belong. bytes: 4 a word, little-endian. */
void frame_layout_unpack(const frame_layout *layout, int64_t first, int64_t count, const uint8_t *bytes,
                         int16_t *words);

#endif
