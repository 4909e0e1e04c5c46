/* Thin things, found at the resolution of the image: wires, guy wires, thin poles. This step is not in the paper.
 *
 * A wire is a few pixels wide or less; in a cell of the log-polar grid most words are of what is behind it. Two sources
 * tell of it together:
 *   the image   straight thin lines, both of whose sides are brighter, or darker (parts/straight_lines.h);
 *   the words   where the block holds little else, words on the line that are nearer than those beside it, to both
 *               sides, farther away than the block reaches. They lie on one straight line in (u, v, disparity), found
 *               by proposals (RANSAC): texture that is matched by chance does not.
 * A line whose sides are as near as itself is on a surface, and no thing of its own. One that lies on the plane of the
 * ground is a marking or a shadow.
 *
 * The limit of two cameras side by side: along a row of the image a horizontal line looks the same everywhere, so its
 * disparity cannot be seen. For a line at an angle a from the horizontal, rows that are misaligned by e px shift its
 * disparity by e / tan(a). Lines below 16 degrees are not looked for. */
#ifndef VISTA_THIN_H
#define VISTA_THIN_H

#include <math.h>
#include <stdbool.h>
#include <stdint.h>

#include "common/arena.h"
#include "common/image_noise.h"
#include "common/plane_fit.h"
#include "vista/parameters.h"
#include "vista/status.h"
#include "vista/types.h"

/* A frame, and the ground's plane in it (plane_fit.h). */
typedef struct vista_thin_view {
  const vista_image *image;
  const vista_disparity_image *words; /* of the engine's level 0: filters drop what is as thin as a wire */
  vista_image_noise noise;
  int32_t block_radius_px; /* of the engine's block */
  bool ground_found;
  vista_plane ground;
} vista_thin_view;

/* One of them, as a straight line: with t = v - v_px, u = u_px + slope t and
 * disparity = disparity_px + disparity_slope t, for first_v_px <= v <= last_v_px. */
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

#define VISTA_THIN_MAX 96

typedef struct vista_thin vista_thin;

/* *thin is NULL while the arena counts. */
vista_status vista_thin_layout(vista_thin **thin, vista_arena *arena, int32_t width_px, int32_t height_px);

/* VISTA_ERROR_ARGUMENT: no pixels or words; VISTA_ERROR_SIZE: of another size than laid out; VISTA_ERROR_RANGE: a
 * parameter or the camera is out of range. */
vista_status vista_thin_search(const vista_thin_params *params, const vista_camera *camera, const vista_thin_view *view,
                               vista_thin *thin);

/* Of the last frame, in the order of the strongest piece of each; at most VISTA_THIN_MAX. */
const vista_thin_line *vista_thin_lines(const vista_thin *thin, int32_t *count);

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
