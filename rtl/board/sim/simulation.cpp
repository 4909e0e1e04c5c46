// SPDX-License-Identifier: Apache-2.0
#include "simulation.h"

#include <cstdio>
#include <cstdlib>

namespace {

constexpr int kGapClocks = 12, kResetClocks = 20;
constexpr size_t kPreamble = 8;

}  // namespace

Simulation::Simulation(const Faults& faults, const SensorOptions& sensors) : faults_(faults), random_(faults.seed) {
  if (!sensors.pairs.empty()) sensors_ = std::make_unique<Sensors>(sensors);
  board_->clk = 0;
  board_->rst = 1;
  for (int i = 0; i < kResetClocks; ++i) clock();
  board_->rst = 0;
}

bool Simulation::happens(double share, long long* times) {
  const bool does = std::uniform_real_distribution<>(0, 1)(random_) < share;
  *times += does;
  return does;
}

void Simulation::clock() {
  board_->clk = 0;
  board_->eval();
  board_->clk = 1;
  board_->eval();
  ++clocks_;
  for (ethernet_phase_ += kEthernetMhz; ethernet_phase_ >= kClockMhz; ethernet_phase_ -= kClockMhz) ethernet_clock();
  if (sensors_) sensor_clocks();
}

void Simulation::sensor_clocks() {
  sensors_->board_clock(clocks_, kClockMhz);
  for (int side = 0; side < 2; ++side) {
    for (int clocks = sensors_->clocks_of(side, kClockMhz); clocks > 0; --clocks) {
      const Wires wires = sensors_->next(side);
      uint8_t& clk = side == 0 ? board_->left_clk : board_->right_clk;
      (side == 0 ? board_->left_vsync : board_->right_vsync) = wires.vsync;
      (side == 0 ? board_->left_href : board_->right_href) = wires.href;
      (side == 0 ? board_->left_data : board_->right_data) = wires.data;
      clk = 0;
      board_->eval();
      clk = 1;
      board_->eval();
    }
  }
}

void Simulation::ethernet_clock() {
  drive();
  board_->eth_clk = 0;
  board_->eval();
  board_->eth_clk = 1;
  board_->eval();
  if (board_->tx_valid) {
    from_board_.push_back(board_->tx_data);
  } else if (!from_board_.empty()) {
    take(from_board_);
    from_board_.clear();
  }
}

void Simulation::send(const uint8_t* payload, size_t bytes, uint16_t port) {
  active_ = clocks_;
  ++counts_.packets;
  Bytes frame = udp_frame(payload, bytes, port);
  if (happens(faults_.damage, &counts_.damaged)) {
    const size_t place = kPreamble + random_() % (frame.size() - kPreamble);
    if (random_() % 2)
      frame.resize(place);
    else
      frame[place] ^= 1 << random_() % 8;
  }
  if (happens(faults_.drop, &counts_.dropped)) return;
  to_board_.push_back(frame);
  if (happens(faults_.twice, &counts_.doubled)) to_board_.push_back(frame);
}

// A byte a clock, and a gap after each frame.
void Simulation::drive() {
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

void Simulation::take(const Bytes& frame) {
  active_ = clocks_;
  ToHost packet{};
  switch (look_at(frame, &packet.payload, &packet.port)) {
    case Frame::kArpRequest:
      to_board_.push_back(arp_reply(frame));
      break;
    case Frame::kUdp:
      ++counts_.packets;
      if (happens(faults_.drop, &counts_.dropped)) break;
      to_host.push_back(packet);
      if (happens(faults_.twice, &counts_.doubled)) to_host.push_back(packet);
      break;
    case Frame::kBad:
      std::fprintf(stderr, "board-sim: the board sent a damaged frame\n");
      std::exit(1);
    case Frame::kOther:
      break;
  }
}
