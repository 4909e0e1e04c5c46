/* A thin thing, as a straight line in the image and in disparity. */
#ifndef VISTA_THIN_LINE_H
#define VISTA_THIN_LINE_H

#include <math.h>
#include <stdbool.h>
#include <stdint.h>

#include "perceive/scales.h"
#include "vista/types.h"

/* A straight line in the image. Its coordinate along itself is the row t = v of an upright line, and the column t = u of
 * a flat one; the other one is that of (u_px, v_px) + slope (t - its own), and the disparity is
 * disparity_px + disparity_slope (t - its own), for first_px <= t <= last_px. */
typedef struct vista_thin_line {
  bool flat;
  double u_px, v_px, slope;
  int32_t first_px, last_px;
  double disparity_px, disparity_slope;
  double disparity_sigma_px, disparity_slope_sigma; /* independent of each other */
  double lasting_sigma_px; /* of the disparity: an error that is the same in each frame */
  bool foot_seen;    /* the ground is known: */
  double foot_share; /* height of its lower end above the ground over that of the camera */
  int32_t rows;       /* pixels along it with a word on it */
  int32_t rows_apart; /* of these, whose word is nearer than those beside it */
  int32_t rows_on;    /* of these, whose word agrees with the line */
  int32_t rows_level; /* pixels along it with a word beside it that is as near or nearer */
} vista_thin_line;

#define VISTA_THIN_MAX 96 /* in a frame */

/* Coordinate along the line of its point (u_px, v_px). */
static inline double vista_thin_middle_px(const vista_thin_line *line) { return line->flat ? line->u_px : line->v_px; }

/* The other coordinate of the line at t: column of an upright line, row of a flat one. */
static inline double vista_thin_across_px(const vista_thin_line *line, double t) {
  return (line->flat ? line->v_px : line->u_px) + line->slope * (t - vista_thin_middle_px(line));
}

static inline double vista_thin_u_px(const vista_thin_line *line, double t) {
  return line->flat ? t : vista_thin_across_px(line, t);
}

static inline double vista_thin_v_px(const vista_thin_line *line, double t) {
  return line->flat ? vista_thin_across_px(line, t) : t;
}

static inline double vista_thin_disparity_px(const vista_thin_line *line, double t) {
  return line->disparity_px + line->disparity_slope * (t - vista_thin_middle_px(line));
}

/* Standard deviations of the disparity: from frame to frame, and in all. */
static inline double vista_thin_noise_px(const vista_thin_line *line, double t) {
  return hypot(line->disparity_sigma_px, line->disparity_slope_sigma * (t - vista_thin_middle_px(line)));
}

static inline double vista_thin_sigma_px(const vista_thin_line *line, double t) {
  return hypot(vista_thin_noise_px(line, t), line->lasting_sigma_px);
}

#define VISTA_THIN_SIGMA_MAX 0.1 /* share of the disparity: where a line is less certain, it says nothing */

static inline bool vista_thin_is_certain(const vista_thin_line *line, double t) {
  const double d = vista_thin_disparity_px(line, t);
  return d >= VISTA_FARTHEST_PX && vista_thin_sigma_px(line, t) <= VISTA_THIN_SIGMA_MAX * d;
}

/* The point of the line at t, in the camera. */
static inline void vista_thin_point(const vista_thin_line *line, const vista_camera *camera, double t,
                                    double point_m[3]) {
  const double per_px = camera->baseline_m / vista_thin_disparity_px(line, t);
  point_m[0] = (vista_thin_u_px(line, t) - camera->center_u_px) * per_px;
  point_m[1] = (vista_thin_v_px(line, t) - camera->center_v_px) * per_px;
  point_m[2] = camera->focal_px * per_px;
}

#endif
