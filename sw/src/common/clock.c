#define _POSIX_C_SOURCE 199309L /* clock_gettime */

#include "common/clock.h"

#include <time.h>

double vista_clock_ms(void) {
  struct timespec now = {0};
#ifdef CLOCK_MONOTONIC
  (void)clock_gettime(CLOCK_MONOTONIC, &now);
#else
  (void)timespec_get(&now, TIME_UTC); /* the wall clock is all that C itself has */
#endif
  return (double)now.tv_sec * 1e3 + (double)now.tv_nsec * 1e-6;
}
