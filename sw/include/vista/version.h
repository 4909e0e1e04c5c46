/* The version of libvista, by semantic versioning. VERSION at the top of the repository holds the same number. */
#ifndef VISTA_VERSION_H
#define VISTA_VERSION_H

#include "vista/api.h"

#define VISTA_VERSION_MAJOR 0
#define VISTA_VERSION_MINOR 2
#define VISTA_VERSION_PATCH 0
#define VISTA_VERSION_STRING "0.2.0"

VISTA_BEGIN

/* VISTA_VERSION_STRING of the library that is linked, which may be newer than this header; never null. */
VISTA_API const char *vista_version(void);

VISTA_END

#endif
