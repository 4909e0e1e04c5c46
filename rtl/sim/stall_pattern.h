// SPDX-License-Identifier: Apache-2.0
// When the two sides of a stream run and pause, from a seed: the same for the Verilated engine and for models of it.
//
// Each clock draws first for the source, unless it holds an offer or has nothing more to offer, then for the reader.
#ifndef VISTA_STALL_PATTERN_H
#define VISTA_STALL_PATTERN_H

#include <cstdint>

namespace vista {

// xorshift64*: small, seedable, the same everywhere.
class Random {
 public:
  explicit Random(uint64_t seed) : state_(seed * 2654435769u + 88172645463325252u) {}
  // True in `permille` of 1000 calls.
  bool chance(uint32_t permille) {
    state_ ^= state_ >> 12;
    state_ ^= state_ << 25;
    state_ ^= state_ >> 27;
    return (state_ * 2685821657736338717u >> 33) % 1000 < permille;
  }

 private:
  uint64_t state_;
};

// A side of a stream that runs and pauses in bursts: per clock, the chances to stop and to go on.
struct Pace {
  uint32_t stop_permille, go_permille;
  bool running = true;
  bool step(Random& random) {
    running = running ? !random.chance(stop_permille) : random.chance(go_permille);
    return running;
  }
};

}  // namespace vista

#endif
