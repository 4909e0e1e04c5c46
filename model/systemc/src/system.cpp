#include "system.h"

#include <string>

namespace vista {
namespace {

// Memory, from address 0: captured pairs, rectified pairs, results; of a board: received pairs, results, the buffer of
// the pyramid. The host of a board has captured pairs and fetched results in a memory of its own.
int64_t count(const Configuration& c) { return c.buffers + c.lanes - 1; }
int64_t engine_count(const Configuration& c) { return c.has_board() ? Link::kFrames : count(c); }
int64_t pair_bytes(const Configuration& c) { return 2 * c.pixels(); }
int64_t result_bytes(const Configuration& c) { return c.result_bytes_px * c.result_px(); }
int64_t rectified_address(const Configuration& c) { return engine_count(c) * pair_bytes(c); }
int64_t result_address(const Configuration& c) {
  return rectified_address(c) + (c.rectify_ms.empty() ? 0 : count(c) * pair_bytes(c));
}
int64_t level_address(const Configuration& c) { return result_address(c) + engine_count(c) * result_bytes(c); }
int64_t memory_bytes(const Configuration& c) { return level_address(c) + c.burst_bytes; }
int64_t host_bytes(const Configuration& c) { return count(c) * (pair_bytes(c) + result_bytes(c)); }

std::unique_ptr<BufferPool> rectified_pool(const Configuration& c, FrameLog& log) {
  if (c.rectify_ms.empty()) return nullptr;
  return std::make_unique<BufferPool>(count(c), pair_bytes(c), rectified_address(c), c.latest, Drop::kRectifiedReplaced,
                                      log);
}

// Nothing that is on a board is taken back.
std::unique_ptr<BufferPool> received_pool(const Configuration& c, FrameLog& log) {
  if (!c.has_board()) return nullptr;
  return std::make_unique<BufferPool>(Link::kFrames, pair_bytes(c), 0, false, Drop::kReplaced, log);
}

std::unique_ptr<BufferPool> fetched_pool(const Configuration& c, FrameLog& log) {
  if (!c.has_board()) return nullptr;
  return std::make_unique<BufferPool>(count(c), result_bytes(c), count(c) * pair_bytes(c), c.latest,
                                      Drop::kResultReplaced, log);
}

// The host's memory beside a board's: fast enough not to count.
std::unique_ptr<Memory> memory_at_host(Configuration c) {
  if (!c.has_board()) return nullptr;
  c.memory_bandwidth_bytes_s = 1e12;
  c.memory_latency_ns = c.memory_burst_overhead_ns = 0;
  return std::make_unique<Memory>("host_memory", c, host_bytes(c));
}

}  // namespace

System::System(const sc_core::sc_module_name& name, const Configuration& c, std::ostream* words_out)
    : sc_module(name),
      configuration(c),
      log(c.frames),
      images(c),
      memory("memory", c, memory_bytes(c)),
      board_memory(c.has_board() ? std::make_unique<BoardMemory>("board_memory", c) : nullptr),
      host_memory(memory_at_host(c)),
      captured(count(c), pair_bytes(c), 0, c.latest, Drop::kReplaced, log),
      received(received_pool(c, log)),
      rectified(rectified_pool(c, log)),
      results(engine_count(c), result_bytes(c), result_address(c), c.latest && !c.has_board(), Drop::kResultReplaced,
              log),
      fetched(fetched_pool(c, log)),
      link(make_link()),
      camera(c.board_cameras ? nullptr : std::make_unique<Camera>("camera", c)),
      capture_dma(c.board_cameras
                      ? nullptr
                      : std::make_unique<CaptureDma>("capture_dma", c, images, memory_of_host(), captured, log)),
      rectifier(rectified ? std::make_unique<Rectifier>("rectifier", configuration, memory, captured, *rectified,
                                                        c.host_cores == 2 ? rectify_core : host_core, log)
                          : nullptr),
      lanes(make_lanes()),
      host("host", configuration, memory_of_host(), fetched ? *fetched : results, host_core, log, words_out),
      background(c.background_bytes_s > 0 ? std::make_unique<Background>("background", c, memory) : nullptr) {
  if (camera) camera->video(*capture_dma);
}

std::unique_ptr<Link> System::make_link() {
  if (!host_memory) return nullptr;
  return std::make_unique<Link>("link", configuration,
                                LinkEnds{*host_memory, memory, *board_memory, captured, *received, results, *fetched});
}

std::vector<Lane> System::make_lanes() {
  const Configuration& c = configuration;
  BufferPool& pairs = received ? *received : rectified ? *rectified : captured;
  std::vector<Lane> made(static_cast<size_t>(c.lanes));
  for (int i = 0; i < static_cast<int>(c.lanes); ++i) {
    Lane& lane = made[static_cast<size_t>(i)];
    const std::string n = std::to_string(i);
    lane.engine = std::make_unique<Engine>(("engine" + n).c_str(), c.build(), c.level_sizes());
    lane.result_dma = std::make_unique<ResultDma>(("result_dma" + n).c_str(), c, i, *lane.engine, memory, results, log,
                                                  board_memory.get());
    if (c.board_cameras)
      lane.pair_feed = std::make_unique<PairFeed>("pair_feed", c, results, *lane.result_dma, log, *board_memory);
    else
      lane.fetch_dma = std::make_unique<FetchDma>(("fetch_dma" + n).c_str(), c, i, memory, pairs, results,
                                                  *lane.result_dma, log, board_memory.get());
    PixelSource& source = lane.pair_feed ? static_cast<PixelSource&>(*lane.pair_feed) : *lane.fetch_dma;
    if (c.rectify_rows > 0) {
      lane.front_end =
          std::make_unique<FrontEnd>(("front_end" + n).c_str(), c, memory, level_address(c), board_memory.get());
      lane.front_end->raw(source);
      lane.engine->pixels(*lane.front_end);
    } else {
      lane.engine->pixels(source);
    }
    lane.engine->words(*lane.result_dma);
  }
  return made;
}

}  // namespace vista
