#include "camera.h"

#include <algorithm>

#include "timing.h"

namespace vista {

Camera::Camera(const sc_core::sc_module_name& name, const Configuration& c)
    : sc_module(name),
      frames_(c.frames),
      pixels_(c.pixels()),
      width_(c.width_px),
      chunk_(c.burst_bytes),
      period_ns_(c.period_ns()),
      line_ns_(c.line_ns()),
      pixel_ns_(1e9 / c.camera_pixel_clock_hz) {
  SC_HAS_PROCESS(Camera);
  SC_THREAD(run);
}

void Camera::run() {
  for (int64_t frame = 0; frame < frames_; ++frame) {
    const double begin_ns = static_cast<double>(frame) * period_ns_;
    wait_until(std::llround(begin_ns * 1e3));
    video->frame_begins(frame);
    for (int64_t first = 0; first < pixels_; first += chunk_) {
      const int64_t count = std::min(chunk_, pixels_ - first), last = first + count - 1;
      const double line_ns = static_cast<double>(last / width_) * line_ns_;
      wait_until(std::llround((begin_ns + line_ns + static_cast<double>(last % width_ + 1) * pixel_ns_) * 1e3));
      video->pixels_come(frame, first, count);
    }
  }
}

}  // namespace vista
