// The way from a slot to its result: the stages that never stop (rtl/src/vista_stereo_core.sv, vista_right_winner.sv,
// vista_lr_check.sv). What stays to be told of them is when results come: D-1 slots after the slot of the pixel.
#ifndef VISTA_CLOCKS_MATCHING_H
#define VISTA_CLOCKS_MATCHING_H

#include <cstdint>

#include "framer.h"
#include "latency.h"

namespace vista::clocks {

// A bit handed on from register to register, at most 64 of them.
class Delay {
 public:
  explicit Delay(int clocks) : last_(clocks - 1) {}
  bool out() const { return bits_ >> last_ & 1; }
  void edge(bool in) { bits_ = (bits_ << 1 | (in ? 1u : 0u)) & (UINT64_MAX >> (63 - last_)); }
  bool empty() const { return bits_ == 0; }

 private:
  int last_;
  uint64_t bits_ = 0;
};

// rtl/src/vista_prefilter.sv: the gradient of a column waits for the next one, that of the last column for nothing.
// Gives the slots whose gradient begins.
class Prefilter {
 public:
  Slot out() const {
    Slot slot = center_;
    slot.valid = last_pending_ || (valid_.out() && !first_col_.out());
    return slot;
  }

  void edge(const Slot& slot) {
    last_pending_ = valid_.out() && last_col_.out();
    if (valid_.out()) center_ = {true, first_col_.out(), last_col_.out(), match_.out()};
    valid_.edge(slot.valid);
    first_col_.edge(slot.first_col);
    last_col_.edge(slot.last_col);
    match_.edge(slot.match);
  }

  bool empty() const { return !last_pending_ && valid_.empty(); }

 private:
  Delay valid_{kVerticalLatency}, first_col_{kVerticalLatency}, last_col_{kVerticalLatency}, match_{kVerticalLatency};
  Slot center_;
  bool last_pending_ = false;
};

class Matching {
 public:
  explicit Matching(const Build& build)
      : num_disparities_(build.num_disparities),
        match_(kGradientLatency + kCostLatency),
        last_col_(kGradientLatency + kCostLatency),
        decided_(1 + check_delay(build.num_disparities) + kCheckLatency) {}

  bool result() const { return decided_.out(); }

  void edge(const Slot& slot) {
    const bool match = match_.out();
    const bool moves = match || flush_ != 0;
    decided_.edge(moves && age_ == num_disparities_ - 1);
    if (moves) {
      if (flush_ == 1)
        age_ = 0;
      else if (age_ != num_disparities_ - 1)
        ++age_;
    }
    if (match && last_col_.out())
      flush_ = num_disparities_ - 1;
    else if (flush_ != 0)
      --flush_;
    const Slot filtered = prefilter_.out();
    match_.edge(filtered.valid && filtered.match);
    last_col_.edge(filtered.last_col);
    prefilter_.edge(slot);
  }

  bool empty() const { return prefilter_.empty() && match_.empty() && flush_ == 0 && decided_.empty(); }

 private:
  int num_disparities_, flush_ = 0, age_ = 0;
  Prefilter prefilter_;
  Delay match_, last_col_, decided_;
};

}  // namespace vista::clocks

#endif
