// SPDX-License-Identifier: Apache-2.0
// The simulated board on a UDP port of the loopback interface. What comes there reaches the board's PHY as an Ethernet
// frame of one host, from preamble to check sum, and what the board sends to that host leaves the port.
//
//   board-sim [--port N] [--drop P] [--double P] [--damage P] [--seed N] [--clocks FILE]
//
// P: the share of packets, of both directions, that the link drops, doubles, or damages by a bit on the way to the board.
// Prints the port once it is open, and runs until its input ends. FILE gets, for each frame that was matched, the clock
// in which the engine began with it and the one in which it had ended.

#include <arpa/inet.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <deque>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "Vboard.h"
#include "ethernet.h"
#include "verilated.h"

namespace {

constexpr int kClockMhz = 45, kEthernetMhz = 125;
constexpr int kGapClocks = 12, kPollEvery = 64;
constexpr int kIdleClocks = 30000;  // without a packet, after which the simulation waits for one

struct Options {
  int port = 0;
  double drop = 0, twice = 0, damage = 0;
  unsigned seed = 1;
  std::string clocks;  // a path, empty: none
};

Options parse(int argc, char** argv) {
  Options options;
  for (int i = 1; i + 1 < argc; i += 2) {
    const std::string name = argv[i];
    const double value = std::atof(argv[i + 1]);
    if (name == "--port")
      options.port = static_cast<int>(value);
    else if (name == "--drop")
      options.drop = value;
    else if (name == "--double")
      options.twice = value;
    else if (name == "--damage")
      options.damage = value;
    else if (name == "--seed")
      options.seed = static_cast<unsigned>(value);
    else if (name == "--clocks")
      options.clocks = argv[i + 1];
    else
      std::fprintf(stderr, "board-sim: unknown option %s\n", argv[i]), std::exit(2);
  }
  return options;
}

int open_port(int port) {
  const int fd = socket(AF_INET, SOCK_DGRAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(static_cast<uint16_t>(port));
  socklen_t size = sizeof address;
  if (fd < 0 || bind(fd, reinterpret_cast<sockaddr*>(&address), size) != 0) {
    std::perror("board-sim: no port");
    std::exit(2);
  }
  getsockname(fd, reinterpret_cast<sockaddr*>(&address), &size);
  std::printf("%d\n", ntohs(address.sin_port));
  std::fflush(stdout);
  return fd;
}

class Simulation {
 public:
  explicit Simulation(const Options& options)
      : options_(options), random_(options.seed), socket_(open_port(options.port)) {
    board_->clk = 0;
    board_->rst = 1;
    for (int i = 0; i < 20; ++i) clock();
    board_->rst = 0;
    if (!options.clocks.empty() && !(frames_ = std::fopen(options.clocks.c_str(), "w"))) {
      std::perror("board-sim: --clocks");
      std::exit(2);
    }
  }
  ~Simulation() {
    if (frames_) std::fclose(frames_);
  }
  Simulation(const Simulation&) = delete;
  Simulation& operator=(const Simulation&) = delete;

  void run() {
    for (;;) {
      if (clocks_ % kPollEvery == 0) receive();
      clock();
      if (frames_) watch_engine();
      if (clocks_ - active_ > kIdleClocks && !sleep()) return;
    }
  }

 private:
  bool happens(double share) { return std::uniform_real_distribution<>(0, 1)(random_) < share; }

  void clock() {
    board_->clk = 0;
    board_->eval();
    board_->clk = 1;
    board_->eval();
    ++clocks_;
    for (ethernet_phase_ += kEthernetMhz; ethernet_phase_ >= kClockMhz; ethernet_phase_ -= kClockMhz) ethernet_clock();
  }

  void ethernet_clock() {
    drive();
    board_->eth_clk = 0;
    board_->eval();
    board_->eth_clk = 1;
    board_->eval();
    if (board_->tx_valid) {
      from_board_.push_back(board_->tx_data);
    } else if (!from_board_.empty()) {
      answer(from_board_);
      from_board_.clear();
    }
  }

  void watch_engine() {
    if (board_->busy == busy_) return;
    busy_ = board_->busy;
    if (busy_)
      begun_ = clocks_;
    else
      std::fprintf(frames_, "%lld %lld\n", static_cast<long long>(begun_), static_cast<long long>(clocks_));
  }

  // Waits for a packet; false when the input has ended.
  bool sleep() {
    pollfd ready[2] = {{socket_, POLLIN, 0}, {STDIN_FILENO, POLLIN, 0}};
    poll(ready, 2, -1);
    char byte;
    if (ready[1].revents && read(STDIN_FILENO, &byte, 1) <= 0) return false;
    active_ = clocks_;
    return true;
  }

  void receive() {
    if (to_board_.size() > 64) return;  // the rest waits in the socket, as on the way
    uint8_t data[2048];
    sockaddr_in from{};
    socklen_t size = sizeof from;
    const ssize_t bytes = recvfrom(socket_, data, sizeof data, MSG_DONTWAIT, reinterpret_cast<sockaddr*>(&from), &size);
    if (bytes < 0) return;
    active_ = clocks_;
    Bytes frame = udp_frame(data, static_cast<size_t>(bytes), ntohs(from.sin_port));
    if (happens(options_.damage)) frame[8 + random_() % (frame.size() - 8)] ^= 1 << random_() % 8;
    if (happens(options_.drop)) return;
    to_board_.push_back(frame);
    if (happens(options_.twice)) to_board_.push_back(frame);
  }

  // A byte a clock, and a gap after each frame.
  void drive() {
    board_->rx_valid = 0;
    if (gap_ > 0) {
      --gap_;
    } else if (!to_board_.empty()) {
      const Bytes& frame = to_board_.front();
      board_->rx_valid = 1;
      board_->rx_data = frame[sent_++];
      active_ = clocks_;
      if (sent_ == frame.size()) {
        to_board_.pop_front();
        sent_ = 0;
        gap_ = kGapClocks;
      }
    }
  }

  void answer(const Bytes& frame) {
    active_ = clocks_;
    Bytes payload;
    uint16_t port = 0;
    switch (look_at(frame, &payload, &port)) {
      case Frame::kArpRequest:
        to_board_.push_back(arp_reply(frame));
        break;
      case Frame::kUdp:
        send_to_host(payload, port);
        break;
      case Frame::kBad:
        std::fprintf(stderr, "board-sim: the board sent a damaged frame\n");
        std::exit(1);
      case Frame::kOther:
        break;
    }
  }

  void send_to_host(const Bytes& payload, uint16_t port) {
    if (happens(options_.drop)) return;
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    to.sin_port = htons(port);
    for (int i = happens(options_.twice) ? 2 : 1; i > 0; --i)
      sendto(socket_, payload.data(), payload.size(), 0, reinterpret_cast<sockaddr*>(&to), sizeof to);
  }

  Options options_;
  std::mt19937 random_;
  int socket_;
  std::unique_ptr<Vboard> board_ = std::make_unique<Vboard>();
  std::deque<Bytes> to_board_;
  Bytes from_board_;
  size_t sent_ = 0;
  int gap_ = 0, ethernet_phase_ = 0;
  int64_t clocks_ = 0, active_ = 0;
  std::FILE* frames_ = nullptr;
  bool busy_ = false;
  int64_t begun_ = 0;
};

}  // namespace

int main(int argc, char** argv) {
  Verilated::commandArgs(argc, argv);
  Simulation(parse(argc, argv)).run();
}
