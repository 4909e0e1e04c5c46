/* The disparity along a thin line of the image, from the words on it and beside it or, where they do not tell, from the
 * camera's own motion (line_motion.h); internal to libvista. */
#ifndef VISTA_LINE_DEPTH_H
#define VISTA_LINE_DEPTH_H

#include <stdbool.h>

#include "perceive/cells/surface.h"
#include "perceive/frame_view.h"
#include "perceive/line/line_motion.h"
#include "perceive/line/straight_lines.h"
#include "perceive/line/thin_line.h"

/* What the depth of a line is told from. */
typedef struct vista_line_view {
  const vista_frame_view *frame;
  const vista_surfaces *surfaces;
  const vista_ridge *ridge;
  vista_line_motion *motion; /* what the camera saw before */
  vista_line_sample *samples; /* scratch: the longer side of the image */
} vista_line_view;

/* Whether there is a thin thing along the line; fills *found in then. It reaches as far as samples agree on it, and on
 * from there as far as the image shows it. */
bool vista_line_depth(const vista_line_view *view, const vista_thin_line *line, vista_thin_line *found);

#endif
