// rtl/src/vista_result_fifo.sv without the results: when words can be read, when the framer has to pause, and where among
// the results frames begin.
#ifndef VISTA_CLOCKS_RESULT_FIFO_H
#define VISTA_CLOCKS_RESULT_FIFO_H

#include <deque>
#include <vector>

#include "framer.h"
#include "latency.h"

namespace vista::clocks {

// What waits in it: a result, or the beginning of a frame of this size.
struct Queued {
  bool begin = false;
  Size size;
};

// The way of a beginning to the queue, which takes as long as that of the results before it.
class BeginDelay {
 public:
  explicit BeginDelay(const Build& build) : frames_(static_cast<size_t>(begin_latency(build.num_disparities))) {}

  const Queued& out() const { return frames_[at_]; }
  bool empty() const { return under_way_ == 0; }

  void edge(bool begin, const Size& size) {
    under_way_ += static_cast<int>(begin) - static_cast<int>(frames_[at_].begin);
    frames_[at_] = {begin, size};
    at_ = (at_ + 1) % frames_.size();
  }

 private:
  std::vector<Queued> frames_;
  size_t at_ = 0;
  int under_way_ = 0;
};

class ResultFifo {
 public:
  explicit ResultFifo(const Build& build)
      : depth_(result_fifo_depth(build.num_disparities)),
        go_below_(depth_ - results_in_flight(build.num_disparities)) {}

  bool go() const { return go_; }
  bool valid() const { return ahead_ != 0; }
  Queued front() const { return valid() ? queued_.front() : Queued{}; }

  void edge(bool result, const Queued& begin, bool ready) {
    const bool write = result || begin.begin;
    const bool read = stored_ != 0 && claimed_ != kFifoAhead;
    const bool take = valid() && ready;
    if (take) queued_.pop_front();
    if (write) queued_.push_back(begin);
    go_ = level_ < go_below_;
    level_ = stored_ & (depth_ - 1);  // the RTL subtracts two pointers
    stored_ += static_cast<int>(write) - static_cast<int>(read);
    ahead_ += static_cast<int>(reading_[1]) - static_cast<int>(take);
    claimed_ += static_cast<int>(read) - static_cast<int>(take);
    reading_[1] = reading_[0];
    reading_[0] = read;
  }

  bool empty() const { return stored_ == 0 && claimed_ == 0; }

 private:
  int depth_, go_below_;
  std::deque<Queued> queued_;
  int stored_ = 0, level_ = 0, ahead_ = 0, claimed_ = 0;
  bool go_ = false, reading_[2] = {false, false};
};

}  // namespace vista::clocks

#endif
