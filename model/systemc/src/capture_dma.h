// Writes what the cameras send into a captured buffer, left image then right, burst by burst. A frame that finds no buffer,
// or that memory does not take in time, is dropped as a whole.
#ifndef VISTA_SYSTEM_CAPTURE_DMA_H
#define VISTA_SYSTEM_CAPTURE_DMA_H

#include <cstdint>
#include <deque>
#include <systemc>

#include "buffer_pool.h"
#include "camera.h"
#include "configuration.h"
#include "images.h"
#include "memory.h"

namespace vista {

class CaptureDma : public sc_core::sc_module, public VideoSink {
 public:
  CaptureDma(const sc_core::sc_module_name& name, const Configuration& configuration, const Images& images,
             Memory& memory, BufferPool& captured, FrameLog& log);

  void frame_begins(int64_t frame) override;
  void pixels_come(int64_t frame, int64_t first, int64_t count) override;

  int64_t high_water_bytes() const { return high_water_; }

 private:
  struct Chunk {
    Buffer* buffer;
    int64_t first, count;  // px; a count of 0 gives a frame up
  };
  void run();

  const Images& images_;
  Master master_;
  BufferPool& captured_;
  FrameLog& log_;
  int64_t pixels_, fifo_bytes_;
  Buffer* filling_ = nullptr;  // of the frame that comes in; null: it is dropped
  Pair pair_;  // of the frame being written
  int64_t pair_frame_ = -1;
  std::deque<Chunk> chunks_;
  int64_t held_ = 0, high_water_ = 0;  // bytes
  sc_core::sc_event came_;
};

}  // namespace vista

#endif
