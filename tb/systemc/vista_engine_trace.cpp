// vista_engine_trace CONFIG IN_STOP IN_GO OUT_STOP OUT_GO OUT.bin: the engine of the SystemC model between a source and a
// reader that stall by rtl/sim/stall_pattern.h (chances in 1/1000, the configuration's seed), as the Verilated engine can
// be driven. CONFIG as of vista_system; of it count size, build, images, frames and seed.
//
// OUT.bin: int64 clock of each pixel taken, int64 clock of each word, uint32 words, int64 stalls in, int64 stalls out.

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <string>
#include <vector>

#include "configuration.h"
#include "engine.h"
#include "images.h"
#include "stall_pattern.h"
#include "stream.h"
#include "words.h"

namespace {

class Streams : public sc_core::sc_module, public vista::PixelSource, public vista::WordSink {
 public:
  std::vector<int64_t> in_clock, out_clock;

  Streams(const sc_core::sc_module_name& name, size_t beats, const vista::Pace& in, const vista::Pace& out,
          uint64_t seed)
      : sc_module(name), beats_(beats), in_(in), out_(out), random_(seed) {}

  bool pixel_valid(int64_t) override {
    if (in_clock.size() == beats_ && out_clock.size() == beats_) {
      sc_core::sc_stop();
      sc_core::wait(never_);
    }
    offered_ = offered_ || (in_clock.size() < beats_ && in_.step(random_));
    ready_ = out_.step(random_);
    return offered_;
  }
  void pixel_taken(int64_t clock) override {
    in_clock.push_back(clock);
    offered_ = false;
  }
  int64_t next_pixel(int64_t clock) override { return clock; }
  bool word_ready(int64_t) override { return ready_; }
  void word_taken(int64_t clock) override { out_clock.push_back(clock); }

 private:
  size_t beats_;
  vista::Pace in_, out_;
  vista::Random random_;
  bool offered_ = false, ready_ = false;
  sc_core::sc_event never_;
};

template <class Item>
void put(std::ofstream& file, const std::vector<Item>& items) {
  file.write(reinterpret_cast<const char*>(items.data()), static_cast<std::streamsize>(items.size() * sizeof(Item)));
}

vista::Pace pace(char* const* arguments) {
  return {static_cast<uint32_t>(std::stoul(arguments[0])), static_cast<uint32_t>(std::stoul(arguments[1]))};
}

void trace(const vista::Configuration& c, const vista::Pace& in, const vista::Pace& out, std::ofstream& file) {
  const int width = static_cast<int>(c.width_px), height = static_cast<int>(c.height_px);
  vista::Engine engine("engine", c.build(), {{width, height}});
  Streams streams("streams", static_cast<size_t>(c.frames * c.pixels()), in, out, static_cast<uint64_t>(c.seed));
  engine.pixels(streams);
  engine.words(streams);
  sc_core::sc_start();

  put(file, streams.in_clock);
  put(file, streams.out_clock);
  const vista::Images images(c);
  vista::WordEngine words(c.engine_parameters(), width, height);
  std::vector<int64_t> stalls(2);
  for (int64_t n = 0; n < c.frames; ++n) {
    const vista::Pair pair = images.frame(n);
    put(file, words.compute(pair.left.data(), pair.right.data()));
    stalls[0] += engine.frame(static_cast<size_t>(n)).stalls_in;
    stalls[1] += engine.frame(static_cast<size_t>(n)).stalls_out;
  }
  put(file, stalls);
}

}  // namespace

int sc_main(int argc, char* argv[]) {
  sc_core::sc_report_handler::set_actions(sc_core::SC_INFO, sc_core::SC_DO_NOTHING);
  if (argc != 7) {
    std::cerr << "usage: vista_engine_trace CONFIG IN_STOP IN_GO OUT_STOP OUT_GO OUT.bin\n";
    return 2;
  }
  try {
    std::ifstream text(argv[1]);
    std::ofstream file(argv[6], std::ios::binary);
    trace(vista::read_configuration(text), pace(argv + 2), pace(argv + 4), file);
    return file ? 0 : 1;
  } catch (const std::exception& error) {
    std::cerr << "vista_engine_trace: " << error.what() << "\n";
    return 2;
  }
}

int main(int argc, char* argv[]) {
  setenv("SYSTEMC_DISABLE_COPYRIGHT_MESSAGE", "1", 1);
  return sc_core::sc_elab_and_sim(argc, argv);
}
