// The front end of the engine (rtl/src/vista_front_end.sv) in time: rectification with its line buffer, the levels of the
// pyramid one after the other, through a buffer in memory, and smoothing. At most a pixel a clock enters and leaves.
//
// What lies between its blocks are counts, not registers: the clocks of a frame are those of the RTL
// (tb/top/test_front_end_model.py), that of a single pixel may be a few off.
#ifndef VISTA_SYSTEM_FRONT_END_H
#define VISTA_SYSTEM_FRONT_END_H

#include <cstdint>
#include <deque>
#include <systemc>
#include <vector>

#include "configuration.h"
#include "level_buffer.h"
#include "stream.h"

namespace vista {

class FrontEnd : public sc_core::sc_module, public PixelSource {
 public:
  sc_core::sc_port<PixelSource> raw;

  FrontEnd(const sc_core::sc_module_name& name, const Configuration& configuration, Memory& memory, int64_t address,
           BoardMemory* board);

  bool pixel_valid(int64_t clock) override;
  void pixel_taken(int64_t clock) override;
  int64_t next_pixel(int64_t clock) override;

 private:
  // A place in the stream of pixels that leaves a block: level after level, frame after frame.
  struct Place {
    int64_t frame = 0, level = 0, pixel = 0;
  };

  static constexpr int64_t kLongAgo = -1000000;

  void advance(int64_t clock);  // all blocks, up to and with this clock
  void take_raw(int64_t clock);
  void read_pixel(int64_t clock);
  void pass_pyramid(int64_t clock);
  bool row_ready(int64_t row, int64_t clock);
  bool rectified(int64_t clock) const;
  void go_on(Place& place) const;
  int64_t pixels(const Place& place) const { return level_px_[static_cast<size_t>(place.level)]; }
  int64_t& came(int64_t row) { return row_came_[static_cast<size_t>(row) % row_came_.size()]; }
  int64_t width(const Place& place) const { return level_width_[static_cast<size_t>(place.level)]; }
  bool empty() const { return passed_ == left_ && raw_px_ == pyramid_.frame * level_px_[0] && pyramid_.level == 0; }

  std::vector<int64_t> level_width_, level_px_;
  int64_t height_, rows_;
  LevelBuffer buffer_;
  int64_t clock_ = -1;
  // Rectification: pixels that came and that were read, of all frames; when the reading of the last two rows began; when
  // the rows of the line buffer had come; when the pixels were read that have not passed.
  int64_t raw_px_ = 0, read_px_ = 0, row_clock_ = kLongAgo, row_before_clock_ = kLongAgo;
  std::vector<int64_t> row_came_;
  std::deque<int64_t> read_clocks_;
  // The pyramid and the smoothing: where each is, how many pixels left it, and when those in between came.
  Place pyramid_, smoothed_;
  int64_t passed_ = 0, left_ = 0, level_clock_ = 0;
  std::deque<int64_t> passed_clocks_;
};

}  // namespace vista

#endif
