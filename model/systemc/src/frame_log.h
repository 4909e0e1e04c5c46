// What became of every frame.
#ifndef VISTA_SYSTEM_FRAME_LOG_H
#define VISTA_SYSTEM_FRAME_LOG_H

#include <cstdint>
#include <systemc>
#include <vector>

#include "engine.h"

namespace vista {

enum class Drop { kNone, kNoBuffer, kOverflow, kReplaced, kRectifiedReplaced, kResultReplaced, kCount };

inline const char* drop_name(Drop drop) {
  static const char* const names[] = {"", "no_buffer", "overflow", "replaced", "rectified_replaced", "result_replaced"};
  return names[static_cast<int>(drop)];
}

// Times in ps from the start of the simulation, below 0: never.
struct FrameEntry {
  Drop drop = Drop::kNone;
  int lane = -1;
  int64_t capture_start = -1, capture_end = -1;
  int64_t rectify_start = -1, rectify_end = -1;
  int64_t fetch_start = -1, result_end = -1;
  const FrameClocks* engine = nullptr;  // kept by the engine; null: no word came out
  int64_t host_start = -1, host_read_end = -1, host_end = -1;
  std::vector<double> stage_ms;
  bool summed = false;
  uint32_t crc32 = 0;
};

class FrameLog {
 public:
  explicit FrameLog(int64_t frames) : entries_(static_cast<size_t>(frames)) {}

  FrameEntry& operator[](int64_t frame) { return entries_[static_cast<size_t>(frame)]; }
  const std::vector<FrameEntry>& entries() const { return entries_; }

  void drop(int64_t frame, Drop why) {
    (*this)[frame].drop = why;
    settle();
  }
  void delivered() { settle(); }

 private:
  // The simulation ends with the last frame that was dropped or came through.
  void settle() {
    if (++settled_ == entries_.size()) sc_core::sc_stop();
  }

  std::vector<FrameEntry> entries_;
  size_t settled_ = 0;
};

}  // namespace vista

#endif
