// One memory port behind TLM-2.0: every burst takes the bus for overhead + bytes / bandwidth, alone; then its latency,
// while others have the bus. Waiting masters are served in turn, or by priority.
#ifndef VISTA_SYSTEM_MEMORY_H
#define VISTA_SYSTEM_MEMORY_H

#include <tlm_utils/multi_passthrough_target_socket.h>
#include <tlm_utils/simple_initiator_socket.h>

#include <cstdint>
#include <deque>
#include <string>
#include <systemc>
#include <tlm>
#include <vector>

#include "configuration.h"

namespace vista {

struct MasterCounts {
  std::string name;
  int rank = 0;  // priority, smaller first
  int64_t bytes = 0, bursts = 0;
  int64_t waited_ps = 0;  // for the bus
};

class Memory : public sc_core::sc_module {
 public:
  tlm_utils::multi_passthrough_target_socket<Memory> port;

  Memory(const sc_core::sc_module_name& name, const Configuration& configuration, int64_t bytes);

  // The master that is bound next.
  void add_master(const std::string& name, int rank);

  const std::deque<MasterCounts>& masters() const { return masters_; }
  int64_t busy_ps() const { return busy_ps_; }

 private:
  // Returns when the bus is granted; `delay` then tells when the burst is over and its data with the master.
  void b_transport(int id, tlm::tlm_generic_payload& burst, sc_core::sc_time& delay);
  unsigned transport_dbg(int id, tlm::tlm_generic_payload& peek);
  bool copy(tlm::tlm_generic_payload& payload);
  void release();
  int next_waiting() const;

  struct Waiting {
    bool waits = false;
    sc_core::sc_event granted;
  };

  std::vector<uint8_t> bytes_;
  double ps_per_byte_, overhead_ps_;
  sc_core::sc_time latency_;
  bool by_priority_;
  std::deque<MasterCounts> masters_;
  std::deque<Waiting> waiting_;
  bool taken_ = false;
  int last_ = 0;
  int64_t busy_ps_ = 0;
  sc_core::sc_event released_;
};

// Ranks of the masters for arbitration by priority: who cannot wait comes first.
enum Rank { kCaptureRank, kResultRank, kFetchRank, kRectifyRank, kHostRank, kBackgroundRank };

// One master's side of the port: what a DMA engine, or the host, issues bursts with. One burst waits at a time.
class Master {
 public:
  Master(const std::string& name, Memory& memory, int rank);

  // Suspends until the bus is granted; returns when the burst is complete, in ps of simulated time.
  int64_t write(int64_t address, const uint8_t* data, int64_t bytes);
  int64_t read(int64_t address, uint8_t* data, int64_t bytes);
  // Look, and change, without taking time.
  void peek(int64_t address, uint8_t* data, int64_t bytes);
  void poke(int64_t address, const uint8_t* data, int64_t bytes);

 private:
  int64_t transport(tlm::tlm_command command, int64_t address, uint8_t* data, int64_t bytes);

  std::string name_;
  tlm_utils::simple_initiator_socket<Master> socket_;
};

}  // namespace vista

#endif
