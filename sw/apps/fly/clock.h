/* The clock of everything that vista-fly times: CLOCK_MONOTONIC. */
#ifndef VISTA_FLY_CLOCK_H
#define VISTA_FLY_CLOCK_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

#define FLY_MS 1000000LL
#define FLY_SECOND (1000 * FLY_MS)

int64_t fly_now_ns(void);

/* Sleeps until a moment, or until *stopped, which is looked at every 50 ms. Returns false when it was stopped. */
bool fly_sleep_until(int64_t moment_ns, const atomic_bool *stopped);

#endif
