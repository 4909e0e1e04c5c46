// rtl/src/vista_frame_positions.sv and vista_frame_writer.sv without their data: positions are counted ahead; the words
// of the border leave by themselves, the others with a result.
#ifndef VISTA_CLOCKS_FRAME_WRITER_H
#define VISTA_CLOCKS_FRAME_WRITER_H

#include "framer.h"
#include "latency.h"
#include "skid.h"

namespace vista::clocks {

class FramePositions {
 public:
  explicit FramePositions(const Build& build)
      : radius_(build.radius()), first_x_(build.num_disparities - 1 + build.radius()) {}

  bool go() const { return go_; }
  bool valid() const { return valid_; }
  bool matched() const { return matched_out_; }
  bool idle() const { return !valid_ && !busy_ && pending_ == 0; }

  void edge(bool begin, const Size& begin_size, bool ready) {
    const bool free = !valid_ || ready;
    const bool step = busy_ && free;
    const bool row_end = x_ == size_.width - 1;
    const bool frame_end = step && row_end && y_ == size_.height - 1;
    const bool open = pending_ != 0 && (!busy_ || frame_end);
    const Size opened = frames_[read_];

    if (free) {
      valid_ = step;
      matched_out_ = matched_;
    }
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
  bool busy_ = false, valid_ = false, matched_out_ = false;
  bool matchable_ = false;  // there are matched pixels
  bool row_ = false, matched_ = false;  // the row has some, the pixel is one
  int x_ = 0, y_ = 0;
  Size size_;
};

class FrameWriter {
 public:
  explicit FrameWriter(const Build& build) : positions_(build) {}

  bool go() const { return positions_.go(); }
  bool valid() const { return valid_; }
  bool takes_result(bool word_ready) const { return places_.valid() && matched_ && (!valid_ || word_ready); }
  // Nothing to hand on until a result or a frame comes.
  bool waits() const {
    const bool stands = places_.valid() ? matched_ && !places_.ready() && positions_.valid() : positions_.idle();
    return !valid_ && stands;
  }

  void edge(bool begin, const Size& begin_size, bool result, bool word_ready) {
    const bool free = !valid_ || word_ready;
    const bool step = places_.valid() && free && (!matched_ || result);
    const bool places_ready = places_.ready();

    // Words move as in vista_skid.
    if (!places_.valid() || step) {
      matched_ = places_ready ? positions_.matched() : spilled_matched_;
    }
    if (places_ready) spilled_matched_ = positions_.matched();
    places_.edge(positions_.valid(), step);
    positions_.edge(begin, begin_size, places_ready);
    if (free) valid_ = step;
  }

 private:
  FramePositions positions_;
  Skid places_;
  bool matched_ = false, spilled_matched_ = false;  // the two positions that it holds
  bool valid_ = false;
};

}  // namespace vista::clocks

#endif
