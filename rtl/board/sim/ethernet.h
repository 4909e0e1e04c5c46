// SPDX-License-Identifier: Apache-2.0
// Ethernet frames between one host and the simulated board.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

using Bytes = std::vector<uint8_t>;

enum class Frame { kBad, kArpRequest, kUdp, kOther };

// A UDP packet of the host to the board, from preamble to check sum.
Bytes udp_frame(const uint8_t* payload, size_t bytes, uint16_t source_port);

// The host's answer to a request for its address.
Bytes arp_reply(const Bytes& request);

// What the board sent; payload and port of UDP to the host. Bad: no preamble, or a wrong check sum.
Frame look_at(const Bytes& frame, Bytes* payload, uint16_t* port);
