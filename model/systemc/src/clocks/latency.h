// Clocks and depths of the engine, derived from its build parameters as rtl/src/vista_stereo_pkg.sv derives them; the
// table is in doc/rtl.md, "Latency". The only place of the model that holds them. The latencies of single stages are
// read out of that package when this is built (systemc.mk): kPrefilterLatency .. kCheckLatency, kInFlightMargin.
#ifndef VISTA_CLOCKS_LATENCY_H
#define VISTA_CLOCKS_LATENCY_H

#include "vista_stereo_latency.h"

namespace vista::clocks {

// Fixed when the RTL is built.
struct Build {
  int num_disparities = 32;  // 16, 32 .. 256
  int block_size = 11;  // odd, 5 .. 21
  int max_width = 1024;  // px

  int radius() const { return block_size / 2; }
};

constexpr int ceil_log2(int n) {
  int bits = 0;
  while ((1 << bits) < n) ++bits;
  return bits;
}

// Clocks from a slot to the vertical sums of its column, and from those of the next column to the prefiltered pixels.
constexpr int kVerticalLatency = 3;
constexpr int kGradientLatency = 3;
static_assert(kVerticalLatency + 1 + kGradientLatency == kPrefilterLatency);

constexpr int kFifoAhead = 4;  // words in registers behind the memory of the result FIFO

// Clocks from prefiltered pixels to their costs.
constexpr int kCostLatency = kDelayLatency + kColumnLatency + kWindowLatency;

constexpr int candidate_latency(int num_disparities) {
  return ceil_log2(num_disparities) + kThresholdLatency + kUniquenessLatency + kSubpixelLatency;
}

constexpr int check_delay(int num_disparities) {
  const int ready = candidate_latency(num_disparities) + 2;
  return ready > num_disparities - 1 ? ready - (num_disparities - 1) : 0;
}

constexpr int results_in_flight(int num_disparities) {
  return kPrefilterLatency + kCostLatency + candidate_latency(num_disparities) + kCheckLatency + (num_disparities - 1) +
         kInFlightMargin;
}

// Clocks from the beginning of a frame to its place among the results.
constexpr int begin_latency(int num_disparities) {
  return kPrefilterLatency + kCostLatency + kCheckLatency + check_delay(num_disparities) + num_disparities - 4;
}

constexpr int result_fifo_depth(int num_disparities) { return 1 << ceil_log2(2 * results_in_flight(num_disparities)); }

}  // namespace vista::clocks

#endif
