/* The times of all stages of each frame, for benches: a table of comma-separated values. All memory is taken when it is
 * made. */
#ifndef VISTA_FLY_TIMES_H
#define VISTA_FLY_TIMES_H

#include <stdint.h>

#include "problem.h"
#include "vista/detector.h"

typedef struct times {
  double *rows; /* null: they are not asked for */
  int64_t count, most;
} times;

bool times_make(times *t, int64_t most, problem *p);
void times_free(times *t);

/* cpu_ms: what the frame took of the processor. latency_ms: from its exposure until all was told of it. */
void times_add(times *t, const vista_detector_result *found, double cpu_ms, double latency_ms);

bool times_write(const times *t, const char *path, problem *p);

#endif
