// The two streams of an engine, asked clock by clock. Clocks come in order and may lie ahead of the kernel's time; an
// answer that depends on what is not simulated yet suspends the engine until it is.
#ifndef VISTA_SYSTEM_STREAM_H
#define VISTA_SYSTEM_STREAM_H

#include <cstdint>
#include <systemc>

namespace vista {

class PixelSource : virtual public sc_core::sc_interface {
 public:
  // tvalid. Asked once a clock; once true it stays so until the pixel is taken.
  virtual bool pixel_valid(int64_t clock) = 0;
  virtual void pixel_taken(int64_t clock) = 0;
  // The clock to go on with when none is valid and the engine rests: `clock` itself or when the next pixel comes.
  virtual int64_t next_pixel(int64_t clock) = 0;
};

class WordSink : virtual public sc_core::sc_interface {
 public:
  // tready, asked while a word is valid.
  virtual bool word_ready(int64_t clock) = 0;
  virtual void word_taken(int64_t clock) = 0;
};

}  // namespace vista

#endif
