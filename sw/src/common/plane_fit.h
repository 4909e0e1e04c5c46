/* Weighted least squares of a plane d = offset + slope_u u + slope_v v, internal to libvista. */
#ifndef VISTA_SRC_PLANE_FIT_H
#define VISTA_SRC_PLANE_FIT_H

#include <stdbool.h>

typedef struct vista_plane_fit {
  double weight, u, v, d, uu, uv, vv, ud, vd; /* weighted sums */
} vista_plane_fit;

typedef struct vista_plane {
  double offset, slope_u, slope_v;
} vista_plane;

void vista_plane_fit_add(vista_plane_fit *fit, double u, double v, double d, double weight);

/* Standard deviation of the plane's value over the points of the fit: how much of a slope they can tell. */
double vista_plane_fit_spread(const vista_plane_fit *fit, const vista_plane *plane);

/* False when the points do not span a plane. */
bool vista_plane_fit_solve(const vista_plane_fit *fit, vista_plane *plane);

#endif
