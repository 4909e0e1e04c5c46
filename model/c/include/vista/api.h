/* What the public functions are declared with: C linkage, and visible outside the shared library. */
#ifndef VISTA_API_H
#define VISTA_API_H

#ifdef __cplusplus
#define VISTA_BEGIN extern "C" {
#define VISTA_END }
#else
#define VISTA_BEGIN
#define VISTA_END
#endif

#ifdef __GNUC__
#define VISTA_API __attribute__((visibility("default")))
#else
#define VISTA_API
#endif

#endif
