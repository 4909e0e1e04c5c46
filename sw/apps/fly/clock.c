#include "clock.h"

#include <time.h>

int64_t fly_now_ns(void) {
  struct timespec now;
  (void)clock_gettime(CLOCK_MONOTONIC, &now);
  return (int64_t)now.tv_sec * FLY_SECOND + now.tv_nsec;
}

bool fly_sleep_until(int64_t moment_ns, const atomic_bool *stopped) {
  for (;;) {
    if (atomic_load(stopped)) return false;
    const int64_t left_ns = moment_ns - fly_now_ns();
    if (left_ns <= 0) return true;
    const int64_t step_ns = left_ns < 50 * FLY_MS ? left_ns : 50 * FLY_MS;
    (void)clock_nanosleep(CLOCK_MONOTONIC, 0, &(struct timespec){.tv_nsec = (long)step_ns}, NULL);
  }
}
