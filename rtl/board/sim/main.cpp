// SPDX-License-Identifier: Apache-2.0
// The simulated board on a UDP port of the loopback interface. What comes there reaches the board's PHY as an Ethernet
// frame of one host, from preamble to check sum, and what the board sends to that host leaves the port.
//
//   board-sim [--port N] [--drop P] [--double P] [--damage P] [--seed N]
//             [--pairs FILE --width PX --height PX [--pixel-mhz F] [--rate HZ] [--line-blanking PX] [--faults P]
//              [--sensor-seed N]]
//
// With pairs the board has two sensors that show them (sensors.h).
//
// Prints the port once it is open, and runs until its input ends; then it prints how many packets there were, and how
// many of them the link dropped, doubled and damaged. Its clocks go on while the client works: board-clocks is there for
// who wants to count them.

#include <arpa/inet.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "simulation.h"

namespace {

constexpr int kPollEvery = 64;
constexpr int kIdleClocks = 30000;  // without a packet, after which the simulation waits for one
constexpr size_t kMostWaiting = 64;  // packets; the rest waits in the socket, as on the way

struct Options {
  int port = 0;
  Faults faults;
  SensorOptions sensors;
};

Options parse(int argc, char** argv) {
  Options options;
  for (int i = 1; i + 1 < argc; i += 2) {
    const std::string name = argv[i];
    const double value = std::atof(argv[i + 1]);
    if (name == "--port")
      options.port = static_cast<int>(value);
    else if (name == "--drop")
      options.faults.drop = value;
    else if (name == "--double")
      options.faults.twice = value;
    else if (name == "--damage")
      options.faults.damage = value;
    else if (name == "--seed")
      options.faults.seed = static_cast<unsigned>(value);
    else if (!take_sensor_option(&options.sensors, name, argv[i + 1]))
      std::fprintf(stderr, "board-sim: unknown option %s\n", argv[i]), std::exit(2);
  }
  return options;
}

sockaddr_in loopback(int port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(static_cast<uint16_t>(port));
  return address;
}

int open_port(int port) {
  const int fd = socket(AF_INET, SOCK_DGRAM, 0);
  sockaddr_in address = loopback(port);
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

void receive(int fd, Simulation* board) {
  if (board->waiting() > kMostWaiting) return;
  uint8_t data[2048];
  sockaddr_in from{};
  socklen_t size = sizeof from;
  const ssize_t bytes = recvfrom(fd, data, sizeof data, MSG_DONTWAIT, reinterpret_cast<sockaddr*>(&from), &size);
  if (bytes >= 0) board->send(data, static_cast<size_t>(bytes), ntohs(from.sin_port));
}

void deliver(int fd, Simulation* board) {
  for (; !board->to_host.empty(); board->to_host.pop_front()) {
    const ToHost& packet = board->to_host.front();
    const sockaddr_in to = loopback(packet.port);
    sendto(fd, packet.payload.data(), packet.payload.size(), 0, reinterpret_cast<const sockaddr*>(&to), sizeof to);
  }
}

// Waits for a packet; false when the input has ended.
bool sleep_on(int fd) {
  pollfd ready[2] = {{fd, POLLIN, 0}, {STDIN_FILENO, POLLIN, 0}};
  poll(ready, 2, -1);
  char byte;
  return !ready[1].revents || read(STDIN_FILENO, &byte, 1) > 0;
}

}  // namespace

int main(int argc, char** argv) {
  Verilated::commandArgs(argc, argv);
  const Options options = parse(argc, argv);
  const int fd = open_port(options.port);
  Simulation board(options.faults, options.sensors);
  for (int64_t awake = 0;;) {
    if (board.clocks() % kPollEvery == 0) receive(fd, &board);
    board.clock();
    deliver(fd, &board);
    if (board.clocks() - std::max(board.active(), awake) <= kIdleClocks) continue;
    if (!sleep_on(fd)) break;
    awake = board.clocks();
  }
  const LinkCounts& counts = board.counts();
  std::printf("%lld packets, %lld dropped, %lld doubled, %lld damaged\n", counts.packets, counts.dropped,
              counts.doubled, counts.damaged);
}
