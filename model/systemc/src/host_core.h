// A processor core that stages take in the order in which they ask for it; and how long a stage takes in a frame.
#ifndef VISTA_SYSTEM_HOST_CORE_H
#define VISTA_SYSTEM_HOST_CORE_H

#include <cstdint>
#include <systemc>
#include <vector>

#include "images.h"

namespace vista {

class HostCore {
 public:
  void acquire() {
    const int64_t ticket = next_ticket_++;
    while (serving_ != ticket) sc_core::wait(released_);
  }
  void release() {
    ++serving_;
    released_.notify(sc_core::SC_ZERO_TIME);
  }

 private:
  int64_t next_ticket_ = 0, serving_ = 0;
  sc_core::sc_event released_;
};

// A frame takes all its times from one position of the measured series: series of one run belong together.
inline double stage_ms(const std::vector<double>& samples, int64_t seed, int64_t frame) {
  constexpr uint64_t kDraws = uint64_t{1} << 32;
  const uint64_t draw = random_bits(static_cast<uint64_t>(seed) ^ 0x686F7374, static_cast<uint64_t>(frame)) % kDraws;
  return samples[static_cast<size_t>(draw * samples.size() / kDraws)];
}

}  // namespace vista

#endif
