#include "link/board/frame_layout.h"

#include <stdbool.h>

#include "vista/word.h"

enum { MIN_WIDTH_PX = 4, MIN_HEIGHT_PX = 2 }; /* of a level that the engine sends: doc/rtl.md, Front end */

static int64_t pairs_of_row(const level_layout *level) { return (level->width_px + 1) / 2; }

frame_layout frame_layout_of(int32_t width_px, int32_t height_px, int32_t levels) {
  frame_layout layout = {.level_count = levels};
  bool sent = true;
  for (int32_t k = 0; k < levels; k++) {
    level_layout *const level = &layout.level[k];
    *level = (level_layout){width_px, height_px, layout.words, layout.pairs};
    sent = sent && width_px >= MIN_WIDTH_PX && height_px >= MIN_HEIGHT_PX;
    layout.sent_count += sent;
    layout.words += (int64_t)width_px * height_px;
    layout.pairs += sent ? pairs_of_row(level) * height_px : 0;
    width_px = (width_px + 1) / 2;
    height_px = (height_px + 1) / 2;
  }
  return layout;
}

void frame_layout_fill_unsent(const frame_layout *layout, int16_t *words) {
  if (layout->sent_count == layout->level_count) return;
  const int64_t first = layout->level[layout->sent_count].first_word;
  for (int64_t i = first; i < layout->words; i++) words[i] = VISTA_DISPARITY_INVALID;
}

static int16_t word_at(const uint8_t *bytes) { return (int16_t)(uint16_t)(bytes[0] | bytes[1] << 8); }

void frame_layout_unpack(const frame_layout *layout, int64_t first, int64_t count, const uint8_t *bytes,
                         int16_t *words) {
  int32_t k = 0;
  while (k + 1 < layout->sent_count && layout->level[k + 1].first_pair <= first) k++;
  for (const int64_t end = first + count; first < end && k < layout->sent_count; k++) {
    const level_layout *const level = &layout->level[k];
    const int64_t in_row = pairs_of_row(level), in_level = in_row * level->height_px;
    int64_t y = (first - level->first_pair) / in_row, x = (first - level->first_pair) % in_row;
    for (; first < end && first < level->first_pair + in_level; first++, bytes += 4) {
      int16_t *const pair = words + level->first_word + y * level->width_px + 2 * x;
      pair[0] = word_at(bytes);
      if (2 * x + 1 < level->width_px) pair[1] = word_at(bytes + 2);
      if (++x == in_row) x = 0, y++;
    }
  }
}
