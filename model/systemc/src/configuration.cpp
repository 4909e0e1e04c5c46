#include "configuration.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <set>
#include <system_error>

#include "json.h"

namespace vista {
namespace {

double number(const std::string& key, const std::string& text) {
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  if (text.empty() || *end != '\0' || !std::isfinite(value))
    throw ConfigurationError(key, "'" + text + "' is not a finite number");
  return value;
}

std::string brief(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.10g", value);
  return text;
}

// A key: how its value is read, and how it is shown as JSON.
struct Key {
  std::string name;
  std::function<void(Configuration&, const std::string&)> set;
  std::function<std::string(const Configuration&)> show;
};

Key real(const char* name, double Configuration::* field, double low, double high, bool or_zero = false) {
  return {name,
          [=](Configuration& c, const std::string& text) {
            const double value = number(name, text);
            if (!((value >= low && value <= high) || (or_zero && value == 0)))
              throw ConfigurationError(
                  name, text + " is outside " + brief(low) + " .. " + brief(high) + (or_zero ? " and not 0" : ""));
            c.*field = value;
          },
          [=](const Configuration& c) { return json_number(c.*field); }};
}

Key integer(const char* name, int64_t Configuration::* field, int64_t low, int64_t high) {
  return {name,
          [=](Configuration& c, const std::string& text) {
            int64_t value = 0;
            const char* const end = text.data() + text.size();
            const auto [stop, error] = std::from_chars(text.data(), end, value);
            if (error == std::errc::invalid_argument || stop != end)
              throw ConfigurationError(name, "'" + text + "' is not a whole number");
            if (error == std::errc::result_out_of_range || value < low || value > high)
              throw ConfigurationError(name,
                                       text + " is outside " + std::to_string(low) + " .. " + std::to_string(high));
            c.*field = value;
          },
          [=](const Configuration& c) { return std::to_string(c.*field); }};
}

Key choice(const char* name, bool Configuration::* field, const char* on, const char* off) {
  return {name,
          [=](Configuration& c, const std::string& text) {
            if (text != on && text != off)
              throw ConfigurationError(name, "'" + text + "' is neither " + on + " nor " + off);
            c.*field = text == on;
          },
          [=](const Configuration& c) { return json_text(c.*field ? on : off); }};
}

Key path(const char* name, std::string Configuration::* field) {
  return {name, [=](Configuration& c, const std::string& text) { c.*field = text; },
          [=](const Configuration& c) { return (c.*field).empty() ? "null" : json_text(c.*field); }};
}

std::vector<double> samples(const std::string& key, std::string text) {
  std::replace_if(text.begin(), text.end(), [](char c) { return c == ',' || c == '\t'; }, ' ');
  std::vector<double> values;
  for (size_t at = text.find_first_not_of(' '); at != std::string::npos;) {
    const size_t end = std::min(text.find(' ', at), text.size());
    const std::string item = text.substr(at, end - at);
    values.push_back(number(key, item));
    if (values.back() < 0 || values.back() > 1e6) throw ConfigurationError(key, item + " is outside 0 .. 1e6 ms");
    at = text.find_first_not_of(' ', end);
  }
  if (values.empty()) throw ConfigurationError(key, "no samples");
  return values;
}

const std::vector<Key>& keys() {
  using C = Configuration;
  static const std::vector<Key> table = {
      integer("width_px", &C::width_px, 4, VISTA_ENGINE_MAX_SIDE_PX),
      integer("height_px", &C::height_px, 2, 4095),
      integer("disparities", &C::disparities, 16, VISTA_ENGINE_MAX_DISPARITIES),
      integer("block_px", &C::block_px, 5, VISTA_ENGINE_MAX_BLOCK_SIZE),
      integer("max_width_px", &C::max_width_px, 4, VISTA_ENGINE_MAX_SIDE_PX),
      {"lr_max_diff_px",
       [](C& c, const std::string& text) {
         if (text == "off")
           c.lr_max_diff_px = VISTA_ENGINE_LR_OFF;
         else
           integer("lr_max_diff_px", &C::lr_max_diff_px, 0, 255).set(c, text);
       },
       [](const C& c) {
         return c.lr_max_diff_px == VISTA_ENGINE_LR_OFF ? json_text("off") : std::to_string(c.lr_max_diff_px);
       }},
      choice("prefilter", &C::xsobel, "xsobel", "none"),
      integer("prefilter_cap", &C::prefilter_cap, 1, VISTA_ENGINE_MAX_PREFILTER_CAP),
      integer("texture_threshold", &C::texture_threshold, 0, 65535),
      integer("uniqueness_percent", &C::uniqueness_percent, 0, 100),
      real("engine_clock_hz", &C::engine_clock_hz, 1e3, 10e9),
      integer("lanes", &C::lanes, 1, 8),
      integer("rectify_rows", &C::rectify_rows, 0, 128),
      integer("levels", &C::levels, 1, 4),
      real("link_bytes_s", &C::link_bytes_s, 1e3, 1e12, true),
      real("link_round_trip_ns", &C::link_round_trip_ns, 0, 1e9),
      real("memory_clock_hz", &C::memory_clock_hz, 1e6, 1e9, true),
      choice("board_cameras", &C::board_cameras, "on", "off"),
      real("camera_rate_hz", &C::camera_rate_hz, 0.01, 10000, true),
      real("camera_pixel_clock_hz", &C::camera_pixel_clock_hz, 1e3, 10e9),
      integer("camera_horizontal_blanking_px", &C::camera_horizontal_blanking_px, 0, 100000),
      integer("camera_vertical_blanking_lines", &C::camera_vertical_blanking_lines, 0, 100000),
      real("memory_bandwidth_bytes_s", &C::memory_bandwidth_bytes_s, 1e3, 1e13),
      real("memory_latency_ns", &C::memory_latency_ns, 0, 1e6),
      real("memory_burst_overhead_ns", &C::memory_burst_overhead_ns, 0, 1e6),
      choice("memory_arbitration", &C::memory_priority, "priority", "round_robin"),
      integer("burst_bytes", &C::burst_bytes, 16, 4096),
      integer("dma_fifo_bytes", &C::dma_fifo_bytes, 32, 1 << 20),
      integer("capture_fifo_bytes", &C::capture_fifo_bytes, 32, 1 << 24),
      real("background_bytes_s", &C::background_bytes_s, 0, 1e13),
      integer("result_bytes_px", &C::result_bytes_px, 2, 4),
      integer("buffers", &C::buffers, 2, 3),
      choice("buffer_policy", &C::latest, "latest", "queue"),
      {"rectify_ms", [](C& c, const std::string& text) { c.rectify_ms = samples("rectify_ms", text); },
       [](const C& c) { return c.rectify_ms.empty() ? "null" : json_series(c.rectify_ms); }},
      integer("host_cores", &C::host_cores, 1, 2),
      integer("frames", &C::frames, 1, 1000000),
      integer("seed", &C::seed, 0, INT64_MAX),
      path("left_images", &C::left_images),
      path("right_images", &C::right_images),
      choice("compute_words", &C::compute_words, "on", "off"),
      path("words_out", &C::words_out),
  };
  return table;
}

constexpr char kStagePrefix[] = "host_stage.";
constexpr char kStageSuffix[] = "_ms";

bool set_stage(Configuration& c, const std::string& key, const std::string& text) {
  const size_t prefix = sizeof kStagePrefix - 1, suffix = sizeof kStageSuffix - 1;
  if (key.size() <= prefix + suffix || key.compare(0, prefix, kStagePrefix) != 0 ||
      key.compare(key.size() - suffix, suffix, kStageSuffix) != 0)
    return false;
  c.host_stages.push_back({key.substr(prefix, key.size() - prefix - suffix), samples(key, text)});
  return true;
}

// What concerns several keys at once.
void check(const Configuration& c) {
  if (c.disparities % 16 != 0) throw ConfigurationError("disparities", "not a multiple of 16");
  if (c.block_px % 2 == 0) throw ConfigurationError("block_px", "not odd");
  if (c.result_bytes_px == 3) throw ConfigurationError("result_bytes_px", "neither 2 nor 4");
  if ((c.burst_bytes & (c.burst_bytes - 1)) != 0) throw ConfigurationError("burst_bytes", "not a power of two");
  if (c.max_width_px < c.disparities + c.block_px)
    throw ConfigurationError("max_width_px",
                             "below disparities + block_px, " + std::to_string(c.disparities + c.block_px));
  if (c.width_px > c.max_width_px)
    throw ConfigurationError("width_px", std::to_string(c.width_px) + " is above max_width_px, " +
                                             std::to_string(c.max_width_px) + ", for which the engine is built");
  for (const auto& [key, bytes] :
       {std::pair("dma_fifo_bytes", c.dma_fifo_bytes), std::pair("capture_fifo_bytes", c.capture_fifo_bytes)})
    if (bytes < 2 * c.burst_bytes) throw ConfigurationError(key, "below two bursts");
  const double fastest = 1e9 / (c.line_ns() * static_cast<double>(c.height_px + c.camera_vertical_blanking_lines));
  if (c.camera_rate_hz > fastest)
    throw ConfigurationError("camera_rate_hz", brief(c.camera_rate_hz) + " is above " + brief(fastest) +
                                                   ", what camera_pixel_clock_hz and the blanking allow");
  if (c.rectify_rows != 0 && (c.rectify_rows < 16 || (c.rectify_rows & (c.rectify_rows - 1)) != 0))
    throw ConfigurationError("rectify_rows", "neither 0 nor 16, 32, 64 or 128");
  if (c.levels > 1 && c.rectify_rows == 0) throw ConfigurationError("levels", "more than 1 needs rectify_rows");
  if (c.rectify_rows != 0 && c.compute_words)
    throw ConfigurationError("compute_words", "on, but only times are known of the front end (rectify_rows)");
  if (c.has_board() != (c.memory_clock_hz > 0))
    throw ConfigurationError("memory_clock_hz", "of a board (link_bytes_s): a board has one, nothing else has");
  if (c.board_cameras && !c.has_board())
    throw ConfigurationError("board_cameras", "on, but there is no board (link_bytes_s)");
  if (c.board_cameras && c.rectify_rows == 0)
    throw ConfigurationError("board_cameras", "on, but the board has no front end (rectify_rows)");
  if (c.has_board() && c.lanes > 1) throw ConfigurationError("lanes", "a board (link_bytes_s) has one");
  if (c.has_board() && !c.rectify_ms.empty())
    throw ConfigurationError("rectify_ms", "a board (link_bytes_s) gets its pairs unrectified");
  if (c.left_images.empty() != c.right_images.empty())
    throw ConfigurationError(c.left_images.empty() ? "left_images" : "right_images", "missing beside the other side");
  if (!c.words_out.empty() && !c.compute_words) throw ConfigurationError("words_out", "needs compute_words = on");
}

std::string trimmed(const std::string& text) {
  const size_t first = text.find_first_not_of(" \t\r"), last = text.find_last_not_of(" \t\r");
  return first == std::string::npos ? "" : text.substr(first, last - first + 1);
}

}  // namespace

Configuration read_configuration(std::istream& text) {
  Configuration c;
  std::set<std::string> seen;
  int line_number = 0;
  for (std::string line; std::getline(text, line);) {
    ++line_number;
    line = trimmed(line.substr(0, line.find('#')));
    if (line.empty()) continue;
    const size_t equals = line.find('=');
    if (equals == std::string::npos)
      throw ConfigurationError("line " + std::to_string(line_number), "'" + line + "' is not 'key = value'");
    const std::string key = trimmed(line.substr(0, equals)), value = trimmed(line.substr(equals + 1));
    if (!seen.insert(key).second) throw ConfigurationError(key, "given twice");
    const auto found = std::find_if(keys().begin(), keys().end(), [&](const Key& k) { return k.name == key; });
    if (found != keys().end())
      found->set(c, value);
    else if (!set_stage(c, key, value))
      throw ConfigurationError(key, "no such key");
  }
  check(c);
  return c;
}

std::vector<std::pair<std::string, std::string>> listed(const Configuration& c) {
  std::vector<std::pair<std::string, std::string>> items;
  for (const Key& key : keys()) items.emplace_back(key.name, key.show(c));
  return items;
}

std::vector<clocks::Size> Configuration::level_sizes() const {
  constexpr int kLeastWidth = 4, kLeastHeight = 2;  // that the engine takes
  std::vector<clocks::Size> sizes;
  clocks::Size size{static_cast<int>(width_px), static_cast<int>(height_px)};
  for (int64_t level = 0; level < levels && size.width >= kLeastWidth && size.height >= kLeastHeight; ++level) {
    sizes.push_back(size);
    size = {(size.width + 1) / 2, (size.height + 1) / 2};
  }
  return sizes;
}

// Narrow words go two by two, and a row ends with a whole word: doc/rtl.md, OUTPUT.
int64_t Configuration::result_words() const {
  int64_t sum = 0;
  for (const clocks::Size& size : level_sizes())
    sum += static_cast<int64_t>(result_bytes_px == 2 ? (size.width + 1) / 2 : size.width) * size.height;
  return sum;
}

int64_t Configuration::result_px() const {
  int64_t sum = 0;
  for (const clocks::Size& size : level_sizes()) sum += static_cast<int64_t>(size.width) * size.height;
  return sum;
}

clocks::Build Configuration::build() const {
  return {static_cast<int>(disparities), static_cast<int>(block_px), static_cast<int>(max_width_px)};
}

vista_engine_params Configuration::engine_parameters() const {
  vista_engine_params p = vista_engine_defaults();
  p.num_disparities = static_cast<int32_t>(disparities);
  p.block_size = static_cast<int32_t>(block_px);
  p.prefilter = xsobel ? VISTA_ENGINE_PREFILTER_XSOBEL : VISTA_ENGINE_PREFILTER_NONE;
  p.prefilter_cap = static_cast<int32_t>(prefilter_cap);
  p.texture_threshold = static_cast<int32_t>(texture_threshold);
  p.uniqueness_ratio = static_cast<int32_t>(uniqueness_percent);
  p.lr_max_diff = static_cast<int32_t>(lr_max_diff_px);
  return p;
}

double Configuration::line_ns() const {
  return static_cast<double>(width_px + camera_horizontal_blanking_px) * 1e9 / camera_pixel_clock_hz;
}

double Configuration::readout_ns() const {
  return line_ns() * static_cast<double>(height_px - 1) + static_cast<double>(width_px) * 1e9 / camera_pixel_clock_hz;
}

int64_t Configuration::came_ps(int64_t frame, int64_t pixels_of_frame) const {
  const double begin_ns = static_cast<double>(frame) * period_ns();
  if (pixels_of_frame == 0) return std::llround(begin_ns * 1e3);
  const int64_t last = pixels_of_frame - 1;
  const double row_ns = static_cast<double>(last / width_px) * line_ns();
  return std::llround((begin_ns + row_ns + static_cast<double>(last % width_px + 1) * 1e9 / camera_pixel_clock_hz) *
                      1e3);
}

double Configuration::period_ns() const {
  return camera_rate_hz > 0 ? 1e9 / camera_rate_hz
                            : line_ns() * static_cast<double>(height_px + camera_vertical_blanking_lines);
}

}  // namespace vista
