#include "memory.h"

#include <cmath>
#include <cstring>

#include "timing.h"

namespace vista {

Memory::Memory(const sc_core::sc_module_name& name, const Configuration& c, int64_t bytes)
    : sc_module(name),
      port("port"),
      bytes_(static_cast<size_t>(bytes)),
      ps_per_byte_(1e12 / c.memory_bandwidth_bytes_s),
      overhead_ps_(c.memory_burst_overhead_ns * 1e3),
      latency_(from_ns(c.memory_latency_ns)),
      by_priority_(c.memory_priority) {
  port.register_b_transport(this, &Memory::b_transport);
  port.register_transport_dbg(this, &Memory::transport_dbg);
  SC_HAS_PROCESS(Memory);
  SC_METHOD(release);
  dont_initialize();
  sensitive << released_;
}

void Memory::add_master(const std::string& name, int rank) {
  masters_.push_back({name, rank, 0, 0, 0});
  waiting_.emplace_back();
}

void Memory::b_transport(int id, tlm::tlm_generic_payload& burst, sc_core::sc_time& delay) {
  const size_t master = static_cast<size_t>(id);
  sc_core::wait(delay);
  const int64_t asked = now_ps();
  if (taken_) {
    waiting_[master].waits = true;
    sc_core::wait(waiting_[master].granted);
    waiting_[master].waits = false;
  }
  taken_ = true;
  last_ = id;
  MasterCounts& counts = masters_[master];
  counts.waited_ps += now_ps() - asked;
  if (!copy(burst)) return;
  // Rounded up, so that no more than the bandwidth is ever served.
  const int64_t occupied = static_cast<int64_t>(std::ceil(overhead_ps_ + ps_per_byte_ * burst.get_data_length()));
  counts.bytes += burst.get_data_length();
  ++counts.bursts;
  busy_ps_ += occupied;
  released_.notify(from_ps(occupied));
  delay = from_ps(occupied) + latency_;
}

unsigned Memory::transport_dbg(int, tlm::tlm_generic_payload& peek) { return copy(peek) ? peek.get_data_length() : 0; }

bool Memory::copy(tlm::tlm_generic_payload& payload) {
  const uint64_t address = payload.get_address(), length = payload.get_data_length();
  if (address > bytes_.size() || length > bytes_.size() - address) {
    payload.set_response_status(tlm::TLM_ADDRESS_ERROR_RESPONSE);
    return false;
  }
  if (payload.is_write())
    std::memcpy(bytes_.data() + address, payload.get_data_ptr(), length);
  else
    std::memcpy(payload.get_data_ptr(), bytes_.data() + address, length);
  payload.set_response_status(tlm::TLM_OK_RESPONSE);
  return true;
}

void Memory::release() {
  const int next = next_waiting();
  taken_ = next >= 0;  // handed on in the same instant
  if (taken_) waiting_[static_cast<size_t>(next)].granted.notify();
}

int Memory::next_waiting() const {
  const int n = static_cast<int>(masters_.size());
  int best = -1;
  for (int turn = 1; turn <= n; ++turn) {  // from the one after the last served
    const int id = (last_ + turn) % n;
    if (!waiting_[static_cast<size_t>(id)].waits) continue;
    if (!by_priority_) return id;
    if (best < 0 || masters_[static_cast<size_t>(id)].rank < masters_[static_cast<size_t>(best)].rank) best = id;
  }
  return best;
}

Master::Master(const std::string& name, Memory& memory, int rank) : name_(name), socket_((name + "_port").c_str()) {
  memory.add_master(name, rank);
  socket_.bind(memory.port);
}

int64_t Master::write(int64_t address, const uint8_t* data, int64_t bytes) {
  return transport(tlm::TLM_WRITE_COMMAND, address, const_cast<uint8_t*>(data), bytes);
}

int64_t Master::read(int64_t address, uint8_t* data, int64_t bytes) {
  return transport(tlm::TLM_READ_COMMAND, address, data, bytes);
}

namespace {

void fill(tlm::tlm_generic_payload& payload, tlm::tlm_command command, int64_t address, uint8_t* data, int64_t bytes) {
  payload.set_command(command);
  payload.set_address(static_cast<uint64_t>(address));
  payload.set_data_ptr(data);
  payload.set_data_length(static_cast<unsigned>(bytes));
  payload.set_streaming_width(static_cast<unsigned>(bytes));
  payload.set_byte_enable_ptr(nullptr);
  payload.set_dmi_allowed(false);
  payload.set_response_status(tlm::TLM_INCOMPLETE_RESPONSE);
}

}  // namespace

void Master::peek(int64_t address, uint8_t* data, int64_t bytes) {
  tlm::tlm_generic_payload payload;
  fill(payload, tlm::TLM_READ_COMMAND, address, data, bytes);
  socket_->transport_dbg(payload);
}

void Master::poke(int64_t address, const uint8_t* data, int64_t bytes) {
  tlm::tlm_generic_payload payload;
  fill(payload, tlm::TLM_WRITE_COMMAND, address, const_cast<uint8_t*>(data), bytes);
  socket_->transport_dbg(payload);
}

int64_t Master::transport(tlm::tlm_command command, int64_t address, uint8_t* data, int64_t bytes) {
  tlm::tlm_generic_payload payload;
  sc_core::sc_time delay = sc_core::SC_ZERO_TIME;
  fill(payload, command, address, data, bytes);
  socket_->b_transport(payload, delay);
  if (payload.is_response_error()) SC_REPORT_FATAL(name_.c_str(), payload.get_response_string().c_str());
  return now_ps() + static_cast<int64_t>(delay.value());
}

}  // namespace vista
