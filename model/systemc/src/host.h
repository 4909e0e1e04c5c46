// The host behind the engine: reads a result from memory, then runs its stages, each for a time that was measured.
#ifndef VISTA_SYSTEM_HOST_H
#define VISTA_SYSTEM_HOST_H

#include <ostream>
#include <systemc>

#include "buffer_pool.h"
#include "configuration.h"
#include "host_core.h"
#include "memory.h"

namespace vista {

class Host : public sc_core::sc_module {
 public:
  // `words_out` may be null.
  Host(const sc_core::sc_module_name& name, const Configuration& configuration, Memory& memory, BufferPool& results,
       HostCore& core, FrameLog& log, std::ostream* words_out);

  int64_t busy_ps() const { return busy_ps_; }

 private:
  void run();
  void read(const Buffer& result);

  const Configuration& configuration_;
  Master master_;
  BufferPool& results_;
  HostCore& core_;
  FrameLog& log_;
  std::ostream* words_out_;
  int64_t busy_ps_ = 0;
};

}  // namespace vista

#endif
