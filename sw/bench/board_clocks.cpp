// SPDX-License-Identifier: Apache-2.0
// The simulated board and the client of libvista in one program and one time: the board's clocks go on only while the
// client waits, for an answer or for a pause to end, and the client's clock is the board's. What the client computes
// takes no time; what a network and a host take can be given. Each run gives the same clocks, on a machine however busy.
//
//   board-clocks WIDTH HEIGHT LEVELS FRAMES [ROUND_TRIP_NS]
//
// Sends and fetches frames as fast as the client does, two at a time on the board. Prints for each frame the clock in
// which the engine began with it and the one in which it had ended. The linker puts the functions named __wrap_ in place
// of those of the system.

#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <deque>
#include <vector>

#include <poll.h>
#include <sys/types.h>

#include "simulation.h"
#include "vista/board.h"

namespace {

constexpr uint16_t kHostPort = 40000;
constexpr int64_t kNsPerUs = 1000, kNsPerMs = 1000000, kNsPerS = 1000000000;
constexpr int32_t kTimeoutMs = 2000;

class Host {
 public:
  explicit Host(int64_t round_trip_ns) : round_trip_ns_(round_trip_ns) {}

  int64_t now_ns() const { return board_.clocks() * kNsPerUs / kClockMhz; }
  bool has_packet() const { return !arriving_.empty() && arriving_.front().due_ns <= now_ns(); }
  void send(const void *data, size_t bytes) { board_.send(static_cast<const uint8_t *>(data), bytes, kHostPort); }

  Bytes take() {
    const Bytes payload = arriving_.front().payload;
    arriving_.pop_front();
    return payload;
  }

  // Until a packet has come, if one is waited for, or until this time.
  void wait(int64_t until_ns, bool for_packet) {
    while (now_ns() < until_ns && !(for_packet && has_packet())) {
      board_.clock();
      for (; !board_.to_host.empty(); board_.to_host.pop_front())
        arriving_.push_back({now_ns() + round_trip_ns_, board_.to_host.front().payload});
      watch_engine();
    }
  }

 private:
  struct Arriving {
    int64_t due_ns;
    Bytes payload;
  };

  void watch_engine() {
    if (board_.engine_busy() == busy_) return;
    busy_ = !busy_;
    if (busy_)
      begun_ = board_.clocks();
    else
      std::printf("%lld %lld\n", static_cast<long long>(begun_), static_cast<long long>(board_.clocks()));
  }

  Simulation board_{Faults{}};
  int64_t round_trip_ns_;
  std::deque<Arriving> arriving_;
  bool busy_ = false;
  int64_t begun_ = 0;
};

Host *host; // what the functions of the system that the client calls are made of

} // namespace

extern "C" {

int __real_clock_gettime(clockid_t clock, timespec *now);

int __wrap_clock_gettime(clockid_t clock, timespec *now) {
  if (!host) return __real_clock_gettime(clock, now); // Verilator's, before there is a board
  now->tv_sec = static_cast<time_t>(host->now_ns() / kNsPerS);
  now->tv_nsec = static_cast<long>(host->now_ns() % kNsPerS);
  return 0;
}

int __wrap_nanosleep(const timespec *pause, timespec *) {
  host->wait(host->now_ns() + pause->tv_sec * kNsPerS + pause->tv_nsec, false);
  return 0;
}

int __wrap_poll(pollfd *, nfds_t, int timeout_ms) {
  host->wait(host->now_ns() + timeout_ms * kNsPerMs, true);
  return host->has_packet();
}

ssize_t __wrap_recv(int, void *data, size_t room, int) {
  if (!host->has_packet()) {
    errno = EAGAIN;
    return -1;
  }
  const Bytes payload = host->take();
  const size_t bytes = payload.size() < room ? payload.size() : room;
  std::memcpy(data, payload.data(), bytes);
  return static_cast<ssize_t>(bytes);
}

ssize_t __wrap_send(int, const void *data, size_t bytes, int) {
  host->send(data, bytes);
  return static_cast<ssize_t>(bytes);
}
}

namespace {

void check(vista_status status) {
  if (status == VISTA_OK) return;
  std::fprintf(stderr, "board-clocks: %s\n", vista_status_text(status));
  std::exit(1);
}

void run(int32_t width, int32_t height, int32_t levels, int frames) {
  std::vector<char> memory(vista_board_bytes());
  vista_board *board = nullptr;
  check(vista_board_connect(memory.data(), memory.size(), "127.0.0.1", VISTA_BOARD_PORT, kTimeoutMs, &board));
  vista_board_settings settings{};
  settings.width_px = width;
  settings.height_px = height;
  settings.xsobel = 1;
  settings.prefilter_cap = 31;
  settings.texture_threshold = 10;
  settings.uniqueness_ratio = 15;
  settings.lr_max_diff = 1;
  settings.levels = levels;
  check(vista_board_configure(board, &settings));
  const std::vector<uint8_t> image(static_cast<size_t>(width) * height);
  std::vector<int16_t> words(static_cast<size_t>(vista_board_words(board)));
  for (int frame = 0; frame <= frames; ++frame) {
    if (frame < frames) check(vista_board_submit(board, image.data(), image.data(), width));
    if (frame > 0) check(vista_board_collect(board, words.data(), static_cast<int64_t>(words.size())));
  }
  vista_board_disconnect(board);
}

} // namespace

int main(int argc, char **argv) {
  Verilated::commandArgs(argc, argv);
  if (argc < 5 || argc > 6) {
    std::fprintf(stderr, "usage: board-clocks WIDTH HEIGHT LEVELS FRAMES [ROUND_TRIP_NS]\n");
    return 2;
  }
  Host with_board(argc > 5 ? std::atoll(argv[5]) : 0);
  host = &with_board;
  run(std::atoi(argv[1]), std::atoi(argv[2]), std::atoi(argv[3]), std::atoi(argv[4]));
}
