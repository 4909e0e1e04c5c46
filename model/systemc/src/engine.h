// One engine: clocks/engine_clocks.h between two streams, with the counters of the RTL's registers per frame.
#ifndef VISTA_SYSTEM_ENGINE_H
#define VISTA_SYSTEM_ENGINE_H

#include <cstdint>
#include <deque>
#include <systemc>
#include <vector>

#include "clocks/engine_clocks.h"
#include "stream.h"

namespace vista {

// Clocks of a frame's transfers, and how many passed waiting. A clock counts for the frame whose pixel or word waits.
struct FrameClocks {
  int64_t first_pixel = -1, last_pixel = -1, first_word = -1, last_word = -1;
  int64_t stalls_in = 0;   // tvalid without tready, pixels: register STALLS_IN
  int64_t stalls_out = 0;  // the same of words: STALLS_OUT
  int64_t starved = 0;     // no pixel valid between the first and the last of the frame
};

class Engine : public sc_core::sc_module {
 public:
  sc_core::sc_port<PixelSource> pixels;
  sc_core::sc_port<WordSink> words;

  // levels: the sizes of a frame's levels, which come one after the other.
  Engine(const sc_core::sc_module_name& name, const clocks::Build& build, const std::vector<clocks::Size>& levels);

  // Frame n of those this engine took, complete once its last word was taken.
  const FrameClocks& frame(size_t n) const { return frames_[n]; }
  int64_t clocks_busy() const { return clocks_busy_; }  // stepped: at work, or draining

 private:
  void run();
  void step(bool pixel_valid);
  FrameClocks& of_pixel();

  clocks::EngineClocks clocks_;
  std::vector<clocks::Size> levels_;
  int64_t pixels_per_frame_ = 0;  // of all levels
  std::vector<int64_t> level_ends_;  // in pixels from the beginning of the frame
  size_t level_in_ = 0;
  int64_t clock_ = 0, clocks_busy_ = 0;
  int64_t pixels_taken_ = 0, words_taken_ = 0;  // of the frame under way
  size_t frame_in_ = 0, frame_out_ = 0;
  std::deque<FrameClocks> frames_;
};

}  // namespace vista

#endif
