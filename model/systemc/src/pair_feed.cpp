#include "pair_feed.h"

#include <algorithm>

namespace vista {
namespace {

constexpr int64_t kFifoPixels = 1024;  // rtl/board/gateware/cameras.py
constexpr int64_t kFifoClocks = 5;     // from the pixel clock's edge to the engine: vista_dvp, vista_camera_fifo

}  // namespace

PairFeed::PairFeed(const sc_core::sc_module_name& name, const Configuration& c, BufferPool& results,
                   ResultDma& result_dma, FrameLog& log, BoardMemory& board)
    : sc_module(name),
      configuration_(c),
      results_(results),
      result_dma_(result_dma),
      log_(log),
      board_(board),
      edges_(c.engine_clock_hz) {
  SC_HAS_PROCESS(PairFeed);
  SC_THREAD(run);
}

// A pair that finds no room for its words is lost when it begins, one of which the FIFOs cannot hold enough when it ends.
void PairFeed::run() {
  for (int64_t frame = 0; frame < configuration_.frames; ++frame) {
    const int64_t begin_clock = edges_.at_or_after(configuration_.came_ps(frame, 1)) + kFifoClocks;
    wait_until(edges_.ps(begin_clock));
    FrameEntry& entry = log_[frame];
    entry.capture_start = configuration_.came_ps(frame, 0);
    Buffer* const result = results_.begin_writing(frame);
    if (!result) {
      log_.drop(frame, Drop::kNoBuffer);
      continue;
    }
    board_.advance(now_ps());
    entry.lane = 0;
    entry.fetch_start = now_ps();
    result_dma_.expect({result, std::vector<uint32_t>(static_cast<size_t>(configuration_.result_px()))});
    frame_ = frame;
    start_clock_ = edges_.at_or_after(now_ps());
    pixel_ = 0;
    overflowed_ = false;
    left_px_ = configuration_.pixels();
    begun_.notify(sc_core::SC_ZERO_TIME);
    sent_.pop();
    entry.capture_end = now_ps();
    if (overflowed_) log_.drop(frame, Drop::kOverflow);
    while (entry.result_end < 0) sc_core::wait(results_.changed());
  }
}

int64_t PairFeed::clock_of(int64_t pixel) const {
  return std::max(start_clock_, edges_.at_or_after(configuration_.came_ps(frame_, pixel + 1)) + kFifoClocks);
}

bool PairFeed::pixel_valid(int64_t clock) { return left_px_ > 0 && clock_of(pixel_) <= clock; }

void PairFeed::pixel_taken(int64_t clock) {
  const int64_t newest = pixel_ + kFifoPixels;
  overflowed_ = overflowed_ || (newest < configuration_.pixels() && clock_of(newest) < clock);
  ++pixel_;
  if (--left_px_ == 0) sent_.push(edges_.ps(clock), 0);
}

int64_t PairFeed::next_pixel(int64_t clock) {
  while (left_px_ == 0) sc_core::wait(begun_);
  return std::max(clock, clock_of(pixel_));
}

}  // namespace vista
