// vista_sdram_trace: the memory of a board (model/systemc/src/clocks/sdram.h) between ports that ask for what standard
// input says, as LiteDRAM can be driven.
//
// Input: the clock's frequency in Hz, then commands, a line each: port, 1 for a write, address of the word, and the clock
// from which it is offered; those of a port in order. Each is offered until it is taken, the next one not before the clock
// after. Output, in the order of the input: the clocks in which it was taken and in which its word came or went.

#include <array>
#include <cstdio>
#include <deque>
#include <iostream>
#include <vector>

#include "clocks/sdram.h"

using vista::clocks::Sdram;

namespace {

struct Asked {
  Sdram::Command command;
  int64_t from = 0, taken = -1, moved = -1;
};

}  // namespace

int main() {
  double hz = 0;
  std::cin >> hz;
  std::vector<Asked> all;
  std::array<std::deque<size_t>, Sdram::kPorts> offered, inside;
  for (Asked asked; std::cin.good();) {
    size_t port = 0;
    if (!(std::cin >> port >> asked.command.writes >> asked.command.address >> asked.from)) break;
    asked.command.valid = true;
    offered.at(port).push_back(all.size());
    all.push_back(asked);
  }
  Sdram sdram(hz);
  size_t left = all.size();
  for (int64_t clock = 0; left > 0; ++clock) {
    std::array<Sdram::Command, Sdram::kPorts> commands;
    for (size_t port = 0; port < Sdram::kPorts; ++port)
      if (!offered[port].empty() && all[offered[port].front()].from <= clock)
        commands[port] = all[offered[port].front()].command;
    sdram.edge(commands);
    if (sdram.served() >= 0) {
      std::deque<size_t>& queue = inside[static_cast<size_t>(sdram.served())];
      Asked& asked = all[queue.front()];
      asked.moved = clock + (asked.command.writes ? Sdram::kWriteClocks : Sdram::kReadClocks);
      queue.pop_front();
      --left;
    }
    for (size_t port = 0; port < Sdram::kPorts; ++port) {
      if (!sdram.accepted(static_cast<int>(port))) continue;
      all[offered[port].front()].taken = clock;
      inside[port].push_back(offered[port].front());
      offered[port].pop_front();
    }
  }
  for (const Asked& asked : all)
    std::printf("%lld %lld\n", static_cast<long long>(asked.taken), static_cast<long long>(asked.moved));
  return 0;
}
