/* A thin thing, as a straight line in the image and in disparity. */
#ifndef VISTA_THIN_LINE_H
#define VISTA_THIN_LINE_H

#include <math.h>
#include <stdbool.h>
#include <stdint.h>

/* A straight line in the image: u = u_px + slope t and disparity = disparity_px + disparity_slope t with t = v - v_px,
 * for first_v_px <= v <= last_v_px. */
typedef struct vista_thin_line {
  double u_px, v_px, slope;
  int32_t first_v_px, last_v_px;
  double disparity_px, disparity_slope;
  double disparity_sigma_px, disparity_slope_sigma; /* independent of each other */
  bool foot_seen;    /* the ground is known: */
  double foot_share; /* height of its lower end above the ground over that of the camera */
  int32_t rows;       /* with a word on the line */
  int32_t rows_apart; /* of these, whose word is nearer than those beside it */
  int32_t rows_on;    /* of these, whose word agrees with the line */
  int32_t rows_level; /* rows of the line with a word beside it that is as near or nearer */
} vista_thin_line;

#define VISTA_THIN_MAX 96 /* in a frame */

/* Column and disparity of the line at a row, and the disparity's standard deviation. */
static inline double vista_thin_u_px(const vista_thin_line *line, double v_px) {
  return line->u_px + line->slope * (v_px - line->v_px);
}

static inline double vista_thin_disparity_px(const vista_thin_line *line, double v_px) {
  return line->disparity_px + line->disparity_slope * (v_px - line->v_px);
}

static inline double vista_thin_sigma_px(const vista_thin_line *line, double v_px) {
  return hypot(line->disparity_sigma_px, line->disparity_slope_sigma * (v_px - line->v_px));
}

#endif
