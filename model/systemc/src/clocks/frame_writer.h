// rtl/src/vista_frame_positions.sv and vista_frame_writer.sv without their data: positions are counted ahead from the
// beginning of a frame on; the words of the border leave by themselves, the others with a result.
#ifndef VISTA_CLOCKS_FRAME_WRITER_H
#define VISTA_CLOCKS_FRAME_WRITER_H

#include "framer.h"
#include "latency.h"
#include "result_fifo.h"
#include "skid.h"

namespace vista::clocks {

class FramePositions {
 public:
  explicit FramePositions(const Build& build)
      : radius_(build.radius()), first_x_(build.num_disparities - 1 + build.radius()) {}

  bool valid() const { return valid_; }
  bool first() const { return first_out_; }
  bool matched() const { return matched_out_; }
  bool idle() const { return !valid_ && !busy_; }

  void edge(const Queued& waiting, bool ready) {
    const bool free = !valid_ || ready;
    const bool step = busy_ && free;
    const bool row_end = x_ == size_.width - 1;
    const bool frame_end = step && row_end && y_ == size_.height - 1;
    const bool open = waiting.begin && (!busy_ || frame_end);

    if (free) {
      valid_ = step;
      first_out_ = first_;
      matched_out_ = matched_;
    }
    if (step) {
      first_ = false;
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
      busy_ = first_ = true;
      x_ = y_ = 0;
      row_ = matched_ = false;
      size_ = waiting.size;
      matchable_ = size_.width - 1 >= first_x_ + radius_ && size_.height - 1 >= 2 * radius_;
    }
  }

 private:
  int radius_, first_x_;
  // The frame that is leaving.
  bool busy_ = false, valid_ = false, first_ = false, first_out_ = false, matched_out_ = false;
  bool matchable_ = false;  // there are matched pixels
  bool row_ = false, matched_ = false;  // the row has some, the pixel is one
  int x_ = 0, y_ = 0;
  Size size_;
};

class FrameWriter {
 public:
  explicit FrameWriter(const Build& build) : positions_(build) {}

  bool valid() const { return valid_; }
  // Whether it takes a result, or the beginning of a frame, which waits until the frame's first word leaves.
  bool takes(bool begin, bool word_ready) const {
    return places_.valid() && (begin ? place_.first : place_.matched) && (!valid_ || word_ready);
  }
  // Nothing to hand on until a result or a frame comes.
  bool waits() const {
    const bool stands = places_.valid() ? place_.matched && !places_.ready() && positions_.valid() : positions_.idle();
    return !valid_ && stands;
  }

  // waits: something does, `waiting` says what.
  void edge(bool waits, const Queued& waiting, bool word_ready) {
    const bool free = !valid_ || word_ready;
    const bool step = places_.valid() && free && (!place_.matched || waits);
    const bool places_ready = places_.ready();
    const Place counted = {positions_.first(), positions_.matched()};

    // Words move as in vista_skid.
    if (!places_.valid() || step) place_ = places_ready ? counted : spilled_;
    if (places_ready) spilled_ = counted;
    places_.edge(positions_.valid(), step);
    positions_.edge(waiting, places_ready);
    if (free) valid_ = step;
  }

 private:
  struct Place {
    bool first = false, matched = false;
  };

  FramePositions positions_;
  Skid places_;
  Place place_, spilled_;  // the two positions that it holds
  bool valid_ = false;
};

}  // namespace vista::clocks

#endif
