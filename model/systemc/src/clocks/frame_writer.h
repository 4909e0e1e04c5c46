// rtl/src/vista_frame_writer.sv without its data: the words of the border leave by themselves, the others with a result.
#ifndef VISTA_CLOCKS_FRAME_WRITER_H
#define VISTA_CLOCKS_FRAME_WRITER_H

#include "framer.h"
#include "latency.h"

namespace vista::clocks {

class FrameWriter {
 public:
  explicit FrameWriter(const Build& build)
      : radius_(build.radius()), first_x_(build.num_disparities - 1 + build.radius()) {}

  bool go() const { return go_; }
  bool valid() const { return valid_; }
  bool takes_result(bool word_ready) const { return busy_ && matched_ && (!valid_ || word_ready); }
  // Nothing to hand on until a result or a frame comes.
  bool waits() const { return !valid_ && (busy_ ? matched_ : pending_ == 0); }

  void edge(bool begin, const Size& begin_size, bool result, bool word_ready) {
    const bool free = !valid_ || word_ready;
    const bool step = busy_ && free && (!matched_ || result);
    const bool row_end = x_ == size_.width - 1;
    const bool frame_end = step && row_end && y_ == size_.height - 1;
    const bool open = pending_ != 0 && (!busy_ || frame_end);
    const Size opened = frames_[read_];

    if (step) {
      if (x_ == first_x_ - 1)
        matched_ = row_;
      else if (x_ == size_.width - 1 - radius_)
        matched_ = false;
      if (row_end) {
        if (y_ == radius_ - 1)
          row_ = matchable_;
        else if (y_ == size_.height - 1 - radius_)
          row_ = false;
        ++y_;
      }
      x_ = row_end ? 0 : x_ + 1;
    }
    if (frame_end) busy_ = false;
    if (open) {
      busy_ = true;
      x_ = y_ = 0;
      row_ = matched_ = false;
      size_ = opened;
      matchable_ = size_.width - 1 >= first_x_ + radius_ && size_.height - 1 >= 2 * radius_;
      read_ = (read_ + 1) % kPendingFrames;
    }
    if (free) valid_ = step;

    go_ = pending_ < kPendingFrames - 1;
    if (begin) {
      frames_[write_] = begin_size;
      write_ = (write_ + 1) % kPendingFrames;
    }
    pending_ += static_cast<int>(begin) - static_cast<int>(open);
  }

 private:
  int radius_, first_x_;
  Size frames_[kPendingFrames];
  int write_ = 0, read_ = 0, pending_ = 0;
  bool go_ = false;
  // The frame that is leaving.
  bool busy_ = false, valid_ = false;
  bool matchable_ = false;  // there are matched pixels
  bool row_ = false, matched_ = false;  // the row has some, the pixel is one
  int x_ = 0, y_ = 0;
  Size size_;
};

}  // namespace vista::clocks

#endif
