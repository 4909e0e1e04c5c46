// Rectification on the host, in time only: the pairs come rectified, so they are copied, burst by burst over the time
// that the work was measured to take (longer if memory does not keep up).
#ifndef VISTA_SYSTEM_RECTIFIER_H
#define VISTA_SYSTEM_RECTIFIER_H

#include <systemc>

#include "buffer_pool.h"
#include "configuration.h"
#include "host_core.h"
#include "memory.h"

namespace vista {

class Rectifier : public sc_core::sc_module {
 public:
  Rectifier(const sc_core::sc_module_name& name, const Configuration& configuration, Memory& memory,
            BufferPool& captured, BufferPool& rectified, HostCore& core, FrameLog& log);

  int64_t busy_ps() const { return busy_ps_; }

 private:
  void run();
  void copy(const Buffer& from, const Buffer& to);

  const Configuration& configuration_;
  Master master_;
  BufferPool &captured_, &rectified_;
  HostCore& core_;
  FrameLog& log_;
  int64_t busy_ps_ = 0;
};

}  // namespace vista

#endif
