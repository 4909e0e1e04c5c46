#include "system.h"

#include <string>

namespace vista {
namespace {

// Memory, from address 0: captured pairs, rectified pairs, results.
int64_t count(const Configuration& c) { return c.buffers + c.lanes - 1; }
int64_t pair_bytes(const Configuration& c) { return 2 * c.pixels(); }
int64_t result_bytes(const Configuration& c) { return c.result_bytes_px * c.pixels(); }
int64_t rectified_address(const Configuration& c) { return count(c) * pair_bytes(c); }
int64_t result_address(const Configuration& c) {
  return rectified_address(c) + (c.rectify_ms.empty() ? 0 : count(c) * pair_bytes(c));
}
int64_t memory_bytes(const Configuration& c) {
  return std::max(result_address(c) + count(c) * result_bytes(c), c.burst_bytes);
}

std::unique_ptr<BufferPool> rectified_pool(const Configuration& c, FrameLog& log) {
  if (c.rectify_ms.empty()) return nullptr;
  return std::make_unique<BufferPool>(count(c), pair_bytes(c), rectified_address(c), c.latest, Drop::kRectifiedReplaced,
                                      log);
}

}  // namespace

System::System(const sc_core::sc_module_name& name, const Configuration& c, std::ostream* words_out)
    : sc_module(name),
      configuration(c),
      log(c.frames),
      images(c),
      memory("memory", c, memory_bytes(c)),
      captured(count(c), pair_bytes(c), 0, c.latest, Drop::kReplaced, log),
      rectified(rectified_pool(c, log)),
      results(count(c), result_bytes(c), result_address(c), c.latest, Drop::kResultReplaced, log),
      camera("camera", c),
      capture_dma("capture_dma", c, images, memory, captured, log),
      rectifier(rectified ? std::make_unique<Rectifier>("rectifier", configuration, memory, captured, *rectified,
                                                        c.host_cores == 2 ? rectify_core : host_core, log)
                          : nullptr),
      lanes(make_lanes()),
      host("host", configuration, memory, results, host_core, log, words_out),
      background(c.background_bytes_s > 0 ? std::make_unique<Background>("background", c, memory) : nullptr) {
  camera.video(capture_dma);
}

std::vector<Lane> System::make_lanes() {
  const Configuration& c = configuration;
  const clocks::Size size{static_cast<int>(c.width_px), static_cast<int>(c.height_px)};
  BufferPool& pairs = rectified ? *rectified : captured;
  std::vector<Lane> made(static_cast<size_t>(c.lanes));
  for (int i = 0; i < static_cast<int>(c.lanes); ++i) {
    Lane& lane = made[static_cast<size_t>(i)];
    const std::string n = std::to_string(i);
    lane.engine = std::make_unique<Engine>(("engine" + n).c_str(), c.build(), size);
    lane.result_dma = std::make_unique<ResultDma>(("result_dma" + n).c_str(), c, i, *lane.engine, memory, results, log);
    lane.fetch_dma =
        std::make_unique<FetchDma>(("fetch_dma" + n).c_str(), c, i, memory, pairs, results, *lane.result_dma, log);
    lane.engine->pixels(*lane.fetch_dma);
    lane.engine->words(*lane.result_dma);
  }
  return made;
}

}  // namespace vista
