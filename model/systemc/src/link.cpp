#include "link.h"

#include <algorithm>
#include <deque>

#include "wire.h"

namespace vista {
namespace {

constexpr int64_t kWordBytes = 4;
constexpr int64_t kChunkBytes = WIRE_CHUNK_BYTES, kChunkWords = kChunkBytes / kWordBytes;
constexpr int64_t kHeaderWords = WIRE_HEADER_WORDS, kHeaderBytes = kWordBytes * kHeaderWords;
constexpr int64_t kStatusWords = kHeaderWords + WIRE_STATUS_WORDS + WIRE_MAX_CHUNKS_IN / 32;
constexpr int64_t kStatusBytes = kWordBytes * kStatusWords;
// rtl/board/gateware/server.py; sw/src/link/board/pixels.c, words.c and request.c: what is in the slot, and to give it up.
constexpr int64_t kCredits = 7, kAskEvery = 3;
constexpr int64_t kFetchChunks = 32, kPauseNs = 200000, kQuestionsOfSlot = 2;
// Preamble, Ethernet, IP, UDP, check sum, gap between two packets.
constexpr int64_t kPacketBytes = 8 + 14 + 20 + 8 + 4 + 12;
// Clocks of the server, beside the words of a chunk: to read a packet's header and to look at its place; to reply with
// a status; from one reply of words to the next.
constexpr int64_t kPacketClocks = 15, kStatusClocks = kStatusWords + 1, kReplyClocks = 1;
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
    const bool waits_for_words = frames_ > 0 || configuration_.board_cameras;
    Buffer* const room = frames_ < kFrames && ends_.captured.any_waiting() ? ends_.received.begin_writing(-1) : nullptr;
    Buffer* const at_host = !room && ends_.results.any_waiting() ? ends_.fetched.begin_writing(-1) : nullptr;
    const int64_t begin = now_ps();
    if (room) {
      for (int64_t i = 0; i < kQuestionsOfSlot; ++i) ask();
      send(*ends_.captured.begin_reading(), *room);
      ++frames_;
    } else if (at_host) {
      fetch(*ends_.results.begin_reading(), *at_host);
      if (!configuration_.board_cameras) --frames_;
    } else if (waits_for_words && configuration_.board_cameras) {
      wait_until(now_ps() + from_ns(kPauseNs).value());
      ask();
      continue;
    } else if (waits_for_words) {  // the client waits for the first of them
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

// The server puts a word into memory a clock, if there is room, and goes on when all are inside.
void Link::store(int64_t address, int64_t words) {
  ends_.board_times.advance(now_ps());
  ends_.board_times.from_host.write_all(address, words);
  ends_.board_times.from_host.wait_until_idle();
}

// Words are asked for before the header of their reply leaves, and come later than it.
void Link::load(int64_t address, int64_t words) {
  ends_.board_times.advance(now_ps());
  ends_.board_times.to_host.read(address, words);
  ends_.board_times.to_host.wait_for_all();
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
  const int64_t address = BoardMemory::pixels_of(ends_.received.number(received));
  int64_t wire = now_ps(), known = 0;  // packets that were answered
  std::deque<std::pair<int64_t, int64_t>> answers;  // when the host knows of how many
  for (int64_t packet = 0, first = 0; first < bytes; ++packet, first += kChunkBytes) {
    while (packet - known >= kCredits) {
      wire = std::max(wire, answers.front().first);
      known = answers.front().second;
      answers.pop_front();
    }
    wire += wire_ps(kChunkBytes + kHeaderBytes);
    wait_until(wire);
    store(address + packet * kChunkWords, kChunkWords);
    wait_until(now_ps() + clocks_ps(kPacketClocks));
    const int64_t on_the_way = packet + 1 - known;
    if (on_the_way % kAskEvery != 0 && on_the_way != kCredits && first + kChunkBytes < bytes) continue;
    wait_until(now_ps() + clocks_ps(kStatusClocks));
    answers.emplace_back(now_ps() + wire_ps(kStatusBytes) + round_trip, packet + 1);
  }
  to_board_.poke(received.address, data.data(), bytes);
  wait_until(answers.back().first);
  received.frame = pair.frame;
  ends_.captured.release(pair);
  ends_.received.publish(received);
}

// Chunks are asked for by the dozen; replies wait for the wire, and the server for room among them.
void Link::fetch(Buffer& result, Buffer& fetched) {
  const int64_t round_trip = from_ns(configuration_.link_round_trip_ns).value(), words = configuration_.result_words();
  const int64_t address = BoardMemory::words_of(ends_.results.number(result));
  std::deque<int64_t> leaving;
  for (int64_t packet = 0; packet * kChunkWords < words; ++packet) {
    if (packet % kFetchChunks == 0) {
      if (!leaving.empty()) wait_until(leaving.back());
      leaving.clear();
      wait_until(now_ps() + wire_ps(kHeaderBytes) + round_trip + clocks_ps(kPacketClocks));
    }
    if (static_cast<int64_t>(leaving.size()) > kReplies) {
      wait_until(leaving.front());
      leaving.pop_front();
    }
    load(address + packet * kChunkWords, kChunkWords);
    wait_until(now_ps() + clocks_ps(kReplyClocks));
    const int64_t wire_free = leaving.empty() ? now_ps() : std::max(now_ps(), leaving.back());
    leaving.push_back(wire_free + wire_ps(kChunkBytes + kHeaderBytes));
  }
  std::vector<uint8_t> data(static_cast<size_t>(configuration_.result_bytes_px * configuration_.result_px()));
  const int64_t bytes = static_cast<int64_t>(data.size());
  from_board_.peek(result.address, data.data(), bytes);
  wait_until(leaving.back());
  wait_until(to_host_.write(fetched.address, data.data(), bytes));
  if (configuration_.board_cameras) ask();  // to give up the frame
  fetched.frame = result.frame;
  ends_.results.release(result);
  ends_.fetched.publish(fetched);
}

}  // namespace vista
