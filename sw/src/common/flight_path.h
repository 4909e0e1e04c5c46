/* The path that the aircraft will fly: a circular arc, or a straight line. */
#ifndef VISTA_FLIGHT_PATH_H
#define VISTA_FLIGHT_PATH_H

#include <stdbool.h>

#include "common/disc.h"

#define VISTA_CURVATURE_SIGMA 0.25    /* of the curvature, as a share of it */
#define VISTA_LIKELY_RADIUS_MIN 0.5 /* of the radius: how much is left of it at least */

typedef struct vista_flight_path {
  double start_m[3];
  double direction[3]; /* at the start, unit length */
  double normal[3];    /* towards the centre of the arc, unit length, orthogonal to direction; unused if straight */
  double curvature_1_m; /* not negative; 0: straight */
  double length_m;      /* along the path, at most a quarter of a circle */
  double sigma_rad;     /* of the direction, each axis */
} vista_flight_path;

/* The length along the path to where it comes closest to the point, negative behind its start; and unless null, the
 * direction there. Not beyond a quarter of a circle past the end. */
double vista_flight_path_along(const vista_flight_path *path, const double point_m[3], double direction[3]);

/* The nearest point of the path, its ends included; and how far it is. */
void vista_flight_path_nearest(const vista_flight_path *path, const double point_m[3], double nearest_m[3]);
double vista_flight_path_distance(const vista_flight_path *path, const double point_m[3]);

/* The point of the path at along_m from its start, and unless null, the direction there. */
void vista_flight_path_point(const vista_flight_path *path, double along_m, double point_m[3], double direction[3]);

/* How far the aircraft may be off the path along a unit vector when it has flown along_m of it: one standard deviation.
 * Gusts and its own sway turn it to any side, and nobody keeps to an arc: of its curvature a quarter is uncertain. */
double vista_flight_path_sigma_m(const vista_flight_path *path, double along_m, const double axis[3]);

/* The radius within which what is along_m ahead is likely to be met by a ball of radius_m: less by so many standard
 * deviations of how far the aircraft may be off its path there, but no less than half. */
double vista_flight_path_likely_radius_m(const vista_flight_path *path, double along_m, double radius_m, double sigmas);

/* Whether the disc comes within radius_m of the path, up to 1 cm: an arc is taken for a chain of chords. */
bool vista_flight_path_near_disc(const vista_flight_path *path, const vista_disc *disc, double radius_m);

#endif
