/* The face of an obstacle: an upright board that stands for it where it is seen.
 *
 * As wide and high as the ellipse of its pixels (vista_obstacle.ellipse), at its depth, and turned to the camera. The
 * middle of a track is that of the whole thing, of which the border of the image may hide the larger part, so the board
 * lies about the middle of what is seen. */
#ifndef VISTA_FACE_H
#define VISTA_FACE_H

#include "perceive/frame_view.h"
#include "vista/obstacle.h"

typedef struct vista_face {
  double middle_m[3]; /* world */
  double sight[3], aside[3], up[3]; /* unit length, world: from the camera to the middle, to its right, and up */
  double half_m[2]; /* aside, up */
  double range_m;   /* from the camera to the middle */
} vista_face;

vista_face vista_face_of(const vista_frame_view *frame, const vista_obstacle *obstacle);

#endif
