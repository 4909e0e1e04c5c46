/* The disparity along a thin line of the image, from the words on it and beside it; internal to libvista. */
#ifndef VISTA_LINE_DEPTH_H
#define VISTA_LINE_DEPTH_H

#include <stdbool.h>
#include <stdint.h>

#include "perceive/line/straight_lines.h"
#include "perceive/line/thin.h"
#include "vista/parameters.h"
#include "vista/types.h"

/* A row of the line whose word is nearer than those beside it. */
typedef struct vista_line_sample {
  float v_px, disparity_px;
} vista_line_sample;

/* Whether there is a thin thing along the line; fills *found then. It reaches as far as words agree on it, and on from
 * there as far as the image shows it. samples: scratch, the image's height. */
bool vista_line_depth(const vista_thin_params *params, const vista_camera *camera, const vista_thin_view *view,
                      const vista_ridge *ridge, const vista_thin_line *line, vista_line_sample *samples,
                      vista_thin_line *found);

#endif
