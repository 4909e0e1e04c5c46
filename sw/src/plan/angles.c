#include "plan/angles.h"

#include <math.h>
#include <stddef.h>
#include <stdint.h>

#define QUARTERS_PER_RADIAN 0.63661977236758134
#define QUARTER_HIGH 1.57079632673412561417     /* pi / 2 in 33 bits: its multiples are exact, */
#define QUARTER_LOW 6.07710050650619224932e-11  /* and the rest of it */
#define QUARTER_TURN 1.5707963267948966
#define HALF_TURN 3.1415926535897931
/* Tangents of pi/16, pi/8 and 3/16 pi. */
#define FIRST 0.19891236737965800
#define MIDDLE 0.41421356237309503
#define LAST 0.66817863791929892

/* Taylor's series, the last term first, of an even number of terms. As far as pi/4, and the arc's as far as the tangent
 * of pi/16, what they leave out is below 1e-17. */
static const double sines[] = {1.0 / 355687428096000.0, -1.0 / 1307674368000.0, 1.0 / 6227020800.0, -1.0 / 39916800.0,
                               1.0 / 362880.0,          -1.0 / 5040.0,          1.0 / 120.0,        -1.0 / 6.0};
static const double cosines[] = {1.0 / 20922789888000.0, -1.0 / 87178291200.0, 1.0 / 479001600.0, -1.0 / 3628800.0,
                                 1.0 / 40320.0,          -1.0 / 720.0,         1.0 / 24.0,        -0.5};
static const double arcs[] = {1.0 / 21.0,  -1.0 / 19.0, 1.0 / 17.0, -1.0 / 15.0, 1.0 / 13.0,
                              -1.0 / 11.0, 1.0 / 9.0,   -1.0 / 7.0, 1.0 / 5.0,   -1.0 / 3.0};
#define COUNT(terms) (sizeof(terms) / sizeof(terms)[0])

/* Even and odd terms by themselves: half as many products wait for each other. */
static inline double sum(const double *terms, size_t count, double square) {
  const double fourth = square * square;
  double odd = terms[0], even = terms[1];
  for (size_t k = 2; k < count; k += 2) {
    odd = odd * fourth + terms[k];
    even = even * fourth + terms[k + 1];
  }
  return square * (even + square * odd);
}

void vista_plan_sine_cosine(double angle_rad, double *sine, double *cosine) {
  const double quarters = floor(angle_rad * QUARTERS_PER_RADIAN + 0.5);
  const double rest = (angle_rad - quarters * QUARTER_HIGH) - quarters * QUARTER_LOW;
  const double square = rest * rest;
  const double s = rest + rest * sum(sines, COUNT(sines), square), c = 1.0 + sum(cosines, COUNT(cosines), square);
  const int quarter = (int)((int64_t)quarters & 3);
  *sine = quarter == 0 ? s : quarter == 1 ? c : quarter == 2 ? -s : -c;
  *cosine = quarter == 0 ? c : quarter == 1 ? -s : quarter == 2 ? -c : s;
}

double vista_plan_tangent(double angle_rad) {
  double sine, cosine;
  vista_plan_sine_cosine(angle_rad, &sine, &cosine);
  return sine / cosine;
}

/* Of a tangent up to 1: from the nearest of 0, pi/8 and pi/4, by the series that is left. */
static double arc(double tangent) {
  const double from = tangent < FIRST ? 0.0 : tangent < LAST ? 0.25 * QUARTER_TURN : 0.5 * QUARTER_TURN;
  const double middle = tangent < FIRST ? 0.0 : tangent < LAST ? MIDDLE : 1.0;
  const double z = (tangent - middle) / (1.0 + tangent * middle);
  return from + (z + z * sum(arcs, COUNT(arcs), z * z));
}

double vista_plan_angle(double y, double x) {
  const double up = fabs(y), ahead = fabs(x);
  if (!(up + ahead > 0.0)) return 0.0;
  double angle_rad = up > ahead ? QUARTER_TURN - arc(ahead / up) : arc(up / ahead);
  if (x < 0.0) angle_rad = HALF_TURN - angle_rad;
  return y < 0.0 ? -angle_rad : angle_rad;
}
