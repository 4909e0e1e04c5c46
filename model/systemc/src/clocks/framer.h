// rtl/src/vista_framer.sv for well-framed video: which pixels may enter, and the slots they make.
//
// What broken framing does (cut, fill, drop) is not modelled; nor is `tuser`: a pixel that comes between frames starts one.
#ifndef VISTA_CLOCKS_FRAMER_H
#define VISTA_CLOCKS_FRAMER_H

#include "latency.h"

namespace vista::clocks {

struct Size {
  int width = 0, height = 0;  // px
};

struct Slot {
  bool valid = false, first_col = false, last_col = false;
  bool match = false;  // a pixel is matched with this slot
};

class Framer {
 public:
  explicit Framer(const Build& build)
      : block_size_(build.block_size),
        radius_(build.radius()),
        first_match_col_(build.num_disparities - 1 + 2 * build.radius()) {}

  // Sets the size of the frames that start from now on.
  void set_size(const Size& size) { next_ = size; }

  // What this clock does, given its inputs; `edge` then does it.
  struct Clock {
    bool step = false, start = false;  // a pixel is taken, the first of a frame
    bool begin = false;  // the words of a frame may leave, `begin_size` its size
    Size begin_size;
    Slot slot;
  };

  Clock evaluate(bool pixel_valid, bool go) const {
    Clock c;
    const bool blocked = drain_ && row_ != 0;
    c.start = !active_ && pixel_valid && go;
    c.step = c.start || (active_ && pixel_valid && go && !blocked);
    const int rows = matched_rows();
    const int col = drain_ ? drain_col_ : col_;
    c.slot.valid = drain_ ? go : c.step && row_ != 0;
    c.slot.first_col = col == 0;
    c.slot.last_col = drain_ ? drain_last_col_ : last_col_;
    c.slot.match = c.slot.valid && rows >= block_size_ - 1 && col >= first_match_col_;
    c.begin = c.slot.valid && col == 0 && !begun_ && (drain_ || row_ == radius_ + 1);
    c.begin_size = drain_ ? matched_ : stored_;
    return c;
  }

  void edge(const Clock& c) {
    const bool first_row = !drain_ && row_ == 1;
    if (c.slot.valid) {
      const int rows = matched_rows();
      if (c.slot.last_col && rows != block_size_) rows_ = rows + 1;
      if (first_row) {
        begun_ = false;
        if (col_ == 0) matched_ = stored_;
      }
      if (c.begin) begun_ = true;
      if (drain_) {
        if (drain_last_col_) drain_ = false;
        drain_last_col_ = ++drain_col_ == matched_.width - 1;
      }
    }
    if (c.step) advance(c.start);
  }

  bool draining() const { return drain_; }

 private:
  int matched_rows() const { return !drain_ && row_ == 1 ? 0 : rows_; }

  void advance(bool start) {
    if (start) {
      active_ = true;
      stored_ = next_;
    }
    const bool row_end = last_col_, frame_end = row_end && row_ == stored_.height - 1;
    col_ = row_end ? 0 : col_ + 1;
    last_col_ = !start && !row_end && col_ == stored_.width - 1;
    if (row_end) row_ = frame_end ? 0 : row_ + 1;
    if (frame_end) {
      active_ = false;
      drain_ = true;
      drain_col_ = 0;
      drain_last_col_ = false;
    }
  }

  int block_size_, radius_, first_match_col_;
  Size next_;
  // Frame being stored.
  bool active_ = false, last_col_ = false;
  int col_ = 0, row_ = 0;
  Size stored_;
  // Frame being matched, one row behind; its last row by itself.
  bool drain_ = false, drain_last_col_ = false, begun_ = false;
  int drain_col_ = 0, rows_ = 0;
  Size matched_;
};

}  // namespace vista::clocks

#endif
