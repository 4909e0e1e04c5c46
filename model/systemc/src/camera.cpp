#include "camera.h"

#include <algorithm>

#include "timing.h"

namespace vista {

Camera::Camera(const sc_core::sc_module_name& name, const Configuration& c)
    : sc_module(name), configuration_(c), chunk_(c.burst_bytes) {
  SC_HAS_PROCESS(Camera);
  SC_THREAD(run);
}

void Camera::run() {
  const int64_t pixels = configuration_.pixels();
  for (int64_t frame = 0; frame < configuration_.frames; ++frame) {
    wait_until(configuration_.came_ps(frame, 0));
    video->frame_begins(frame);
    for (int64_t first = 0; first < pixels; first += chunk_) {
      const int64_t count = std::min(chunk_, pixels - first);
      wait_until(configuration_.came_ps(frame, first + count));
      video->pixels_come(frame, first, count);
    }
  }
}

}  // namespace vista
