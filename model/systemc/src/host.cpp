#include "host.h"

#include <algorithm>
#include <array>
#include <vector>

#include "timing.h"

namespace vista {
namespace {

// CRC-32 of IEEE 802.3, as zlib's.
uint32_t crc32(const std::vector<uint8_t>& bytes) {
  static const auto table = [] {
    std::array<uint32_t, 256> entries{};
    for (uint32_t i = 0; i < 256; ++i) {
      uint32_t c = i;
      for (int bit = 0; bit < 8; ++bit) c = c >> 1 ^ ((c & 1) != 0 ? 0xEDB88320u : 0u);
      entries[i] = c;
    }
    return entries;
  }();
  uint32_t crc = ~0u;
  for (const uint8_t byte : bytes) crc = crc >> 8 ^ table[(crc ^ byte) & 0xFF];
  return ~crc;
}

}  // namespace

Host::Host(const sc_core::sc_module_name& name, const Configuration& c, Memory& memory, BufferPool& results,
           HostCore& core, FrameLog& log, std::ostream* words_out)
    : sc_module(name),
      configuration_(c),
      master_("host", memory, kHostRank),
      results_(results),
      core_(core),
      log_(log),
      words_out_(words_out) {
  SC_HAS_PROCESS(Host);
  SC_THREAD(run);
}

void Host::run() {
  for (;;) {
    while (!results_.any_waiting()) sc_core::wait(results_.changed());
    core_.acquire();
    Buffer* result = results_.begin_reading();
    if (!result) {  // taken back meanwhile
      core_.release();
      continue;
    }
    FrameEntry& entry = log_[result->frame];
    entry.host_start = now_ps();
    read(*result);
    entry.host_read_end = now_ps();
    for (const StageSamples& stage : configuration_.host_stages) {
      entry.stage_ms.push_back(stage_ms(stage.ms, configuration_.seed, result->frame));
      wait_until(now_ps() + static_cast<int64_t>(entry.stage_ms.back() * 1e9));
    }
    entry.host_end = now_ps();
    busy_ps_ += entry.host_end - entry.host_start;
    core_.release();
    results_.release(*result);
    log_.delivered();
  }
}

void Host::read(const Buffer& result) {
  std::vector<uint8_t> bytes(static_cast<size_t>(configuration_.result_px() * configuration_.result_bytes_px));
  const int64_t burst = configuration_.burst_bytes, size = static_cast<int64_t>(bytes.size());
  int64_t done = now_ps();
  for (int64_t first = 0; first < size; first += burst)
    done = master_.read(result.address + first, bytes.data() + first, std::min(burst, size - first));
  wait_until(done);
  if (!configuration_.compute_words) return;
  FrameEntry& entry = log_[result.frame];
  entry.summed = true;
  entry.crc32 = crc32(bytes);
  if (words_out_) words_out_->write(reinterpret_cast<const char*>(bytes.data()), size);
}

}  // namespace vista
