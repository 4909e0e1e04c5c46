// SPDX-License-Identifier: Apache-2.0
// The Verilated server of the board by itself (rtl/board/gateware/server_alone.py), with a C interface.

#include <cstdint>
#include <cstring>
#include <memory>

#include "Vserver.h"

namespace {

constexpr int64_t kMostClocks = 100000;  // for a packet
constexpr size_t kLargestReply = 2048;

struct Reply {
  uint8_t data[kLargestReply];
  size_t bytes;
};

struct Server {
  std::unique_ptr<Vserver> top = std::make_unique<Vserver>();
  int64_t clocks = 0, replies = 0;
  uint16_t port = 0;  // of whom replies are kept
  Reply now{}, kept{};

  void clock() {
    auto& t = *top;
    t.eval();
    if (t.out_valid) {
      if (now.bytes + 4 <= sizeof now.data) std::memcpy(now.data + now.bytes, &t.out_data, 4);
      now.bytes += 4;
      if (t.out_last) {
        ++replies;
        if (t.out_port == port) kept = now;
        now.bytes = 0;
      }
    }
    t.clk = 1;
    t.eval();
    t.clk = 0;
    ++clocks;
  }

  // Waits until a packet has room, and hands it over as it came from UDP: in whole words, with its length in bytes.
  bool send(const uint8_t* data, size_t bytes, uint32_t address, uint16_t from) {
    auto& t = *top;
    int64_t most = kMostClocks;
    for (t.eval(); !t.room; t.eval()) {
      if (--most == 0) return false;
      clock();
    }
    t.in_valid = 1;
    t.in_length = static_cast<uint16_t>(bytes);
    t.in_address = address;
    t.in_port = from;
    for (size_t at = 0; at == 0 || at < bytes; at += 4) {
      uint32_t word = 0;
      std::memcpy(&word, data + at, bytes - at < 4 ? bytes - at : 4);
      t.in_data = word;
      t.in_last = at + 4 >= bytes;
      clock();
    }
    t.in_valid = t.in_last = 0;
    return true;
  }

  bool settle() {
    int64_t most = kMostClocks;
    for (top->eval(); !top->idle; top->eval()) {
      if (--most == 0) return false;
      clock();
    }
    return true;
  }
};

}  // namespace

extern "C" {

Server* server_create(void) {
  auto* server = new Server;
  server->top->rst = 1;
  server->top->in_valid = 0;
  for (int i = 0; i < 8; ++i) server->clock();
  server->top->rst = 0;
  return server;
}

void server_destroy(Server* server) { delete server; }

int64_t server_clocks(const Server* server) { return server->clocks; }

int64_t server_replies(const Server* server) { return server->replies; }

// Lets so many clocks pass.
void server_wait(Server* server, int64_t clocks) {
  while (clocks-- > 0) server->clock();
}

// Sends `count` packets, one behind the other in `data`, each from its own address and port. Returns 0 if the server
// hangs, else 1.
int32_t server_send(Server* server, const uint8_t* data, const uint32_t* bytes, const uint32_t* addresses,
                    const uint16_t* ports, int64_t count) {
  for (int64_t i = 0; i < count; data += bytes[i], ++i) {
    if (!server->send(data, bytes[i], addresses[i], ports[i])) return 0;
  }
  return 1;
}

// Sends a packet behind all others, and waits until it has been obeyed. Returns the bytes of the last reply to its port,
// 0 without one, and -1 if the server hangs.
int64_t server_ask(Server* server, const uint8_t* data, uint32_t bytes, uint32_t address, uint16_t port,
                   uint8_t* reply) {
  if (!server->settle()) return -1;
  server->kept.bytes = 0;
  server->port = port;
  if (!server->send(data, bytes, address, port)) return -1;
  for (int i = 0; i < 4; ++i) server->clock();  // into the buffer of packets
  if (!server->settle()) return -1;
  server->port = 0;
  if (server->kept.bytes > kLargestReply) return -1;
  std::memcpy(reply, server->kept.data, server->kept.bytes);
  return static_cast<int64_t>(server->kept.bytes);
}
}
