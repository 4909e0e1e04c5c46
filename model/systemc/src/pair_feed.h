// The pairs of a board's own cameras, straight into its engine: rtl/board/gateware/cameras.py and the part of runner.py
// that takes them. A pair waits in the FIFOs behind the cameras until the engine has finished the one before.
#ifndef VISTA_SYSTEM_PAIR_FEED_H
#define VISTA_SYSTEM_PAIR_FEED_H

#include <cstdint>
#include <systemc>

#include "board_memory.h"
#include "buffer_pool.h"
#include "configuration.h"
#include "result_dma.h"
#include "stream.h"
#include "timing.h"

namespace vista {

class PairFeed : public sc_core::sc_module, public PixelSource {
 public:
  PairFeed(const sc_core::sc_module_name& name, const Configuration& configuration, BufferPool& results,
           ResultDma& result_dma, FrameLog& log, BoardMemory& board);

  bool pixel_valid(int64_t clock) override;
  void pixel_taken(int64_t clock) override;
  int64_t next_pixel(int64_t clock) override;

 private:
  void run();
  // The clock in which a pixel of the pair that is taken can be, if those before it have been.
  int64_t clock_of(int64_t pixel) const;

  const Configuration configuration_;
  BufferPool& results_;
  ResultDma& result_dma_;
  FrameLog& log_;
  BoardMemory& board_;
  ClockEdges edges_;
  sc_core::sc_event begun_;
  TimedQueue<int64_t> sent_;  // pairs
  int64_t frame_ = 0, start_clock_ = 0, pixel_ = 0, left_px_ = 0;
  bool overflowed_ = false;
};

}  // namespace vista

#endif
