/* Distance of an elliptical disc in space from a segment: an obstacle against the axis of the collision volume. */
#ifndef VISTA_DISC_H
#define VISTA_DISC_H

#include <stdbool.h>

/* The points center + p * axis_x + q * axis_y with (p / half_x)^2 + (q / half_y)^2 <= 1. */
typedef struct vista_disc {
  double center_m[3];
  double axis_x[3], axis_y[3]; /* orthonormal */
  double half_x_m, half_y_m;   /* > 0 */
} vista_disc;

/* The points start + s * direction with 0 <= s <= length_m. */
typedef struct vista_line_segment {
  double start_m[3];
  double direction[3]; /* unit length */
  double length_m;
} vista_line_segment;

/* Exact up to rounding. */
double vista_disc_point_distance(const vista_disc *disc, const double point_m[3]);

/* Smallest distance between the two, within 1e-6 of the segment's length or better. */
double vista_disc_segment_distance(const vista_disc *disc, const vista_line_segment *segment);

/* Whether that distance is at most radius_m; most discs are decided by their bounding sphere. */
bool vista_disc_near_segment(const vista_disc *disc, const vista_line_segment *segment, double radius_m);

#endif
