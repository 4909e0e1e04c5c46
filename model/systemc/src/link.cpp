#include "link.h"

#include <algorithm>
#include <deque>

namespace vista {
namespace {

// rtl/board/wire.toml and rtl/board/gateware/server.py.
constexpr int64_t kChunkBytes = 1024, kHeaderBytes = 20, kStatusBytes = 176, kCredits = 7, kAskEvery = 3;
constexpr int64_t kFetchChunks = 32, kPauseNs = 200000;  // sw/src/board/words.c
constexpr int64_t kQuestionsOfSlot = 2;  // sw/src/board/request.c: what is in the slot, and to give it up
constexpr int64_t kWordBytes = 4;  // of the board's memory
// Preamble, Ethernet, IP, UDP, check sum, gap between two packets.
constexpr int64_t kPacketBytes = 8 + 14 + 20 + 8 + 4 + 12;
// Of the server, beside a clock for each word: to read a packet's header and to look at its place; to reply with a status,
// with words.
constexpr int64_t kPacketClocks = 15, kStatusClocks = 44, kReplyClocks = 24;
constexpr int64_t kReplies = 2;  // that wait for the wire

}  // namespace

Link::Link(const sc_core::sc_module_name& name, const Configuration& c, const LinkEnds& ends)
    : sc_module(name),
      configuration_(c),
      ends_(ends),
      from_host_("from_host", ends.host, kFetchRank),
      to_host_("to_host", ends.host, kResultRank),
      to_board_("to_board", ends.board, kCaptureRank),
      from_board_("from_board", ends.board, kCaptureRank) {
  SC_HAS_PROCESS(Link);
  SC_THREAD(run);
}

void Link::run() {
  for (;;) {
    Buffer* const room = frames_ < kFrames && ends_.captured.any_waiting() ? ends_.received.begin_writing(-1) : nullptr;
    Buffer* const at_host = !room && ends_.results.any_waiting() ? ends_.fetched.begin_writing(-1) : nullptr;
    const int64_t begin = now_ps();
    if (room) {
      for (int64_t i = 0; i < kQuestionsOfSlot; ++i) ask();
      send(*ends_.captured.begin_reading(), *room);
      ++frames_;
    } else if (at_host) {
      fetch(*ends_.results.begin_reading(), *at_host);
      --frames_;
    } else if (frames_ > 0) {  // the client waits for the first of them
      ask();
      if (!ends_.results.any_waiting()) wait_until(now_ps() + from_ns(kPauseNs).value());
      continue;
    } else {
      sc_core::wait(ends_.captured.changed() | ends_.received.changed() | ends_.results.changed() |
                    ends_.fetched.changed());
      continue;
    }
    busy_ps_ += now_ps() - begin;
  }
}

// The server takes a clock for each word of a chunk, or as long as memory does.
template <class Burst>
int64_t Link::in_bursts(int64_t bytes, Burst burst) {
  int64_t done = now_ps();
  for (int64_t first = 0; first < bytes; first += configuration_.burst_bytes) {
    const int64_t begin = now_ps(), count = std::min(configuration_.burst_bytes, bytes - first);
    done = burst(first, count);
    wait_until(begin + clocks_ps(count / kWordBytes));
  }
  return done;
}

int64_t Link::wire_ps(int64_t payload_bytes) const {
  return static_cast<int64_t>(static_cast<double>(payload_bytes + kPacketBytes) * 1e12 / configuration_.link_bytes_s);
}

int64_t Link::clocks_ps(int64_t clocks) const {
  return static_cast<int64_t>(static_cast<double>(clocks) * 1e12 / configuration_.engine_clock_hz);
}

// A request of a header alone, and its answer, which is a status.
void Link::ask() {
  wait_until(now_ps() + wire_ps(kHeaderBytes) + clocks_ps(kPacketClocks + kStatusClocks) + wire_ps(kStatusBytes) +
             from_ns(configuration_.link_round_trip_ns).value());
}

// A packet leaves when those before it have left, and while no more than the credits are not known to have arrived.
void Link::send(Buffer& pair, Buffer& received) {
  const int64_t bytes = 2 * configuration_.pixels(), round_trip = from_ns(configuration_.link_round_trip_ns).value();
  std::vector<uint8_t> data(static_cast<size_t>(bytes));
  wait_until(from_host_.read(pair.address, data.data(), bytes));
  int64_t wire = now_ps(), known = 0, asked = 0;  // packets that were answered, and of the last one that asks
  std::deque<std::pair<int64_t, int64_t>> answers;  // when the host knows of how many
  for (int64_t packet = 0, first = 0; first < bytes; ++packet, first += kChunkBytes) {
    while (packet - known >= kCredits) {
      wire = std::max(wire, answers.front().first);
      known = answers.front().second;
      answers.pop_front();
    }
    wire += wire_ps(kChunkBytes + kHeaderBytes);
    wait_until(wire);
    const int64_t count = std::min(kChunkBytes, bytes - first);
    in_bursts(count, [&](int64_t at, int64_t burst) {
      return to_board_.write(received.address + first + at, data.data() + first + at, burst);
    });
    wait_until(now_ps() + clocks_ps(kPacketClocks));
    const bool ask = packet + 1 - asked == kAskEvery || packet + 1 - known == kCredits || first + count == bytes;
    if (!ask) continue;
    asked = packet + 1;
    wait_until(now_ps() + clocks_ps(kStatusClocks));
    answers.emplace_back(now_ps() + wire_ps(kStatusBytes) + round_trip, asked);
  }
  wait_until(answers.back().first);
  received.frame = pair.frame;
  ends_.captured.release(pair);
  ends_.received.publish(received);
}

// Chunks are asked for by the dozen; replies wait for the wire, and the server for room among them.
void Link::fetch(Buffer& result, Buffer& fetched) {
  const int64_t bytes = configuration_.result_bytes_px * configuration_.result_px();
  const int64_t round_trip = from_ns(configuration_.link_round_trip_ns).value();
  std::vector<uint8_t> data(static_cast<size_t>(bytes));
  std::deque<int64_t> leaving;
  for (int64_t packet = 0, first = 0; first < bytes; ++packet, first += kChunkBytes) {
    if (packet % kFetchChunks == 0) {
      if (!leaving.empty()) wait_until(leaving.back());
      leaving.clear();
      wait_until(now_ps() + wire_ps(kHeaderBytes) + round_trip + clocks_ps(kPacketClocks));
    }
    if (static_cast<int64_t>(leaving.size()) > kReplies) {
      wait_until(leaving.front());
      leaving.pop_front();
    }
    const int64_t count = std::min(kChunkBytes, bytes - first);
    wait_until(in_bursts(count, [&](int64_t at, int64_t burst) {
      return from_board_.read(result.address + first + at, data.data() + first + at, burst);
    }));
    wait_until(now_ps() + clocks_ps(kReplyClocks));
    const int64_t wire_free = leaving.empty() ? now_ps() : std::max(now_ps(), leaving.back());
    leaving.push_back(wire_free + wire_ps(kChunkBytes + kHeaderBytes));
  }
  wait_until(leaving.back());
  wait_until(to_host_.write(fetched.address, data.data(), bytes));
  fetched.frame = result.frame;
  ends_.results.release(result);
  ends_.fetched.publish(fetched);
}

}  // namespace vista
