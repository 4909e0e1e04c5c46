/* Thin things that were found, kept where they are in the world: straight pieces, as each frame saw them.
 *
 * A wire across the way is seen while the aircraft leans, so that the wire crosses the rows of the image, and is lost
 * when the aircraft levels: along a row it looks the same everywhere, and no disparity can be told (thin.h). It is still
 * there. So a piece is kept for KEPT_S, or until frames that should have shown it did not: those that have it in view,
 * no nearer than the engine matches, at an angle at which lines are found. A line is found in about half of the frames
 * that have it in view, so one that many have shown is missed for longer before it is let go of.
 *
 * Memory is bounded: a piece that is no longer than so many newer ones of its line makes room, and with all of it taken
 * the oldest. */
#ifndef VISTA_KEPT_LINES_H
#define VISTA_KEPT_LINES_H

#include <stdbool.h>
#include <stdint.h>

#include "perceive/frame_view.h"
#include "perceive/line/thin.h"

#define VISTA_LINES_KEPT 256

/* Frames that follow closer than this see the same again, from the same place: they count as one. */
#define VISTA_SPACE_SPACING_S 0.08

typedef struct vista_kept_line {
  int64_t t_ns;
  double from_m[3], along_m[3]; /* world: one end, and from there to the other one */
  double middle_m[3], half_m;   /* and the ball around it */
  double sigma_m;               /* of the distance from the camera that saw it, at the less certain end */
  double shown_s;               /* of frames that showed its line, */
  double missed_s;              /* and of those that should have, since the last that did */
} vista_kept_line;

typedef struct vista_kept_lines {
  int64_t t_ns; /* of the newest frame */
  int32_t count;
  vista_kept_line items[VISTA_LINES_KEPT]; /* oldest first */
} vista_kept_lines;

/* Lets go of what a frame should show and does not, and takes the lines that it shows. Where the motion is not known,
 * nothing is kept. */
void vista_kept_lines_add(vista_kept_lines *kept, const vista_frame_view *frame, const vista_thin_lines *lines);

/* A ball around a point of the world, as it is seen from a camera. */
typedef struct vista_kept_ball {
  double point_m[3], camera_m[3];
  double radius_m; /* across the line of sight */
  double deep_m;   /* along it */
  const double *from_m; /* it is flown to from here: lines that half the way comes no nearer to do not count; or null */
} vista_kept_ball;

/* The number of frames, VISTA_SPACE_SPACING_S or more apart, that saw a line which passes through the ball, give or take
 * its sigma along the line of sight.
 * at_m: the point of the newest of these lines that is nearest to the middle, in the world. */
int32_t vista_kept_lines_frames(const vista_kept_lines *kept, const vista_kept_ball *ball, double at_m[3]);

#endif
