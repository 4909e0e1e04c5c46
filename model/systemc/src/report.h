// The output of a run: doc/design/system-model.md, "Output".
#ifndef VISTA_SYSTEM_REPORT_H
#define VISTA_SYSTEM_REPORT_H

#include <ostream>

#include "system.h"

namespace vista {

void write_report(const System& system, std::ostream& out);

}  // namespace vista

#endif
