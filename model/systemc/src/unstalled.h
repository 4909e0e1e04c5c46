// What the engine takes when nobody waits, by running it: three frames back to back.
#ifndef VISTA_SYSTEM_UNSTALLED_H
#define VISTA_SYSTEM_UNSTALLED_H

#include <cstdint>

#include "clocks/engine_clocks.h"

namespace vista {

struct Unstalled {
  int64_t clocks_per_frame = 0;    // from the last word of a frame to that of the next
  int64_t first_word_clocks = 0;   // from the first pixel to the first word
  int64_t pipeline_clocks = -1;    // of a matched pixel's word beyond its r + 1 rows and r columns; none matched: -1
};

inline Unstalled run_unstalled(const clocks::Build& build, const clocks::Size& size) {
  constexpr int kFrames = 3;
  clocks::EngineClocks engine(build);
  engine.set_size(size);
  const int64_t pixels = static_cast<int64_t>(size.width) * size.height, r = build.radius();
  const int64_t x = build.num_disparities - 1 + r, matched = r * size.width + x;
  const bool any = x + r < size.width && 2 * r < size.height;
  Unstalled found;
  int64_t in = 0, out = 0, matched_in = 0, last_before = 0;
  for (int64_t clock = 0; out < kFrames * pixels; ++clock) {
    const bool pixel = in < kFrames * pixels;
    if (pixel && engine.pixel_ready()) {
      if (in == matched) matched_in = clock;
      ++in;
    }
    if (engine.word_valid()) {
      if (out == 0) found.first_word_clocks = clock;
      if (any && out == matched) found.pipeline_clocks = clock - matched_in - (r + 1) * size.width - r;
      if (++out % pixels == 0) {
        found.clocks_per_frame = clock - last_before;
        last_before = clock;
      }
    }
    engine.edge(pixel, true);
  }
  return found;
}

}  // namespace vista

#endif
