// SPDX-License-Identifier: Apache-2.0
#include "ethernet.h"

#include <algorithm>
#include <array>

namespace {

constexpr size_t kPreamble = 8, kMac = 14, kIp = 20, kUdp = 8, kCheckSum = 4, kLeast = 60;
constexpr uint16_t kPort = 22099;
constexpr std::array<uint8_t, 6> kBoardMac = {0x02, 0x56, 192, 168, 1, 50}, kHostMac = {2, 0, 0, 0, 0, 1};
constexpr std::array<uint8_t, 4> kBoardIp = {192, 168, 1, 50}, kHostIp = {192, 168, 1, 100};

uint32_t crc32(const uint8_t* data, size_t bytes) {
  uint32_t crc = ~0u;
  for (size_t i = 0; i < bytes; ++i) {
    crc ^= data[i];
    for (int bit = 0; bit < 8; ++bit) crc = crc >> 1 ^ (crc & 1 ? 0xEDB88320u : 0);
  }
  return ~crc;
}

template <typename Numbers>
void append(Bytes* out, const Numbers& numbers) {
  out->insert(out->end(), numbers.begin(), numbers.end());
}

void append16(Bytes* out, size_t value) { append(out, std::array<uint8_t, 2>{uint8_t(value >> 8), uint8_t(value)}); }

size_t read16(const Bytes& in, size_t at) { return size_t(in[at]) << 8 | in[at + 1]; }

Bytes begin_frame(uint16_t type) {
  Bytes out(kPreamble - 1, 0x55);
  out.push_back(0xD5);
  append(&out, kBoardMac);
  append(&out, kHostMac);
  append16(&out, type);
  return out;
}

Bytes end_frame(Bytes out) {
  out.resize(std::max(out.size(), kPreamble + kLeast));
  const uint32_t crc = crc32(&out[kPreamble], out.size() - kPreamble);
  for (int i = 0; i < 4; ++i) out.push_back(uint8_t(crc >> 8 * i));
  return out;
}

}  // namespace

Bytes udp_frame(const uint8_t* payload, size_t bytes, uint16_t source_port) {
  Bytes out = begin_frame(0x0800);
  const size_t ip = out.size();
  append16(&out, 0x4500);
  append16(&out, kIp + kUdp + bytes);
  append16(&out, 0);
  append16(&out, 0x4000);
  append16(&out, 0x4011);  // 64 hops, UDP
  append16(&out, 0);
  append(&out, kHostIp);
  append(&out, kBoardIp);
  size_t sum = 0;
  for (size_t i = ip; i < out.size(); i += 2) sum += read16(out, i);
  while (sum >> 16) sum = (sum & 0xFFFF) + (sum >> 16);
  out[ip + 10] = uint8_t(~sum >> 8);
  out[ip + 11] = uint8_t(~sum);
  append16(&out, source_port);
  append16(&out, kPort);
  append16(&out, kUdp + bytes);
  append16(&out, 0);
  out.insert(out.end(), payload, payload + bytes);
  return end_frame(out);
}

Bytes arp_reply(const Bytes& request) {
  Bytes out = begin_frame(0x0806);
  append16(&out, 1);
  append16(&out, 0x0800);
  append16(&out, 0x0604);
  append16(&out, 2);
  append(&out, kHostMac);
  append(&out, kHostIp);
  const auto sender = request.begin() + kPreamble + kMac + 8;
  out.insert(out.end(), sender, sender + 10);
  return end_frame(out);
}

Frame look_at(const Bytes& frame, Bytes* payload, uint16_t* port) {
  if (frame.size() < kPreamble + kLeast + kCheckSum || frame[kPreamble - 1] != 0xD5) return Frame::kBad;
  const size_t end = frame.size() - kCheckSum;
  const uint32_t crc = crc32(&frame[kPreamble], end - kPreamble);
  for (int i = 0; i < 4; ++i)
    if (frame[end + size_t(i)] != uint8_t(crc >> 8 * i)) return Frame::kBad;
  const size_t type = read16(frame, kPreamble + 12), ip = kPreamble + kMac, udp = ip + kIp;
  if (type == 0x0806) return read16(frame, ip + 6) == 1 ? Frame::kArpRequest : Frame::kOther;
  if (type != 0x0800 || frame[ip + 9] != 17) return Frame::kOther;
  *port = uint16_t(read16(frame, udp + 2));
  const size_t bytes = read16(frame, udp + 4) - kUdp;
  if (udp + kUdp + bytes > end) return Frame::kBad;
  payload->assign(frame.begin() + ptrdiff_t(udp + kUdp), frame.begin() + ptrdiff_t(udp + kUdp + bytes));
  return Frame::kUdp;
}
