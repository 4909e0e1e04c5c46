#include "capture_dma.h"

#include <algorithm>

#include "timing.h"

namespace vista {

CaptureDma::CaptureDma(const sc_core::sc_module_name& name, const Configuration& c, const Images& images,
                       Memory& memory, BufferPool& captured, FrameLog& log)
    : sc_module(name),
      images_(images),
      master_("capture", memory, kCaptureRank),
      captured_(captured),
      log_(log),
      pixels_(c.pixels()),
      fifo_bytes_(c.capture_fifo_bytes) {
  SC_HAS_PROCESS(CaptureDma);
  SC_THREAD(run);
}

void CaptureDma::frame_begins(int64_t frame) {
  log_[frame].capture_start = now_ps();
  filling_ = captured_.begin_writing(frame);
  if (!filling_) log_.drop(frame, Drop::kNoBuffer);
}

void CaptureDma::pixels_come(int64_t frame, int64_t first, int64_t count) {
  if (!filling_) return;
  const bool fits = held_ + 2 * count <= fifo_bytes_;
  chunks_.push_back({filling_, first, fits ? count : 0});
  came_.notify(sc_core::SC_ZERO_TIME);
  if (fits) {
    held_ += 2 * count;
    high_water_ = std::max(high_water_, held_);
  } else {
    filling_ = nullptr;
    log_.drop(frame, Drop::kOverflow);
  }
}

void CaptureDma::run() {
  for (;;) {
    while (chunks_.empty()) sc_core::wait(came_);
    const Chunk chunk = chunks_.front();
    chunks_.pop_front();
    Buffer& buffer = *chunk.buffer;
    if (chunk.count == 0) {
      captured_.release(buffer);
      continue;
    }
    if (pair_frame_ != buffer.frame) {
      pair_ = images_.frame(buffer.frame);
      pair_frame_ = buffer.frame;
    }
    master_.write(buffer.address + chunk.first, pair_.left.data() + chunk.first, chunk.count);
    const int64_t done =
        master_.write(buffer.address + pixels_ + chunk.first, pair_.right.data() + chunk.first, chunk.count);
    wait_until(done);
    held_ -= 2 * chunk.count;
    if (chunk.first + chunk.count == pixels_) {
      log_[buffer.frame].capture_end = now_ps();
      captured_.publish(buffer);
    }
  }
}

}  // namespace vista
