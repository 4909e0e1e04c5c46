/* Thin things, found at the resolution of the image: wires, guy wires, thin poles. This step is not in the paper.
 *
 * A wire is a few pixels wide or less; in a cell of the log-polar grid most words are of what is behind it. Two sources
 * tell of it together:
 *   the image   straight thin lines, both of whose sides are brighter, or darker (straight_lines.h);
 *   the words   where the block holds little else, words on the line that are nearer than those beside it, to both
 *               sides, farther away than the block reaches. They lie on one straight line in (u, v, disparity), found
 *               by proposals (RANSAC): texture that is matched by chance does not.
 * A line whose sides are as near as itself is on a surface, and no thing of its own. One that lies on the plane of the
 * ground is a marking or a shadow.
 *
 * The limit of two cameras side by side: along a row of the image a horizontal line looks the same everywhere, so its
 * disparity cannot be seen. For a line at an angle a from the horizontal, rows that are misaligned by e px shift its
 * disparity by e / tan(a). Lines from 16 degrees on are looked for from row to row, flatter ones from column to column
 * near where the path leads; of those below 6 degrees the words say nothing. Of these, and of all others of which words
 * do not tell, the camera's own way does if it moves them in the image (line_motion.h). */
#ifndef VISTA_THIN_H
#define VISTA_THIN_H

#include <stdint.h>

#include "common/arena.h"
#include "perceive/cells/surface.h"
#include "perceive/frame_view.h"
#include "perceive/line/thin_line.h"
#include "vista/status.h"

typedef struct vista_thin vista_thin;

/* *thin is NULL while the arena counts. */
vista_status vista_thin_layout(vista_thin **thin, vista_arena *arena, int32_t width_px, int32_t height_px);

/* Looks for them in the image and in the words of full resolution: the filters of words drop what is as thin as a
 * wire. surfaces: of the frame, with its ground. */
void vista_thin_search(const vista_frame_view *frame, const vista_surfaces *surfaces, vista_thin *thin);

typedef struct vista_thin_lines {
  const vista_thin_line *items;
  int32_t count;
} vista_thin_lines;

/* Those of the last frame, in the order of the strongest piece of each; at most VISTA_THIN_MAX. */
vista_thin_lines vista_thin_found(const vista_thin *thin);

#endif
