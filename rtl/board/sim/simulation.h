// SPDX-License-Identifier: Apache-2.0
// The Verilated board with a wire to one host. Time passes only in clock().
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <random>

#include "Vboard.h"
#include "ethernet.h"
#include "sensors.h"

constexpr int kClockMhz = 45, kEthernetMhz = 125;

// The share of packets, of both directions, that the link drops or doubles, and of those to the board that it damages:
// half of these have a wrong bit, and half are cut off.
struct Faults {
  double drop = 0, twice = 0, damage = 0;
  unsigned seed = 1;
};

struct LinkCounts {
  long long packets, dropped, doubled, damaged;
};

// The payload of UDP, and the port that it goes to.
struct ToHost {
  Bytes payload;
  uint16_t port;
};

class Simulation {
 public:
  explicit Simulation(const Faults& faults, const SensorOptions& sensors = {});

  // One clock of the engine, and those of Ethernet that begin in it.
  void clock();

  // Puts a packet of the host on the wire, behind those that are waiting for it.
  void send(const uint8_t* payload, size_t bytes, uint16_t port);

  size_t waiting() const { return to_board_.size(); }
  int64_t clocks() const { return clocks_; }
  int64_t active() const { return active_; }  // the clock in which something was last on the wire
  bool engine_busy() const { return board_->busy; }
  const LinkCounts& counts() const { return counts_; }
  const Sensors* sensors() const { return sensors_.get(); }  // null: nothing is there

  std::deque<ToHost> to_host;  // what came from the board, for the caller to take

 private:
  bool happens(double share, long long* times);
  void ethernet_clock();
  void sensor_clocks();
  void drive();
  void take(const Bytes& frame);

  Faults faults_;
  std::mt19937 random_;
  std::unique_ptr<Vboard> board_ = std::make_unique<Vboard>();
  std::unique_ptr<Sensors> sensors_;
  std::deque<Bytes> to_board_;
  Bytes from_board_;
  size_t sent_ = 0;  // bytes of the first that waits
  int gap_ = 0, ethernet_phase_ = 0;
  int64_t clocks_ = 0, active_ = 0;
  LinkCounts counts_{};
};
