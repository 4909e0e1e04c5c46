#include "fetch_dma.h"

#include <algorithm>
#include <cstring>

#include "wire.h"

namespace vista {
namespace {

constexpr int64_t kChunkPixels = WIRE_CHUNK_BYTES / 2;  // of a board

}  // namespace

FetchDma::FetchDma(const sc_core::sc_module_name& name, const Configuration& c, int lane, Memory& memory,
                   BufferPool& pairs, BufferPool& results, ResultDma& result_dma, FrameLog& log, BoardMemory* board)
    : sc_module(name),
      lane_(lane),
      master_("fetch" + std::to_string(lane), memory, kFetchRank),
      pairs_(pairs),
      results_(results),
      result_dma_(result_dma),
      log_(log),
      edges_(c.engine_clock_hz),
      word_engine_(c.engine_parameters(), static_cast<int>(c.width_px), static_cast<int>(c.height_px)),
      compute_words_(c.compute_words),
      one_at_a_time_(c.has_board()),
      pixels_(c.pixels()),
      result_px_(c.result_px()),
      burst_px_(c.burst_bytes),
      fifo_px_(c.dma_fifo_bytes / 2),
      left_(static_cast<size_t>(c.pixels())),
      right_(left_.size()),
      board_(board) {
  SC_HAS_PROCESS(FetchDma);
  SC_THREAD(run);
}

void FetchDma::run() {
  for (;;) {
    while (!pairs_.any_waiting()) sc_core::wait(pairs_.changed());
    Buffer* result = results_.begin_writing(-1);
    if (!result) {
      sc_core::wait(results_.changed());
      continue;
    }
    Buffer& pair = *pairs_.begin_reading();
    result->frame = pair.frame;
    FrameEntry& entry = log_[pair.frame];
    entry.lane = lane_;
    entry.fetch_start = now_ps();
    result_dma_.expect(job(pair, *result));
    if (board_)
      fetch_on_board(pair);
    else
      fetch(pair);
    while (one_at_a_time_ && entry.result_end < 0) sc_core::wait(results_.changed());
    pairs_.release(pair);
  }
}

// The words are computed when the frame begins, from the memory that is about to be read: the engine's first words leave
// long before its last pixel comes. `fetch` then makes sure that what is read is what was seen.
ResultDma::Job FetchDma::job(const Buffer& pair, Buffer& result) {
  master_.peek(pair.address, left_.data(), pixels_);
  master_.peek(pair.address + pixels_, right_.data(), pixels_);
  return {&result, compute_words_ ? word_engine_.compute(left_.data(), right_.data())
                                  : std::vector<uint32_t>(static_cast<size_t>(result_px_))};
}

void FetchDma::fetch(const Buffer& pair) {
  std::vector<uint8_t> left(static_cast<size_t>(burst_px_)), right(left.size());
  for (int64_t first = 0; first < pixels_; first += burst_px_) {
    const int64_t count = std::min(burst_px_, pixels_ - first);
    taken_.drain(now_ps(), [&](int64_t px) { claimed_px_ -= px; });
    while (claimed_px_ + count > fifo_px_) claimed_px_ -= taken_.pop();
    claimed_px_ += count;
    high_water_px_ = std::max(high_water_px_, claimed_px_);
    master_.read(pair.address + first, left.data(), count);
    const int64_t done = master_.read(pair.address + pixels_ + first, right.data(), count);
    const size_t bytes = static_cast<size_t>(count);
    if (std::memcmp(left.data(), left_.data() + first, bytes) != 0 ||
        std::memcmp(right.data(), right_.data() + first, bytes) != 0)
      SC_REPORT_FATAL(name(), "a buffer changed while it was read");
    arriving_.push_back({edges_.at_or_after(done), count});
    arrival_.notify(sc_core::SC_ZERO_TIME);
  }
}

// Two pixels to a word, and whole chunks; what fills the last one is dropped, a word a clock.
void FetchDma::fetch_on_board(const Buffer& pair) {
  const int64_t words = (pixels_ + kChunkPixels - 1) / kChunkPixels * (kChunkPixels / 2);
  board_->advance(now_ps());
  board_->pixels.read(BoardMemory::pixels_of(pairs_.number(pair)), words);
  left_px_ = pixels_;
  arrival_.notify(sc_core::SC_ZERO_TIME);
  sent_.pop();
  for (int64_t filling = words - (pixels_ + 1) / 2; filling > 0; board_->pass(1)) {
    if (!board_->pixels.take(now_ps())) continue;
    board_->pixels.leave(now_ps());
    --filling;
  }
}

bool FetchDma::pixel_valid(int64_t clock) {
  if (offered_ > 0) return true;
  if (board_) {
    if (left_px_ == 0 || !board_->pixels.take(edges_.ps(clock))) return false;
    offered_ = std::min<int64_t>(2, left_px_);
    return true;
  }
  if (arriving_.empty()) wait_until(edges_.ps(clock));
  if (arriving_.empty() || arriving_.front().clock > clock) return false;
  offered_ = offered_burst_ = arriving_.front().pixels;
  arriving_.pop_front();
  return true;
}

void FetchDma::pixel_taken(int64_t clock) {
  if (board_) {
    if (--offered_ == 0) board_->pixels.leave(edges_.ps(clock));
    if (--left_px_ == 0) sent_.push(edges_.ps(clock), 0);
    return;
  }
  if (--offered_ == 0) taken_.push(edges_.ps(clock), offered_burst_);
}

int64_t FetchDma::next_pixel(int64_t clock) {
  if (board_) {
    while (left_px_ == 0) sc_core::wait(arrival_);
    return std::max(clock, edges_.at_or_after(now_ps()));
  }
  while (arriving_.empty()) sc_core::wait(arrival_);
  return std::max(clock, arriving_.front().clock);
}

}  // namespace vista
