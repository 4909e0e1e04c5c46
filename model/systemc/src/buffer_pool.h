// The buffers between a writer of frames and its readers: double or triple buffering.
//
// Frames are read in the order of their numbers. A writer that finds no buffer free may take back the oldest frame that
// waits (policy `latest`), which drops it.
#ifndef VISTA_SYSTEM_BUFFER_POOL_H
#define VISTA_SYSTEM_BUFFER_POOL_H

#include <algorithm>
#include <cstdint>
#include <systemc>
#include <vector>

#include "frame_log.h"

namespace vista {

struct Buffer {
  int64_t address = 0, frame = -1;
  enum class State { kFree, kWriting, kWaiting, kReading } state = State::kFree;
};

class BufferPool {
 public:
  BufferPool(int64_t count, int64_t bytes, int64_t address, bool latest, Drop replaced, FrameLog& log)
      : latest_(latest), replaced_(replaced), log_(log) {
    for (int64_t i = 0; i < count; ++i) buffers_.push_back({address + i * bytes, -1, Buffer::State::kFree});
  }

  // Null when there is none to be had; `changed` tells when to try again.
  Buffer* begin_writing(int64_t frame) {
    Buffer* buffer = first(Buffer::State::kFree);
    if (!buffer && latest_ && (buffer = first(Buffer::State::kWaiting))) log_.drop(buffer->frame, replaced_);
    if (buffer) {
      buffer->frame = frame;
      move(*buffer, Buffer::State::kWriting);
    }
    return buffer;
  }
  void publish(Buffer& buffer) { move(buffer, Buffer::State::kWaiting); }

  bool any_waiting() const {
    return std::any_of(buffers_.begin(), buffers_.end(),
                       [](const Buffer& b) { return b.state == Buffer::State::kWaiting; });
  }
  // The oldest frame that waits; null when none does.
  Buffer* begin_reading() {
    Buffer* buffer = first(Buffer::State::kWaiting);
    if (buffer) move(*buffer, Buffer::State::kReading);
    return buffer;
  }

  int64_t number(const Buffer& buffer) const { return &buffer - buffers_.data(); }

  void release(Buffer& buffer) { move(buffer, Buffer::State::kFree); }

  const sc_core::sc_event& changed() const { return changed_; }
  int64_t count() const { return static_cast<int64_t>(buffers_.size()); }
  int64_t high_water() const { return high_water_; }

 private:
  Buffer* first(Buffer::State state) {
    Buffer* found = nullptr;
    for (Buffer& buffer : buffers_)
      if (buffer.state == state && (!found || buffer.frame < found->frame)) found = &buffer;
    return found;
  }

  void move(Buffer& buffer, Buffer::State state) {
    buffer.state = state;
    const auto used = std::count_if(buffers_.begin(), buffers_.end(),
                                    [](const Buffer& b) { return b.state != Buffer::State::kFree; });
    high_water_ = std::max<int64_t>(high_water_, used);
    changed_.notify(sc_core::SC_ZERO_TIME);
  }

  std::vector<Buffer> buffers_;
  bool latest_;
  Drop replaced_;
  FrameLog& log_;
  int64_t high_water_ = 0;
  sc_core::sc_event changed_;
};

}  // namespace vista

#endif
