/* Latencies of a flight of any length in memory of one size: a histogram whose bins are 2 % wide, as vista.live has. */
#ifndef VISTA_FLY_LATENCY_H
#define VISTA_FLY_LATENCY_H

#include <stdint.h>

#define LATENCY_BINS 700

typedef struct latency {
  int64_t total, counts[LATENCY_BINS];
  double most_ms;
} latency;

void latency_add(latency *l, int64_t latency_ns);

/* percent: 0 .. 100. 0 before the first. */
double latency_percentile_ms(const latency *l, double percent);

#endif
