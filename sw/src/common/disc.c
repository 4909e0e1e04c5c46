#include "common/disc.h"

#include <math.h>

#include "common/numbers.h"

/* Distance of (x, y), both >= 0, outside the ellipse with semi-axes a, b from its boundary. The foot of the
 * perpendicular is (a^2 x / (t + a^2), b^2 y / (t + b^2)) for the t >= 0 that puts it on the ellipse:
 *   g(t) = (a x / (t + a^2))^2 + (b y / (t + b^2))^2 = 1, g falling and convex.
 * Newton's method from t with g(t) >= 1 therefore climbs to the root from below without overshooting. */
static double outside_distance(double a, double b, double x, double y) {
  double t = fmax(0.0, fmax(a * (x - a), b * (y - b)));
  for (int i = 0; i < 60; ++i) {
    const double p = a * x / (t + a * a);
    const double q = b * y / (t + b * b);
    const double excess = p * p + q * q - 1.0;
    const double slope = 2.0 * (p * p / (t + a * a) + q * q / (t + b * b));
    const double step = excess / slope;
    if (!(step > 1e-14 * (t + a * b))) break;
    t += step;
  }
  return hypot(x - a * a * x / (t + a * a), y - b * b * y / (t + b * b));
}

double vista_disc_point_distance(const vista_disc *disc, const double point_m[3]) {
  const double offset[3] = {point_m[0] - disc->center_m[0], point_m[1] - disc->center_m[1],
                            point_m[2] - disc->center_m[2]};
  const double x = fabs(vista_dot(offset, disc->axis_x));
  const double y = fabs(vista_dot(offset, disc->axis_y));
  const double normal[3] = {disc->axis_x[1] * disc->axis_y[2] - disc->axis_x[2] * disc->axis_y[1],
                            disc->axis_x[2] * disc->axis_y[0] - disc->axis_x[0] * disc->axis_y[2],
                            disc->axis_x[0] * disc->axis_y[1] - disc->axis_x[1] * disc->axis_y[0]};
  const double height = fabs(vista_dot(offset, normal));
  const double p = x / disc->half_x_m;
  const double q = y / disc->half_y_m;
  if (p * p + q * q <= 1.0) return height;
  return hypot(height, outside_distance(disc->half_x_m, disc->half_y_m, x, y));
}

static double distance_at(const vista_disc *disc, const vista_line_segment *segment, double s) {
  const double point_m[3] = {segment->start_m[0] + s * segment->direction[0],
                             segment->start_m[1] + s * segment->direction[1],
                             segment->start_m[2] + s * segment->direction[2]};
  return vista_disc_point_distance(disc, point_m);
}

/* The place on the segment that is closest to a point. */
static double closest(const vista_line_segment *segment, const double point_m[3]) {
  const double offset[3] = {point_m[0] - segment->start_m[0], point_m[1] - segment->start_m[1],
                            point_m[2] - segment->start_m[2]};
  return fmin(segment->length_m, fmax(0.0, vista_dot(offset, segment->direction)));
}

/* The distance from a convex set is convex along a line: golden-section search. The disc's nearest point lies within
 * its larger half axis of the centre, which bounds the search; the distance is 1-Lipschitz in s, so the error is at
 * most the last interval. */
double vista_disc_segment_distance(const vista_disc *disc, const vista_line_segment *segment) {
  const double golden = 0.61803398874989484820;
  const double reach = fmax(disc->half_x_m, disc->half_y_m);
  const double middle = closest(segment, disc->center_m);
  double low = fmax(0.0, middle - reach);
  double high = fmin(segment->length_m, middle + reach);
  double s1 = high - golden * (high - low);
  double s2 = low + golden * (high - low);
  double d1 = distance_at(disc, segment, s1);
  double d2 = distance_at(disc, segment, s2);
  for (int i = 0; i < 45; ++i) {
    if (d1 <= d2) {
      high = s2;
      s2 = s1;
      d2 = d1;
      s1 = high - golden * (high - low);
      d1 = distance_at(disc, segment, s1);
    } else {
      low = s1;
      s1 = s2;
      d1 = d2;
      s2 = low + golden * (high - low);
      d2 = distance_at(disc, segment, s2);
    }
  }
  return fmin(d1, d2);
}

bool vista_disc_near_segment(const vista_disc *disc, const vista_line_segment *segment, double radius_m) {
  const double s = closest(segment, disc->center_m);
  double squared = 0.0;
  for (int i = 0; i < 3; ++i) {
    const double difference = segment->start_m[i] + s * segment->direction[i] - disc->center_m[i];
    squared += difference * difference;
  }
  const double distance = sqrt(squared);
  if (distance <= radius_m) return true;
  if (distance > radius_m + fmax(disc->half_x_m, disc->half_y_m)) return false;
  return vista_disc_segment_distance(disc, segment) <= radius_m;
}
