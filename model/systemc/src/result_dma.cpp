#include "result_dma.h"

#include <algorithm>
#include <cstring>
#include <utility>

namespace vista {
namespace {

constexpr int64_t kBoardWordBytes = 4;

}  // namespace

ResultDma::ResultDma(const sc_core::sc_module_name& name, const Configuration& c, int lane, const Engine& engine,
                     Memory& memory, BufferPool& results, FrameLog& log, BoardMemory* board)
    : sc_module(name),
      engine_(engine),
      master_("result" + std::to_string(lane), memory, kResultRank),
      results_(results),
      log_(log),
      edges_(c.engine_clock_hz),
      pixels_(c.result_px()),
      bytes_per_word_(c.result_bytes_px),
      burst_words_(c.burst_bytes / c.result_bytes_px),
      fifo_words_(c.dma_fifo_bytes / c.result_bytes_px),
      board_(board),
      levels_(c.level_sizes()) {
  SC_HAS_PROCESS(ResultDma);
  SC_THREAD(run);
}

void ResultDma::expect(Job job) {
  jobs_.push_back(std::move(job));
  expected_.notify(sc_core::SC_ZERO_TIME);
}

bool ResultDma::word_ready(int64_t clock) {
  if (board_) return !completes_word() || board_->words.has_room(edges_.ps(clock));
  const auto leaves = [&](int64_t words) { held_words_ -= words; };
  if (held_words_ < fifo_words_) return true;
  wait_until(edges_.ps(clock));
  written_.drain(edges_.ps(clock), leaves);
  return held_words_ < fifo_words_;
}

void ResultDma::word_taken(int64_t clock) {
  if (board_) {
    word_on_board(clock);
    return;
  }
  ++held_words_;
  ++burst_fill_;
  if (++frame_fill_ == pixels_) frame_fill_ = 0;
  if (burst_fill_ < burst_words_ && frame_fill_ != 0) return;
  filled_.push(edges_.ps(clock), burst_fill_);
  burst_fill_ = 0;
  written_.drain(edges_.ps(clock), [&](int64_t words) { held_words_ -= words; });
  high_water_words_ = std::max(high_water_words_, held_words_);
}

// Whether a word is complete, as Configuration::result_words counts.
bool ResultDma::completes_word() const {
  return bytes_per_word_ == kBoardWordBytes || column_ % 2 == 1 || column_ + 1 == levels_[level_].width;
}

void ResultDma::word_on_board(int64_t clock) {
  if (completes_word()) board_->words.write(edges_.ps(clock), address_++);
  if (++column_ < levels_[level_].width) return;
  column_ = 0;
  if (++row_ < levels_[level_].height) return;
  row_ = 0;
  level_ = (level_ + 1) % levels_.size();
  if (level_ == 0) filled_.push(edges_.ps(clock), pixels_);
}

void ResultDma::run() {
  for (;;) {
    while (jobs_.empty()) sc_core::wait(expected_);
    const Job job = std::move(jobs_.front());
    jobs_.pop_front();
    write(job);
    FrameEntry& entry = log_[job.buffer->frame];
    entry.result_end = now_ps();
    entry.engine = &engine_.frame(frames_++);
    if (entry.drop == Drop::kNone)
      results_.publish(*job.buffer);
    else
      results_.release(*job.buffer);
  }
}

// The bytes as they lie in memory: little endian, the disparity comes first.
std::vector<uint8_t> ResultDma::bytes_of(const Job& job, int64_t first, int64_t count) const {
  std::vector<uint8_t> bytes(static_cast<size_t>(count * bytes_per_word_));
  for (int64_t i = 0; i < count; ++i)
    std::memcpy(bytes.data() + i * bytes_per_word_, &job.words[static_cast<size_t>(first + i)],
                static_cast<size_t>(bytes_per_word_));
  return bytes;
}

void ResultDma::write(const Job& job) {
  if (board_) {
    address_ = BoardMemory::words_of(results_.number(*job.buffer));
    filled_.pop();
    board_->words.wait_until_idle();
    master_.poke(job.buffer->address, bytes_of(job, 0, pixels_).data(), pixels_ * bytes_per_word_);
    return;
  }
  int64_t done = 0;
  for (int64_t first = 0; first < pixels_;) {
    const int64_t count = filled_.pop();
    done = master_.write(job.buffer->address + first * bytes_per_word_, bytes_of(job, first, count).data(),
                         count * bytes_per_word_);
    written_.push(done, count);
    first += count;
  }
  wait_until(done);
}

}  // namespace vista
