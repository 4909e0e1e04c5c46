#include "report.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "json.h"
#include "timing.h"
#include "unstalled.h"

namespace vista {
namespace {

std::string count(int64_t value) { return std::to_string(value); }
std::string ns(int64_t ps) { return ps < 0 ? "null" : json_number(static_cast<double>(ps) / 1e3); }
std::string ratio(int64_t part, int64_t whole) {
  return json_number(whole > 0 ? static_cast<double>(part) / static_cast<double>(whole) : 0);
}

std::string configuration(const Configuration& c) {
  JsonItems items = listed(c), stages;
  for (const StageSamples& stage : c.host_stages) stages.emplace_back(stage.name, json_series(stage.ms));
  items.emplace_back("host_stage", json_object(stages));
  return json_object(items);
}

std::string camera(const Configuration& c) {
  return json_object({{"period_ns", json_number(c.period_ns())},
                      {"readout_ns", json_number(c.readout_ns())},
                      {"line_ns", json_number(c.line_ns())}});
}

std::string engine(const Configuration& c) {
  const Unstalled u = run_unstalled(c.build(), {static_cast<int>(c.width_px), static_cast<int>(c.height_px)});
  return json_object({{"clocks_per_frame", count(u.clocks_per_frame)},
                      {"first_word_clocks", count(u.first_word_clocks)},
                      {"pipeline_clocks", json_count_or_null(u.pipeline_clocks)}});
}

std::string edge_ns(const ClockEdges& edges, int64_t clock) { return clock < 0 ? "null" : ns(edges.ps(clock)); }

std::string frame(const Configuration& c, int64_t number, const FrameEntry& f) {
  const ClockEdges edges(c.engine_clock_hz);
  JsonItems stages;
  for (size_t i = 0; i < f.stage_ms.size(); ++i) stages.emplace_back(c.host_stages[i].name, json_number(f.stage_ms[i]));
  char crc[16];
  std::snprintf(crc, sizeof crc, "%08x", f.crc32);
  const FrameClocks e = f.engine ? *f.engine : FrameClocks{};
  return json_object({{"frame", count(number)},
                      {"dropped", f.drop == Drop::kNone ? "null" : json_text(drop_name(f.drop))},
                      {"lane", json_count_or_null(f.lane)},
                      {"capture_start_ns", ns(f.capture_start)},
                      {"capture_end_ns", ns(f.capture_end)},
                      {"rectify_start_ns", ns(f.rectify_start)},
                      {"rectify_end_ns", ns(f.rectify_end)},
                      {"fetch_start_ns", ns(f.fetch_start)},
                      {"engine_start_ns", edge_ns(edges, e.first_pixel)},
                      {"engine_first_word_ns", edge_ns(edges, e.first_word)},
                      {"engine_last_word_ns", edge_ns(edges, e.last_word)},
                      {"engine_start_clock", json_count_or_null(e.first_pixel)},
                      {"engine_last_pixel_clock", json_count_or_null(e.last_pixel)},
                      {"engine_first_word_clock", json_count_or_null(e.first_word)},
                      {"engine_last_word_clock", json_count_or_null(e.last_word)},
                      {"stalls_in", count(e.stalls_in)},
                      {"stalls_out", count(e.stalls_out)},
                      {"starved", count(e.starved)},
                      {"result_end_ns", ns(f.result_end)},
                      {"host_start_ns", ns(f.host_start)},
                      {"host_end_ns", ns(f.host_end)},
                      {"host_read_ns", f.host_read_end < 0 ? "null" : ns(f.host_read_end - f.host_start)},
                      {"host_stages_ms", json_object(stages)},
                      {"words_crc32", f.summed ? json_text(crc) : "null"}});
}

struct EngineTotals {
  int64_t frames = 0, stalls_in = 0, stalls_out = 0, starved = 0, clocks_busy = 0;
};

EngineTotals totals_of(const System& s, int lane) {
  EngineTotals t;
  for (const FrameEntry& f : s.log.entries()) {
    if (f.lane != lane || !f.engine) continue;
    ++t.frames;
    t.stalls_in += f.engine->stalls_in;
    t.stalls_out += f.engine->stalls_out;
    t.starved += f.engine->starved;
  }
  t.clocks_busy = s.lanes[static_cast<size_t>(lane)].engine->clocks_busy();
  return t;
}

std::string totals(const System& s) {
  std::vector<int64_t> drops(static_cast<size_t>(Drop::kCount));
  for (const FrameEntry& f : s.log.entries()) ++drops[static_cast<size_t>(f.drop)];
  JsonItems reasons;
  for (size_t i = 1; i < drops.size(); ++i) reasons.emplace_back(drop_name(static_cast<Drop>(i)), count(drops[i]));
  EngineTotals sum;
  for (int i = 0; i < static_cast<int>(s.lanes.size()); ++i) {
    const EngineTotals t = totals_of(s, i);
    sum.stalls_in += t.stalls_in;
    sum.stalls_out += t.stalls_out;
    sum.starved += t.starved;
    sum.clocks_busy += t.clocks_busy;
  }
  const int64_t frames = static_cast<int64_t>(s.log.entries().size());
  return json_object({{"frames", count(frames)},
                      {"delivered", count(drops[0])},
                      {"dropped", count(frames - drops[0])},
                      {"drops", json_object(reasons)},
                      {"simulated_ns", ns(now_ps())},
                      {"engine_clocks_busy", count(sum.clocks_busy)},
                      {"stalls_in", count(sum.stalls_in)},
                      {"stalls_out", count(sum.stalls_out)},
                      {"starved", count(sum.starved)}});
}

std::string lanes(const System& s) {
  std::vector<std::string> values;
  const int64_t clocks = ClockEdges(s.configuration.engine_clock_hz).at_or_after(now_ps());
  for (int i = 0; i < static_cast<int>(s.lanes.size()); ++i) {
    const EngineTotals t = totals_of(s, i);
    values.push_back(json_object({{"frames", count(t.frames)},
                                  {"clocks_busy", count(t.clocks_busy)},
                                  {"utilisation", ratio(t.clocks_busy, clocks)},
                                  {"stalls_in", count(t.stalls_in)},
                                  {"stalls_out", count(t.stalls_out)},
                                  {"starved", count(t.starved)}}));
  }
  return json_list(values);
}

template <class Memory>
std::string memory(const Memory& m) {
  std::vector<std::string> masters;
  int64_t bytes = 0;
  for (const MasterCounts& master : m.masters()) {
    bytes += master.bytes;
    masters.push_back(json_object({{"name", json_text(master.name)},
                                   {"bytes", count(master.bytes)},
                                   {"bursts", count(master.bursts)},
                                   {"waited_ns", ns(master.waited_ps)}}));
  }
  return json_object({{"utilisation", ratio(m.busy_ps(), now_ps())},
                      {"bytes", count(bytes)},
                      {"busy_ns", ns(m.busy_ps())},
                      {"masters", json_list(masters)}});
}

std::string host(const System& s) {
  return json_object(
      {{"utilisation", ratio(s.host.busy_ps(), now_ps())},
       {"link_utilisation", s.link ? ratio(s.link->busy_ps(), now_ps()) : std::string("null")},
       {"rectify_utilisation", s.rectifier ? ratio(s.rectifier->busy_ps(), now_ps()) : std::string("null")}});
}

std::string pool(const BufferPool& p) {
  return json_object({{"count", count(p.count())}, {"high_water", count(p.high_water())}});
}

std::string fifo(int64_t bytes, int64_t high_water) {
  return json_object({{"bytes", count(bytes)}, {"high_water_bytes", count(high_water)}});
}

std::string buffers(const System& s) {
  const Configuration& c = s.configuration;
  int64_t fetch = 0, result = 0;
  for (const Lane& lane : s.lanes) {
    if (lane.fetch_dma) fetch = std::max(fetch, lane.fetch_dma->high_water_bytes());
    result = std::max(result, lane.result_dma->high_water_bytes());
  }
  return json_object(
      {{"captured", pool(s.captured)},
       {"rectified", s.rectified ? pool(*s.rectified) : "null"},
       {"result", pool(s.results)},
       {"capture_fifo", fifo(c.capture_fifo_bytes, s.capture_dma ? s.capture_dma->high_water_bytes() : 0)},
       {"fetch_fifo", fifo(c.dma_fifo_bytes, fetch)},
       {"result_fifo", fifo(c.dma_fifo_bytes, result)}});
}

}  // namespace

void write_report(const System& s, std::ostream& out) {
  std::vector<std::string> frames;
  int64_t number = 0;
  for (const FrameEntry& entry : s.log.entries()) frames.push_back(frame(s.configuration, number++, entry));
  out << "{\"version\": 1,\n \"config\": " << configuration(s.configuration)
      << ",\n \"camera\": " << camera(s.configuration) << ",\n \"engine\": " << engine(s.configuration)
      << ",\n \"frames\": " << json_list(frames, ",\n  ") << ",\n \"totals\": " << totals(s)
      << ",\n \"lanes\": " << lanes(s)
      << ",\n \"memory\": " << (s.board_memory ? memory(*s.board_memory) : memory(s.memory))
      << ",\n \"host\": " << host(s) << ",\n \"buffers\": " << buffers(s) << "}\n";
}

}  // namespace vista
