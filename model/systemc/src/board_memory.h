// The SDRAM of a board, and the gateware's ways to it (rtl/board/gateware/memory.py): clocks/sdram.h between queues of
// words. Only times pass here; the bytes themselves lie in a Memory.
#ifndef VISTA_SYSTEM_BOARD_MEMORY_H
#define VISTA_SYSTEM_BOARD_MEMORY_H

#include <array>
#include <cstdint>
#include <deque>
#include <systemc>

#include "clocks/sdram.h"
#include "configuration.h"
#include "memory.h"
#include "timing.h"

namespace vista {

class BoardMemory;
class BoardWriter;

// What lies between a port of the memory and its user. Times are those of clock edges, and may lie ahead of the
// kernel's. A word that enters a queue at an edge is seen by what is behind it a clock later.
class BoardPort {
 public:
  explicit BoardPort(BoardMemory& memory) : memory_(memory) {}
  virtual ~BoardPort() = default;

 protected:
  friend class BoardMemory;
  // The command of the clock that begins at `now`.
  virtual clocks::Sdram::Command command(int64_t now) = 0;
  virtual void accepted(int64_t now) = 0;
  virtual void served(int64_t clock) = 0;
  virtual void edge(int64_t now) = 0;  // after what was accepted and served
  virtual bool quiet() const = 0;

  BoardMemory& memory_;
  int64_t words_ = 0, waited_clocks_ = 0;
};

// LiteDRAM's DMA reader. `ahead`: words that it holds or has asked for; `queue`: addresses in registers before it, or 0;
// `late`: clocks beside those of the controller until a word can be taken; `drains`: words are taken as they come.
class BoardReader : public BoardPort {
 public:
  BoardReader(BoardMemory& memory, int64_t ahead, size_t queue, int late, bool drains)
      : BoardPort(memory), ahead_(ahead), queue_(queue), late_(late), drains_(drains) {}

  // Words are asked for from now on, one a clock. `advance` has to come before.
  void read(int64_t address, int64_t words);
  // Takes a word, if there is one then. Suspends the caller as BoardMemory::advance does.
  bool take(int64_t ps);
  // Notes when a word that was taken before leaves.
  void leave(int64_t ps) { left_.push_back(ps); }
  // Asks for nothing while this one has a burst to write.
  void give_way_to(const BoardWriter& writer) { gives_way_to_ = &writer; }
  // Suspends the caller until all words that were asked for have come, of one that drains.
  void wait_for_all();

 private:
  clocks::Sdram::Command command(int64_t now) override;
  void accepted(int64_t now) override;
  void served(int64_t clock) override;
  void edge(int64_t now) override;
  bool quiet() const override { return wanted_.empty() && addresses_.empty(); }

  struct Range {
    int64_t address, words;
  };
  int64_t next_address();

  int64_t ahead_, held_ = 0;
  size_t queue_;
  int late_;
  std::deque<Range> wanted_;
  std::deque<std::pair<int64_t, int64_t>> addresses_;  // and when they entered
  bool drains_;
  const BoardWriter* gives_way_to_ = nullptr;
  int64_t coming_ = 0;  // words that were asked for and have not come
  std::deque<int64_t> came_, left_;
};

// LiteDRAM's DMA writer behind a queue. It waits until `burst` words are there, and writes all of them then.
class BoardWriter : public BoardPort {
 public:
  BoardWriter(BoardMemory& memory, size_t queue, size_t burst = 1) : BoardPort(memory), queue_(queue), burst_(burst) {}

  // Whether a word can be written in the clock that begins then. Suspends the caller as BoardMemory::advance does.
  bool has_room(int64_t ps);
  void write(int64_t ps, int64_t address);
  // Words are written from now on, one a clock if there is room. `advance` has to come before.
  void write_all(int64_t address, int64_t words);
  // Suspends the caller until all words have been accepted.
  void wait_until_idle();
  // More of a burst is left than the registers before the port hold.
  bool bursts() const { return bursts_ && addresses_.size() > kRegisters; }
  void follow(BoardReader& reader) { follower_ = &reader; }  // reads each word that was accepted

 private:
  static constexpr size_t kRegisters = 2, kData = 16;  // words before the port, and that wait for the chip

  clocks::Sdram::Command command(int64_t now) override;
  void accepted(int64_t now) override;
  void served(int64_t clock) override { leaving_.push_back(clock + clocks::Sdram::kWriteClocks); }
  void edge(int64_t now) override;
  bool quiet() const override { return addresses_.empty() && words_left_ == 0; }

  size_t queue_, burst_, data_ = 0;
  bool bursts_ = false, flushes_ = false;
  std::deque<std::pair<int64_t, int64_t>> addresses_;  // and when they entered
  std::deque<int64_t> leaving_;
  int64_t next_address_ = 0, words_left_ = 0;  // of `write_all`
  BoardReader* follower_ = nullptr;
};

class BoardMemory : public sc_core::sc_module {
 public:
  BoardMemory(const sc_core::sc_module_name& name, const Configuration& configuration);

  // The buffer of the pyramid, the engine's pixels and words, and the server, as the gateware makes them.
  BoardWriter store;
  BoardReader levels, pixels;
  BoardWriter words;
  BoardReader to_host;
  BoardWriter from_host;

  // Places of things, in words: memory.py.
  static int64_t words_of(int64_t slot) { return slot << kWordsBits; }
  static int64_t pixels_of(int64_t slot) { return (2 << kWordsBits) + (slot << kPixelsBits); }
  static constexpr int64_t kLevels = (6 << 20) / 4, kLevelWords = (1 << 20) / 4;

  const ClockEdges edges;

  // All clocks that are over then. Suspends the caller, unless no other process can do anything before: nothing that is
  // simulated may come before what another process still has to say.
  void advance(int64_t ps);
  // So many clocks from now.
  void pass(int64_t clocks);

  std::deque<MasterCounts> masters() const;
  int64_t busy_ps() const { return edges.ps(busy_clocks_); }

 private:
  friend class BoardReader;
  friend class BoardWriter;
  static constexpr int64_t kWordsBits = 19, kPixelsBits = 18;

  bool step();  // whether a port asked for something or was served
  bool nobody_asks() const;

  clocks::Sdram sdram_;
  std::array<BoardPort*, clocks::Sdram::kPorts> ports_;
  int64_t clock_ = 0;  // that is stepped next
  int64_t busy_clocks_ = 0;
};

}  // namespace vista

#endif
