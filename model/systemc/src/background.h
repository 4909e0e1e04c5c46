// Other traffic on the memory port: bursts at an even rate. What memory is late for is left out, not made up for.
#ifndef VISTA_SYSTEM_BACKGROUND_H
#define VISTA_SYSTEM_BACKGROUND_H

#include <algorithm>
#include <cmath>
#include <systemc>
#include <vector>

#include "configuration.h"
#include "memory.h"
#include "timing.h"

namespace vista {

class Background : public sc_core::sc_module {
 public:
  Background(const sc_core::sc_module_name& name, const Configuration& c, Memory& memory)
      : sc_module(name),
        master_("background", memory, kBackgroundRank),
        burst_(static_cast<size_t>(c.burst_bytes)),
        every_ps_(
            std::max<int64_t>(1, std::llround(static_cast<double>(c.burst_bytes) * 1e12 / c.background_bytes_s))) {
    SC_HAS_PROCESS(Background);
    SC_THREAD(run);
  }

 private:
  void run() {
    for (int64_t due = 0;; due = std::max(due + every_ps_, now_ps())) {
      wait_until(due);
      master_.read(0, burst_.data(), static_cast<int64_t>(burst_.size()));
    }
  }

  Master master_;
  std::vector<uint8_t> burst_;
  int64_t every_ps_;
};

}  // namespace vista

#endif
