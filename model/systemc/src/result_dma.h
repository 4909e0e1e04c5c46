// Takes the words of one engine and writes them to the result buffers of its frames.
#ifndef VISTA_SYSTEM_RESULT_DMA_H
#define VISTA_SYSTEM_RESULT_DMA_H

#include <cstdint>
#include <deque>
#include <systemc>
#include <vector>

#include "board_memory.h"
#include "buffer_pool.h"
#include "configuration.h"
#include "engine.h"
#include "memory.h"
#include "stream.h"
#include "timing.h"

namespace vista {

class ResultDma : public sc_core::sc_module, public WordSink {
 public:
  struct Job {
    Buffer* buffer;
    std::vector<uint32_t> words;  // that the engine will send
  };

  ResultDma(const sc_core::sc_module_name& name, const Configuration& configuration, int lane, const Engine& engine,
            Memory& memory, BufferPool& results, FrameLog& log, BoardMemory* board);

  // Announces the next frame of this lane.
  void expect(Job job);

  bool word_ready(int64_t clock) override;
  void word_taken(int64_t clock) override;

  int64_t high_water_bytes() const { return high_water_words_ * bytes_per_word_; }

 private:
  void run();
  bool completes_word() const;  // of a board's memory, with the next one of the engine
  void word_on_board(int64_t clock);
  void write(const Job& job);
  std::vector<uint8_t> bytes_of(const Job& job, int64_t first, int64_t count) const;

  const Engine& engine_;
  Master master_;
  BufferPool& results_;
  FrameLog& log_;
  ClockEdges edges_;
  int64_t pixels_, bytes_per_word_, burst_words_, fifo_words_;
  std::deque<Job> jobs_;
  sc_core::sc_event expected_;
  TimedQueue<int64_t> filled_;   // words of bursts that the engine has sent
  TimedQueue<int64_t> written_;  // words of bursts that memory has taken
  int64_t held_words_ = 0;       // as the engine sees it
  int64_t burst_fill_ = 0, frame_fill_ = 0, high_water_words_ = 0;
  size_t frames_ = 0;  // written
  BoardMemory* board_;  // null: not on a board
  int64_t address_ = 0;  // of the next word on a board
  std::vector<clocks::Size> levels_;
  size_t level_ = 0;
  int64_t column_ = 0, row_ = 0;
};

}  // namespace vista

#endif
