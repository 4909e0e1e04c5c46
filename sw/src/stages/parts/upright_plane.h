/* Surfaces that stand upright, such as walls: in a plan of the scene each is a straight line. Internal to libvista.
 *
 * Along a horizontal line of the plan at azimuth t = tan(angle), from straight ahead to the right, the inverse of the
 * distance ahead is k = slope t + offset on such a line, whatever the height; in units of k = d / s of a pixel with
 * disparity d, where s is the share of its line of sight that points straight ahead, in pixels. So an upright edge is one
 * point of the plan, and the foot of a wall on the ground is as good as its upper edge. */
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
  double t, k, ahead_px; /* ahead_px = s: from k to disparities */
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

/* False: the line of sight leads backwards or straight up. */
bool vista_plan_place(const vista_plan *plan, double u_px, double v_px, double disparity_px, vista_plan_point *point);

/* The line that has most of the points within tolerance_px, weighted; false: no two are apart. */
bool vista_plan_fit(const vista_plan_point *points, int32_t count, double tolerance_px, vista_plan_line *line);

/* As a surface of disparities over pixels from (0, 0). */
vista_plane vista_plan_surface(const vista_plan *plan, const vista_plan_line *line);

#endif
