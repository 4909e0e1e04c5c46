// rtl/src/vista_result_fifo.sv without its data: when words can be read, and when the framer has to pause.
#ifndef VISTA_CLOCKS_RESULT_FIFO_H
#define VISTA_CLOCKS_RESULT_FIFO_H

#include "latency.h"

namespace vista::clocks {

class ResultFifo {
 public:
  explicit ResultFifo(const Build& build)
      : depth_(result_fifo_depth(build.num_disparities)),
        go_below_(depth_ - results_in_flight(build.num_disparities)) {}

  bool go() const { return go_; }
  bool valid() const { return ahead_ != 0; }

  void edge(bool write, bool ready) {
    const bool read = stored_ != 0 && claimed_ != kFifoAhead;
    const bool take = valid() && ready;
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
  int stored_ = 0, level_ = 0, ahead_ = 0, claimed_ = 0;
  bool go_ = false, reading_[2] = {false, false};
};

}  // namespace vista::clocks

#endif
