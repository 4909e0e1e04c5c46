/* Surfaces that stand upright, such as walls: in a plan of the scene each is a straight line. Internal to libvista.
 *
 * The plan is seen from above. What a pixel shows is there at an azimuth t, the tangent of the angle to the right of
 * straight ahead, and at a distance z ahead, both horizontal. On an upright surface 1 / z is a straight line over t,
 * whatever the height: k = B / z = slope t + offset, with the baseline B. A pixel of disparity d has k = d / s, where s
 * is the part of its line of sight (u - c_u, v - c_v, f) that points straight ahead, in pixels. So an upright edge is
 * one point of the plan, and the foot of a wall on the ground is as good as its upper edge. */
#ifndef VISTA_SRC_UPRIGHT_PLANE_H
#define VISTA_SRC_UPRIGHT_PLANE_H

#include <stdbool.h>
#include <stdint.h>

#include "common/plane_fit.h"
#include "vista/types.h"

#define VISTA_PLAN_POINTS 64 /* at most of one fit */

typedef struct vista_plan {
  const vista_camera *camera;
  double right[3], ahead[3]; /* in the camera: horizontal, unit length */
} vista_plan;

typedef struct vista_plan_point {
  double t, k;
  double ahead_px; /* s: a disparity is k s */
  double weight;
} vista_plan_point;

typedef struct vista_plan_line {
  double slope, offset;
  int32_t count;   /* of the points on it */
  double weight;   /* their sum */
  double sigma_px; /* scatter of their disparities about it */
} vista_plan_line;

/* False: the camera looks up or down too steeply for a plan. */
bool vista_plan_of(const vista_camera *camera, const double up_camera[3], vista_plan *plan);

/* False: the line of sight leads backwards, or steeply up or down. */
bool vista_plan_place(const vista_plan *plan, double u_px, double v_px, double disparity_px, vista_plan_point *point);

/* The line that has most of the weight of the points within tolerance_px of disparity. False: all of the points have
 * about one azimuth. */
bool vista_plan_fit(const vista_plan_point *points, int32_t count, double tolerance_px, vista_plan_line *line);

/* The line as a surface of disparities over pixels from (0, 0). */
vista_plane vista_plan_surface(const vista_plan *plan, const vista_plan_line *line);

#endif
