#include "common/flight_path.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#include "common/numbers.h"

#define CHORDS_MAX 64
#define SAGITTA_M 0.01 /* between a chord and its arc: c l^2 / 8 */

double vista_flight_path_along(const vista_flight_path *path, const double point_m[3], double direction[3]) {
  const double c = path->curvature_1_m;
  const double offset[3] = {point_m[0] - path->start_m[0], point_m[1] - path->start_m[1],
                            point_m[2] - path->start_m[2]};
  const double ahead_m = vista_dot(offset, path->direction);
  const double turn = c > 0.0 ? atan2(c * ahead_m, 1.0 - c * vista_dot(offset, path->normal)) : 0.0;
  for (int i = 0; i < 3 && direction != NULL; ++i)
    direction[i] = cos(turn) * path->direction[i] + (c > 0.0 ? sin(turn) * path->normal[i] : 0.0);
  return c > 0.0 ? turn / c : ahead_m;
}

void vista_flight_path_point(const vista_flight_path *path, double along_m, double point_m[3], double direction[3]) {
  const double c = path->curvature_1_m, half = 0.5 * c * along_m;
  const double chord_m = c > 0.0 ? 2.0 * sin(half) / c : along_m;
  for (int i = 0; i < 3; ++i) {
    const double normal = c > 0.0 ? path->normal[i] : 0.0;
    point_m[i] = path->start_m[i] + chord_m * (cos(half) * path->direction[i] + sin(half) * normal);
    if (direction != NULL) direction[i] = cos(2.0 * half) * path->direction[i] + sin(2.0 * half) * normal;
  }
}

void vista_flight_path_nearest(const vista_flight_path *path, const double point_m[3], double nearest_m[3]) {
  const double along_m = vista_flight_path_along(path, point_m, NULL);
  vista_flight_path_point(path, fmin(fmax(along_m, 0.0), path->length_m), nearest_m, NULL);
}

double vista_flight_path_distance(const vista_flight_path *path, const double point_m[3]) {
  double nearest_m[3];
  vista_flight_path_nearest(path, point_m, nearest_m);
  for (int i = 0; i < 3; ++i) nearest_m[i] -= point_m[i];
  return vista_norm(nearest_m);
}

double vista_flight_path_sigma_m(const vista_flight_path *path, double along_m, const double axis[3]) {
  const double c = path->curvature_1_m, ahead = vista_dot(path->direction, axis);
  const double inwards = c > 0.0 ? vista_dot(path->normal, axis) : 0.0;
  const double swayed_m = along_m * path->sigma_rad * sqrt(fmax(1.0 - ahead * ahead, 0.0));
  return hypot(swayed_m, 0.5 * VISTA_CURVATURE_SIGMA * c * along_m * along_m * inwards);
}

double vista_flight_path_likely_radius_m(const vista_flight_path *path, double along_m, double radius_m,
                                         double sigmas) {
  const double bent_m = VISTA_CURVATURE_SIGMA * 0.5 * path->curvature_1_m * along_m * along_m;
  return fmax(radius_m - sigmas * hypot(along_m * path->sigma_rad, bent_m), VISTA_LIKELY_RADIUS_MIN * radius_m);
}

bool vista_flight_path_near_disc(const vista_flight_path *path, const vista_disc *disc, double radius_m) {
  const double pieces = ceil(path->length_m * sqrt(path->curvature_1_m / (8.0 * SAGITTA_M)));
  const int count = pieces < 1.0 ? 1 : pieces < CHORDS_MAX ? (int)pieces : CHORDS_MAX;
  vista_line_segment chord;
  memcpy(chord.start_m, path->start_m, sizeof chord.start_m);
  for (int k = 1; k <= count; ++k) {
    double end_m[3], step_m[3];
    vista_flight_path_point(path, path->length_m * k / count, end_m, NULL);
    for (int i = 0; i < 3; ++i) step_m[i] = end_m[i] - chord.start_m[i];
    chord.length_m = vista_norm(step_m);
    for (int i = 0; i < 3; ++i) chord.direction[i] = step_m[i] / chord.length_m;
    if (vista_disc_near_segment(disc, &chord, radius_m)) return true;
    memcpy(chord.start_m, end_m, sizeof end_m);
  }
  return false;
}
