// The buffer of the pyramid: pixels of the smaller levels to memory and back, in order, 4 bytes each. On a board seven
// pixels of a row lie in four words (rtl/board/gateware/levels.py).
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

  // Comes before all others in each clock: words on their way to a board's memory, one a clock.
  void edge(int64_t clock) {
    if (waiting_words_ == 0 || !board_->store.has_room(edges_.ps(clock))) return;
    --waiting_words_;
    board_->store.write(edges_.ps(clock), BoardMemory::kLevels + stored_words_++ % BoardMemory::kLevelWords);
  }

  // Whether another pixel may be stored in this clock.
  bool has_room(int64_t clock) {
    if (board_) return waiting_words_ < kWaitingGroups * kGroupWords;
    if (held_px_ < fifo_px_) return true;
    wait_until(edges_.ps(clock));
    written_.drain(edges_.ps(clock), [&](int64_t px) { held_px_ -= px; });
    return held_px_ < fifo_px_;
  }

  // So many pixels of a level of this width are stored by now; `end`: and it is whole.
  void store(int64_t clock, int64_t px, int64_t width, bool end) {
    if (board_) {
      const int64_t words = px / width * row_words(width) + px % width / kGroupPixels * kGroupWords;
      waiting_words_ += words - level_words_;
      level_words_ = end ? 0 : words;
      return;
    }
    held_px_ += px - level_px_;
    fill_px_ += px - level_px_;
    level_px_ = end ? 0 : px;
    for (; fill_px_ >= burst_px_ || (end && fill_px_ > 0); fill_px_ -= std::min(fill_px_, burst_px_))
      filled_.push(edges_.ps(clock), std::min(fill_px_, burst_px_));
  }

  // Takes a pixel of a level of this width, if there is one in this clock.
  bool take(int64_t clock, int64_t width) {
    if (board_) return take_on_board(clock, width);
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
  // Pixels of a row that lie in so many words; groups in registers each way, and clocks until its pixels can be taken.
  static constexpr int64_t kGroupPixels = 7, kGroupWords = 4, kWaitingGroups = 3, kGroupClocks = 2;
  struct Burst {
    int64_t clock, px;
  };

  static int64_t row_words(int64_t width) { return (width + kGroupPixels - 1) / kGroupPixels * kGroupWords; }

  bool take_on_board(int64_t clock, int64_t width) {
    if (static_cast<int64_t>(groups_.size()) < kWaitingGroups && board_->levels.take(edges_.ps(clock))) {
      board_->levels.leave(edges_.ps(clock));
      if (++fetched_words_ % kGroupWords == 0) groups_.push_back(clock + kGroupClocks);
    }
    if (offered_px_ == 0) {
      if (groups_.empty() || groups_.front() > clock) return false;
      groups_.pop_front();
      offered_px_ = std::min(kGroupPixels, width - column_);
    }
    --offered_px_;
    column_ = (column_ + 1) % width;
    return true;
  }

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
  int64_t waiting_words_ = 0, stored_words_ = 0, level_words_ = 0, fetched_words_ = 0, column_ = 0;
  std::deque<int64_t> groups_;  // clocks from which on they can be taken
};

}  // namespace vista

#endif
