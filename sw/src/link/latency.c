#include "vista/latency.h"

#include <math.h>

#define LEAST_MS 0.1
#define MOST_MS 100000.0
#define PER_BIN 1.02

void vista_latency_add(vista_latency *l, double ms) {
  const double clipped_ms = fmin(fmax(ms, LEAST_MS), MOST_MS);
  ++l->counts[(int)(log(clipped_ms / LEAST_MS) / log(PER_BIN))];
  ++l->total;
  l->last_ms = ms;
  l->most_ms = fmax(l->most_ms, ms);
}

double vista_latency_percentile_ms(const vista_latency *l, double percent) {
  if (l->total == 0) return 0.0;
  const int64_t rank = (int64_t)fmax(1.0, ceil(0.01 * percent * (double)l->total));
  int64_t passed = 0;
  int bin = 0;
  while (bin + 1 < VISTA_LATENCY_BINS && (passed += l->counts[bin]) < rank) ++bin;
  return fmin(LEAST_MS * pow(PER_BIN, bin + 0.5), l->most_ms);
}
