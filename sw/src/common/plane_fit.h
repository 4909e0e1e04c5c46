/* Weighted least squares of a plane d = offset + slope_u u + slope_v v, internal to libvista. */
#ifndef VISTA_SRC_PLANE_FIT_H
#define VISTA_SRC_PLANE_FIT_H

#include <stdbool.h>

#include "vista/types.h"

typedef struct vista_plane_fit {
  double weight, u, v, d, uu, uv, vv, ud, vd; /* weighted sums */
} vista_plane_fit;

typedef struct vista_plane {
  double offset, slope_u, slope_v;
} vista_plane;

static inline void vista_plane_fit_add(vista_plane_fit *fit, double u, double v, double d, double weight) {
  fit->weight += weight;
  fit->u += weight * u;
  fit->v += weight * v;
  fit->d += weight * d;
  fit->uu += weight * u * u;
  fit->uv += weight * u * v;
  fit->vv += weight * v * v;
  fit->ud += weight * u * d;
  fit->vd += weight * v * d;
}

/* Standard deviation of the plane's value over the points of the fit: how much of a slope they can tell. */
double vista_plane_fit_spread(const vista_plane_fit *fit, const vista_plane *plane);

/* False when the points do not span a plane. */
bool vista_plane_fit_solve(const vista_plane_fit *fit, vista_plane *plane);

/* The disparity at a pixel of a plane that is given in pixels from the principal point. */
double vista_plane_disparity_px(const vista_plane *plane, const vista_camera *camera, double u_px, double v_px);

/* A plane n . P = 1 in space has n = (slope_u, slope_v, offset / f) / B. So what is seen at a pixel with disparity d,
 * where the plane has d_g, is (1 - d_g / d) / |n| above it, and the camera is 1 / |n| above it: the height in metres,
 * its share 1 - d_g / d of the height of the camera, and the share |n| of a metre. */
double vista_plane_share_above(const vista_plane *plane, const vista_camera *camera, double u_px, double v_px,
                               double disparity_px);
double vista_plane_share_per_m(const vista_plane *plane, const vista_camera *camera);
double vista_plane_height_m(const vista_plane *plane, const vista_camera *camera, double u_px, double v_px,
                            double disparity_px);

#endif
