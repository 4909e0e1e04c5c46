// What a run of the model is told: doc/design/system-model.md, "Configuration". Keys, ranges and defaults stand in
// configuration.cpp.
#ifndef VISTA_SYSTEM_CONFIGURATION_H
#define VISTA_SYSTEM_CONFIGURATION_H

#include <cstdint>
#include <istream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "clocks/framer.h"
#include "clocks/latency.h"
extern "C" {
#include "vista/engine.h"
}

namespace vista {

// One line that begins with the key at fault.
class ConfigurationError : public std::runtime_error {
 public:
  ConfigurationError(const std::string& key, const std::string& what) : std::runtime_error(key + ": " + what) {}
};

// Measured times of one stage, ms.
struct StageSamples {
  std::string name;
  std::vector<double> ms;
};

struct Configuration {
  int64_t width_px = 640, height_px = 480;
  int64_t disparities = 32, block_px = 11, max_width_px = 1024;
  int64_t lr_max_diff_px = 1;  // VISTA_ENGINE_LR_OFF: no check
  bool xsobel = true;
  int64_t prefilter_cap = 31, texture_threshold = 10, uniqueness_percent = 15;
  double engine_clock_hz = 100e6;
  int64_t lanes = 1;
  int64_t rectify_rows = 0, levels = 1;  // of the front end in hardware; no rows: without front end
  double link_bytes_s = 0, link_round_trip_ns = 0;  // to a board; no bytes: the camera feeds its memory
  double memory_clock_hz = 0;                       // of the SDRAM of a board
  bool board_cameras = false;                       // a board's own: no pair goes over the link

  double camera_rate_hz = 60, camera_pixel_clock_hz = 27e6;
  int64_t camera_horizontal_blanking_px = 160, camera_vertical_blanking_lines = 45;

  double memory_bandwidth_bytes_s = 1.6e9, memory_latency_ns = 100, memory_burst_overhead_ns = 0;
  bool memory_priority = false;  // else round robin
  int64_t burst_bytes = 256, dma_fifo_bytes = 4096, capture_fifo_bytes = 16384;
  double background_bytes_s = 0;
  int64_t result_bytes_px = 4;

  int64_t buffers = 3;
  bool latest = true;  // else queue
  std::vector<double> rectify_ms;
  std::vector<StageSamples> host_stages;
  int64_t host_cores = 1;

  int64_t frames = 60, seed = 1;
  std::string left_images, right_images, words_out;  // paths, empty: none
  bool compute_words = true;

  int64_t pixels() const { return width_px * height_px; }
  bool has_board() const { return link_bytes_s > 0; }
  std::vector<clocks::Size> level_sizes() const;  // of those that are matched
  int64_t result_px() const;                      // of all levels
  int64_t result_words() const;                   // of 32 bits, in which the engine sends them
  clocks::Build build() const;
  vista_engine_params engine_parameters() const;
  double line_ns() const;     // of the camera, blanking included
  double readout_ns() const;  // first to last pixel of a frame
  double period_ns() const;   // from frame to frame
  // The time at which so many pixels of a frame have come; of none: at which it begins.
  int64_t came_ps(int64_t frame, int64_t pixels_of_frame) const;
};

// Throws ConfigurationError.
Configuration read_configuration(std::istream& text);

// Every key but host stages, with its value in the form of a JSON value, in the order of the documentation.
std::vector<std::pair<std::string, std::string>> listed(const Configuration& configuration);

}  // namespace vista

#endif
