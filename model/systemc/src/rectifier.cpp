#include "rectifier.h"

#include <algorithm>
#include <vector>

#include "timing.h"

namespace vista {

Rectifier::Rectifier(const sc_core::sc_module_name& name, const Configuration& c, Memory& memory, BufferPool& captured,
                     BufferPool& rectified, HostCore& core, FrameLog& log)
    : sc_module(name),
      configuration_(c),
      master_("rectify", memory, kRectifyRank),
      captured_(captured),
      rectified_(rectified),
      core_(core),
      log_(log) {
  SC_HAS_PROCESS(Rectifier);
  SC_THREAD(run);
}

void Rectifier::run() {
  for (;;) {
    while (!captured_.any_waiting()) sc_core::wait(captured_.changed());
    core_.acquire();
    Buffer* to = captured_.any_waiting() ? rectified_.begin_writing(-1) : nullptr;
    if (!to) {
      core_.release();
      sc_core::wait(captured_.changed() | rectified_.changed());
      continue;
    }
    Buffer& from = *captured_.begin_reading();
    to->frame = from.frame;
    FrameEntry& entry = log_[from.frame];
    entry.rectify_start = now_ps();
    copy(from, *to);
    entry.rectify_end = now_ps();
    busy_ps_ += entry.rectify_end - entry.rectify_start;
    core_.release();
    captured_.release(from);
    rectified_.publish(*to);
  }
}

void Rectifier::copy(const Buffer& from, const Buffer& to) {
  const int64_t start = now_ps(), bytes = 2 * configuration_.pixels(), burst = configuration_.burst_bytes;
  const double ps = stage_ms(configuration_.rectify_ms, configuration_.seed, from.frame) * 1e9;
  std::vector<uint8_t> data(static_cast<size_t>(burst));
  for (int64_t first = 0; first < bytes; first += burst) {
    const int64_t count = std::min(burst, bytes - first);
    wait_until(master_.read(from.address + first, data.data(), count));
    wait_until(master_.write(to.address + first, data.data(), count));
    wait_until(start + static_cast<int64_t>(ps * static_cast<double>(first + count) / static_cast<double>(bytes)));
  }
}

}  // namespace vista
