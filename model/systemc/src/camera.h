// Both cameras in step: they send the pixels of a line at the pixel clock, then pause for the blanking. They wait for nobody.
#ifndef VISTA_SYSTEM_CAMERA_H
#define VISTA_SYSTEM_CAMERA_H

#include <cstdint>
#include <systemc>

#include "configuration.h"

namespace vista {

class VideoSink : virtual public sc_core::sc_interface {
 public:
  virtual void frame_begins(int64_t frame) = 0;
  // Pixels first .. first + count - 1 of the frame, in raster order, have come from both.
  virtual void pixels_come(int64_t frame, int64_t first, int64_t count) = 0;
};

class Camera : public sc_core::sc_module {
 public:
  sc_core::sc_port<VideoSink> video;

  Camera(const sc_core::sc_module_name& name, const Configuration& configuration);

 private:
  void run();

  const Configuration configuration_;
  int64_t chunk_;
};

}  // namespace vista

#endif
