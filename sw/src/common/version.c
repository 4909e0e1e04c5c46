#include "vista/version.h"

const char *vista_version(void) { return VISTA_VERSION_STRING; }
