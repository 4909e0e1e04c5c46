/* Latencies of a flight of any length in memory of one size: a histogram whose bins are 2 % wide, from 0.1 ms to 100 s. */
#ifndef VISTA_LATENCY_H
#define VISTA_LATENCY_H

#include <stdint.h>

#include "vista/api.h"

VISTA_BEGIN

#define VISTA_LATENCY_BINS 700

/* An empty one is of zeros. */
typedef struct vista_latency {
  int64_t total, counts[VISTA_LATENCY_BINS];
  double last_ms, most_ms;
} vista_latency;

/* Counts one more. */
VISTA_API void vista_latency_add(vista_latency *latency, double ms);

/* The percentile, 0 .. 100, good to 1 %. 0 before the first. */
VISTA_API double vista_latency_percentile_ms(const vista_latency *latency, double percent);

VISTA_END

#endif
