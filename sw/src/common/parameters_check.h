/* One way for all stages to check their parameters: against the table of sw/parameters.toml. Internal to libvista. */
#ifndef VISTA_SRC_PARAMETERS_CHECK_H
#define VISTA_SRC_PARAMETERS_CHECK_H

#include <stddef.h>

#include "vista/parameters.h"

/* Checks the section at this offset in vista_parameters. VISTA_ERROR_RANGE as vista_parameters_check. */
vista_status vista_parameters_check_section(size_t offset, const void *section);

/* Takes what a caller with another header has, and the defaults of the rest. */
vista_parameters vista_parameters_own(const vista_parameters *parameters);

#define VISTA_CHECK_SECTION(name, section) \
  vista_parameters_check_section(offsetof(vista_parameters, name), (const vista_##name##_params *){section})

#endif
