// Reads captured (or rectified) pairs for one engine and offers them as its pixels. Also the lane's dispatcher: it takes
// the next frame when it is free and a result buffer is to be had.
#ifndef VISTA_SYSTEM_FETCH_DMA_H
#define VISTA_SYSTEM_FETCH_DMA_H

#include <cstdint>
#include <deque>
#include <systemc>

#include "board_memory.h"
#include "buffer_pool.h"
#include "configuration.h"
#include "memory.h"
#include "result_dma.h"
#include "stream.h"
#include "timing.h"
#include "words.h"

namespace vista {

class FetchDma : public sc_core::sc_module, public PixelSource {
 public:
  FetchDma(const sc_core::sc_module_name& name, const Configuration& configuration, int lane, Memory& memory,
           BufferPool& pairs, BufferPool& results, ResultDma& result_dma, FrameLog& log, BoardMemory* board);

  bool pixel_valid(int64_t clock) override;
  void pixel_taken(int64_t clock) override;
  int64_t next_pixel(int64_t clock) override;

  int64_t high_water_bytes() const { return 2 * high_water_px_; }

 private:
  struct Burst {
    int64_t clock, pixels;  // at the engine from that clock on
  };
  void run();
  void fetch(const Buffer& pair);
  void fetch_on_board(const Buffer& pair);
  ResultDma::Job job(const Buffer& pair, Buffer& result);

  int lane_;
  Master master_;
  BufferPool &pairs_, &results_;
  ResultDma& result_dma_;
  FrameLog& log_;
  ClockEdges edges_;
  WordEngine word_engine_;
  bool compute_words_, one_at_a_time_;  // the next frame begins when all words of this one are in memory
  int64_t pixels_, result_px_, burst_px_, fifo_px_;
  std::vector<uint8_t> left_, right_;  // of the frame being fetched, by looking ahead
  std::deque<Burst> arriving_;
  sc_core::sc_event arrival_;
  TimedQueue<int64_t> taken_;  // pixels of bursts that the engine has used up
  int64_t offered_ = 0, offered_burst_ = 0;  // px left of the burst being taken, and in it at first
  int64_t claimed_px_ = 0, high_water_px_ = 0;
  BoardMemory* board_;  // null: not on a board
  int64_t left_px_ = 0;  // of the frame on a board, that were not offered yet
  TimedQueue<int64_t> sent_;  // frames of a board
};

}  // namespace vista

#endif
