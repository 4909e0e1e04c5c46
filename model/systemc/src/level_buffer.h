// The buffer of the pyramid: pixels of the smaller levels to memory and back, in order, 4 bytes each.
#ifndef VISTA_SYSTEM_LEVEL_BUFFER_H
#define VISTA_SYSTEM_LEVEL_BUFFER_H

#include <algorithm>
#include <cstdint>
#include <deque>
#include <systemc>
#include <vector>

#include "board_memory.h"
#include "configuration.h"
#include "memory.h"
#include "timing.h"

namespace vista {

class LevelBuffer : public sc_core::sc_module {
 public:
  LevelBuffer(const sc_core::sc_module_name& name, const Configuration& c, Memory& memory, int64_t address,
              BoardMemory* board)
      : sc_module(name),
        to_("store", memory, kResultRank),
        from_("levels", memory, kFetchRank),
        address_(address),
        edges_(c.engine_clock_hz),
        burst_px_(c.burst_bytes / kBytes),
        fifo_px_(c.dma_fifo_bytes / kBytes),
        board_(board) {
    SC_HAS_PROCESS(LevelBuffer);
    SC_THREAD(write);
    SC_THREAD(read);
  }

  // Comes before all others in each clock: pixels on their way to a board's memory, one a clock.
  void edge(int64_t clock) {
    if (waiting_px_ == 0 || !board_->store.has_room(edges_.ps(clock))) return;
    --waiting_px_;
    board_->store.write(edges_.ps(clock), BoardMemory::kLevels + stored_px_++ % BoardMemory::kLevelWords);
  }

  // Whether another pixel may be stored in this clock.
  bool has_room(int64_t clock) {
    if (board_) return waiting_px_ < kWaitingPixels;
    if (held_px_ < fifo_px_) return true;
    wait_until(edges_.ps(clock));
    written_.drain(edges_.ps(clock), [&](int64_t px) { held_px_ -= px; });
    return held_px_ < fifo_px_;
  }

  // So many pixels of a level are stored by now; `end`: and it is whole.
  void store(int64_t clock, int64_t px, bool end) {
    if (board_) {
      waiting_px_ += px - level_px_;
      level_px_ = end ? 0 : px;
      return;
    }
    held_px_ += px - level_px_;
    fill_px_ += px - level_px_;
    level_px_ = end ? 0 : px;
    for (; fill_px_ >= burst_px_ || (end && fill_px_ > 0); fill_px_ -= std::min(fill_px_, burst_px_))
      filled_.push(edges_.ps(clock), std::min(fill_px_, burst_px_));
  }

  // Takes a pixel, if there is one in this clock.
  bool take(int64_t clock) {
    if (board_) {
      if (!board_->levels.take(edges_.ps(clock))) return false;
      board_->levels.leave(edges_.ps(clock));
      return true;
    }
    if (offered_px_ == 0) {
      if (arriving_.empty()) wait_until(edges_.ps(clock));
      if (arriving_.empty() || arriving_.front().clock > clock) return false;
      offered_px_ = offered_burst_px_ = arriving_.front().px;
      arriving_.pop_front();
    }
    if (--offered_px_ == 0) taken_.push(edges_.ps(clock), offered_burst_px_);
    return true;
  }

 private:
  static constexpr int64_t kBytes = 4;
  static constexpr int64_t kWaitingPixels = 4;  // registers of the pyramid
  struct Burst {
    int64_t clock, px;
  };

  void write() {
    std::vector<uint8_t> data(static_cast<size_t>(burst_px_ * kBytes));
    for (;;) {
      const int64_t px = filled_.pop();
      const int64_t done = to_.write(address_, data.data(), px * kBytes);
      written_.push(done, px);
      stored_.push(done, px);
    }
  }

  void read() {
    std::vector<uint8_t> data(static_cast<size_t>(burst_px_ * kBytes));
    for (int64_t claimed_px = 0;;) {
      const int64_t px = stored_.pop();
      taken_.drain(now_ps(), [&](int64_t free_px) { claimed_px -= free_px; });
      while (claimed_px + px > fifo_px_) claimed_px -= taken_.pop();
      claimed_px += px;
      arriving_.push_back({edges_.at_or_after(from_.read(address_, data.data(), px * kBytes)), px});
    }
  }

  Master to_, from_;
  int64_t address_;
  ClockEdges edges_;
  int64_t burst_px_, fifo_px_;
  int64_t held_px_ = 0, fill_px_ = 0, level_px_ = 0;
  TimedQueue<int64_t> filled_, written_, stored_, taken_;
  std::deque<Burst> arriving_;
  int64_t offered_px_ = 0, offered_burst_px_ = 0;
  BoardMemory* board_;  // null: not on a board
  int64_t waiting_px_ = 0, stored_px_ = 0;
};

}  // namespace vista

#endif
