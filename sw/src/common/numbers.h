/* Small sums that several stages need, internal to libvista. */
#ifndef VISTA_SRC_NUMBERS_H
#define VISTA_SRC_NUMBERS_H

#include <math.h>
#include <stdbool.h>
#include <stdint.h>

#include "vista/types.h"

#define VISTA_SQRT_3 1.7320508075688772 /* half the length of an interval over its standard deviation */

/* fmaxf and fminf are calls, and these are asked often. */
static inline float vista_larger(float a, float b) { return a > b ? a : b; }
static inline float vista_smaller(float a, float b) { return a < b ? a : b; }

/* What is left of a number, 0 .. count - 1. */
static inline int32_t vista_modulo(int32_t number, int32_t count) {
  return number % count < 0 ? number % count + count : number % count;
}

static inline double vista_square(double value) { return value * value; }

static inline double vista_dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static inline double vista_norm(const double a[3]) { return sqrt(vista_dot(a, a)); }

static inline double vista_distance2(const double a[3], const double b[3]) { /* squared */
  const double apart[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
  return vista_dot(apart, apart);
}

static inline void vista_middle(const double a[3], const double b[3], double middle[3]) {
  for (int i = 0; i < 3; ++i) middle[i] = 0.5 * (a[i] + b[i]);
}

static inline double vista_distance(const double a[3], const double b[3]) { return sqrt(vista_distance2(a, b)); }

static inline void vista_cross(const double a[3], const double b[3], double product[3]) {
  for (int i = 0; i < 3; ++i) product[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
}

/* The lower median of a few numbers, which it sorts. */
static inline double vista_lower_median(double *values, int32_t count) {
  for (int32_t k = 1; k < count; ++k) {
    /* NOLINTNEXTLINE(clang-analyzer-core.uninitialized.Assign): who counts values has set them */
    const double value = values[k];
    int32_t at = k;
    for (; at > 0 && values[at - 1] > value; --at) values[at] = values[at - 1];
    values[at] = value;
  }
  return values[(count - 1) / 2];
}

/* Finite, too; neither holds for a NaN. */
static inline bool vista_positive(double value) { return isfinite(value) && value > 0.0; }
static inline bool vista_not_negative(double value) { return isfinite(value) && value >= 0.0; }

/* later - earlier, without the signed overflow that a far-fetched pair would give. */
static inline double vista_seconds_between(int64_t earlier_ns, int64_t later_ns) {
  return 1e-9 * (double)((uint64_t)later_ns - (uint64_t)earlier_ns);
}

#endif
