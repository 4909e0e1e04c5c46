// SPDX-License-Identifier: Apache-2.0
// The simulated board and the client of libvista in one program and one time: the board's clocks go on only while the
// client waits, for an answer or for a pause to end, and the client's clock is the board's. What the client computes
// takes no time; what a network and a host take can be given. Each run gives the same clocks, on a machine however busy.
//
//   board-clocks WIDTH HEIGHT LEVELS FRAMES [ROUND_TRIP_NS [--pairs FILE --words FILE [options of the sensors]]]
//
// Sends and fetches frames as fast as the client does, two at a time on the board. Prints for each frame the clock in
// which the engine began with it and the one in which it had ended. The linker puts the functions named __wrap_ in place
// of those of the system.
//
// With pairs the board takes them from its sensors (rtl/board/sim/sensors.h), smoothed, and the client receives them; the
// words go to a file. Then there are lines with a word before them: `frame`, its number and the clock in which all its
// words were there; `fault`, moment, side and what happened to a sensor; `counts`, what the client counted, and moments.

#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <deque>
#include <fstream>
#include <string>
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
  Host(int64_t round_trip_ns, const SensorOptions &sensors)
      : board_(Faults{}, sensors), round_trip_ns_(round_trip_ns) {}

  int64_t clocks() const { return board_.clocks(); }
  const Sensors &sensors() const { return *board_.sensors(); }

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

  Simulation board_;
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

struct Options {
  int32_t width = 0, height = 0, levels = 0, frames = 0;
  int64_t round_trip_ns = 0;
  SensorOptions sensors;
  std::string words;
};

Options parse(int argc, char **argv) {
  Options options;
  options.width = std::atoi(argv[1]);
  options.height = std::atoi(argv[2]);
  options.levels = std::atoi(argv[3]);
  options.frames = std::atoi(argv[4]);
  if (argc > 5) options.round_trip_ns = std::atoll(argv[5]);
  for (int i = 6; i + 1 < argc; i += 2) {
    if (argv[i] == std::string("--words"))
      options.words = argv[i + 1];
    else if (!take_sensor_option(&options.sensors, argv[i], argv[i + 1]))
      std::fprintf(stderr, "board-clocks: unknown option %s\n", argv[i]), std::exit(2);
  }
  options.sensors.width = options.width;
  options.sensors.height = options.height;
  return options;
}

void stream(vista_board *board, const Options &options, std::vector<int16_t> *words) {
  std::ofstream file(options.words, std::ios::binary);
  check(vista_board_start(board));
  for (int frame = 0; frame < options.frames; ++frame) {
    vista_board_pair pair;
    check(vista_board_receive(board, words->data(), static_cast<int64_t>(words->size()), &pair));
    std::printf("frame %lld %lld %lld %lld\n", static_cast<long long>(pair.number),
                static_cast<long long>(host->clocks()), static_cast<long long>(pair.t_ns),
                static_cast<long long>(pair.came_ns));
    file.write(reinterpret_cast<const char *>(words->data()), static_cast<std::streamsize>(2 * words->size()));
  }
  check(vista_board_stop(board));
  const vista_board_counts counts = vista_board_count(board);
  for (const FaultOf &fault : host->sensors().faults())
    std::printf("fault %lld %d %s\n", static_cast<long long>(fault.moment), fault.side, name_of(fault.what));
  std::printf("counts %lld %lld %lld %lld %lld\n", static_cast<long long>(counts.frames),
              static_cast<long long>(counts.lost), static_cast<long long>(counts.refused_left),
              static_cast<long long>(counts.refused_right), static_cast<long long>(host->sensors().moments()));
}

void exchange(vista_board *board, const Options &options, std::vector<int16_t> *words) {
  const std::vector<uint8_t> image(static_cast<size_t>(options.width) * options.height);
  for (int frame = 0; frame <= options.frames; ++frame) {
    if (frame < options.frames) check(vista_board_submit(board, image.data(), image.data(), options.width));
    if (frame > 0) check(vista_board_collect(board, words->data(), static_cast<int64_t>(words->size())));
  }
}

void run(const Options &options) {
  const bool cameras = !options.sensors.pairs.empty();
  std::vector<char> memory(vista_board_bytes());
  vista_board *board = nullptr;
  check(vista_board_connect(memory.data(), memory.size(), "127.0.0.1", VISTA_BOARD_PORT, kTimeoutMs, &board));
  vista_board_settings settings{};
  settings.width_px = options.width;
  settings.height_px = options.height;
  settings.xsobel = 1;
  settings.prefilter_cap = 31;
  settings.texture_threshold = 10;
  settings.uniqueness_ratio = 15;
  settings.lr_max_diff = 1;
  settings.levels = options.levels;
  settings.smooth = settings.cameras = cameras;
  check(vista_board_configure(board, &settings));
  std::vector<int16_t> words(static_cast<size_t>(vista_board_words(board)));
  (cameras ? stream : exchange)(board, options, &words);
  vista_board_disconnect(board);
}

} // namespace

int main(int argc, char **argv) {
  Verilated::commandArgs(argc, argv);
  if (argc < 5) {
    std::fprintf(stderr, "usage: board-clocks WIDTH HEIGHT LEVELS FRAMES [ROUND_TRIP_NS [OPTIONS]]\n");
    return 2;
  }
  const Options options = parse(argc, argv);
  Host with_board(options.round_trip_ns, options.sensors);
  host = &with_board;
  run(options);
}
