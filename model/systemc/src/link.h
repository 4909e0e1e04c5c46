// The Ethernet link to a board, and the client at its host's end (doc/board.md): raw pairs go to the board packet by
// packet, the disparities of all levels come back. The board has room for two frames. The client sends a frame whenever
// there is room, and else fetches one that is done; it does one thing at a time.
#ifndef VISTA_SYSTEM_LINK_H
#define VISTA_SYSTEM_LINK_H

#include <cstdint>
#include <systemc>
#include <vector>

#include "board_memory.h"
#include "buffer_pool.h"
#include "configuration.h"
#include "memory.h"
#include "timing.h"
#include "wire.h"

namespace vista {

// Memory of its two ends, that of the host and of the board.
struct LinkEnds {
  Memory &host, &board;
  BoardMemory& board_times;
  BufferPool &captured, &received;  // pairs at the host, and on the board
  BufferPool &results, &fetched;  // words on the board, and at the host
};

class Link : public sc_core::sc_module {
 public:
  static constexpr int64_t kFrames = WIRE_SLOTS;  // on the board

  Link(const sc_core::sc_module_name& name, const Configuration& configuration, const LinkEnds& ends);

  int64_t busy_ps() const { return busy_ps_; }

 private:
  void run();
  void ask();
  void send(Buffer& pair, Buffer& received);
  void fetch(Buffer& result, Buffer& fetched);
  void store(int64_t address, int64_t words);  // addresses of words on the board
  void load(int64_t address, int64_t words);
  int64_t wire_ps(int64_t payload_bytes) const;
  int64_t clocks_ps(int64_t clocks) const;

  const Configuration& configuration_;
  LinkEnds ends_;
  Master from_host_, to_host_, to_board_, from_board_;
  int64_t frames_ = 0;  // on the board
  int64_t busy_ps_ = 0;
};

}  // namespace vista

#endif
