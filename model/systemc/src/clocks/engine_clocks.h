// The engine of rtl/, clock by clock and without its data: handshakes, pauses and the order of events. What the words
// are is another matter (words.h). Equal to the RTL in every clock: tb/top/test_system_model.py.
#ifndef VISTA_CLOCKS_ENGINE_CLOCKS_H
#define VISTA_CLOCKS_ENGINE_CLOCKS_H

#include "frame_writer.h"
#include "framer.h"
#include "latency.h"
#include "matching.h"
#include "result_fifo.h"
#include "skid.h"

namespace vista::clocks {

class EngineClocks {
 public:
  // Out of reset, ready for the first pixel.
  explicit EngineClocks(const Build& build)
      : framer_(build), matching_(build), begins_(build), results_(build), writer_(build) {
    constexpr int kResetClocks = 16;  // until the pauses of reset have passed
    for (int i = 0; i < kResetClocks; ++i) edge(false, false);
  }

  // Sets the size of the frames that start from now on.
  void set_size(const Size& size) { framer_.set_size(size); }

  // The engine's side of both handshakes. Registers drive them, so they hold for the clock whatever the other side does.
  bool pixel_ready() const { return pixels_.ready(); }
  bool word_valid() const { return words_.valid(); }

  // One rising edge. A pixel passes if it was valid and pixel_ready(), a word if word_valid() and it was ready.
  void edge(bool pixel_valid, bool word_ready) {
    const Framer::Clock framer = framer_.evaluate(pixels_.valid(), go_);
    const bool writer_ready = words_.ready();
    const bool waits = results_.valid();
    const Queued waiting = results_.front();

    go_ = results_.go();
    words_.edge(writer_.valid(), word_ready);
    results_.edge(matching_.result(), begins_.out(), writer_.takes(waiting.begin, writer_ready));
    writer_.edge(waits, waiting, writer_ready);
    begins_.edge(begin_, begin_size_);
    matching_.edge(slot_);
    pixels_.edge(pixel_valid, framer.step);
    framer_.edge(framer);
    slot_ = framer.slot;
    begin_ = framer.begin;
    begin_size_ = framer.begin_size;
  }

  // Whether no clock changes anything without a pixel: clocks may be left out.
  bool quiet() const {
    return go_ && !pixels_.valid() && !framer_.draining() && !slot_.valid && !begin_ && matching_.empty() &&
           begins_.empty() && results_.empty() && writer_.waits() && !words_.valid();
  }

 private:
  Skid pixels_, words_;
  Framer framer_;
  Matching matching_;
  BeginDelay begins_;
  ResultFifo results_;
  FrameWriter writer_;
  bool go_ = false;
  // Registered outputs of the framer.
  Slot slot_;
  bool begin_ = false;
  Size begin_size_;
};

}  // namespace vista::clocks

#endif
