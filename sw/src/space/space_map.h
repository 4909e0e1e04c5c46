/* The map of space: the evidence of the last frames, each at the pose that it was seen from.
 *
 * Nothing is put into a grid. Whoever asks about a place looks at it through each of the frames that are kept: the
 * lines of sight to a disc around it end before it, at it, or beyond it. So a place can be anywhere, the resolution is
 * that of the image, an error of the poses is only what has come up since the frame that is looked through, and memory
 * and time are bounded (as in Florence et al., NanoMap, ICRA 2018).
 *
 * Frames that follow closer than VISTA_SPACE_SPACING_S replace one another, so that those that are kept see from different places.
 */
#ifndef VISTA_SPACE_MAP_H
#define VISTA_SPACE_MAP_H

#include <stdint.h>

#include "common/arena.h"
#include "perceive/cells/surface.h"
#include "perceive/frame_view.h"
#include "space/evidence.h"
#include "space/kept_lines.h"
#include "vista/status.h"

#define VISTA_SPACE_FRAMES 6 /* that are kept */

typedef struct vista_space_map {
  vista_camera camera;
  int32_t count, newest;
  vista_evidence frames[VISTA_SPACE_FRAMES];
  vista_kept_lines lines;
} vista_space_map;

/* What the frames that are kept show of a place. */
typedef struct vista_place_evidence {
  int32_t frames; /* in which the place is in view */
  int32_t votes;  /* of these, in which something is matched at it */
  int32_t feet;   /* of these, in which something without texture stands on ground that is matched there */
  int32_t lines;  /* frames in which a thin thing was found that passes through it, and is kept (kept_lines.h) */
  double beyond;  /* share of the lines of sight that are known to go on beyond it, mean of the frames */
  double beyond_newest; /* that of the newest of these frames, */
  double overhung; /* in the newest two of them: the share that ends at an overhang, which may be anywhere, */
  double radius_m;      /* and how far around the place that one looked: no farther than fits into its view */
  /* What is matched there in the newest frame that votes, or else in the newest that shows a foot, or the thin thing. */
  double u_px, v_px, disparity_px; /* mean; disparity_px 0: there is no such frame */
  double spread_px; /* standard deviation of the disparity */
  int32_t age; /* of that frame: 0 is the newest */
} vista_place_evidence;

vista_status vista_space_map_layout(vista_space_map *map, vista_arena *arena, const vista_camera *camera);

/* Forgets all frames. */
void vista_space_map_reset(vista_space_map *map);

/* Takes what a frame shows, and the thin things that were found in it. */
void vista_space_map_add(vista_space_map *map, const vista_frame_view *frame, const vista_surfaces *surfaces,
                         const vista_thin_lines *lines);

/* What is known of the disc of this radius around a point of the world, as deep as the map can tell. */
vista_place_evidence vista_space_map_look(const vista_space_map *map, const double point_m[3], double radius_m);

/* What is known of the ball of this radius, all of its depth, for whoever flies to it from a point: lines that the
 * middle of the way is no nearer to do not count. A frame that it does not fit into the view of tells of as much as does. */
vista_place_evidence vista_space_map_look_around(const vista_space_map *map, const double point_m[3], double radius_m,
                                                 const double from_m[3]);

/* An upright line in the world: what is flown along needs so much height. */
typedef struct vista_upright {
  double middle_m[3];
  double up[3]; /* unit length */
  double half_m;
} vista_upright;

/* What so many of the newest frames show of an upright line. A word is at it if it is at its middle. */
vista_place_evidence vista_space_map_look_upright(const vista_space_map *map, const vista_upright *line,
                                                  int32_t frames);

/* The point of the world that is matched at a place, whose disparity_px is positive. */
void vista_space_map_matched(const vista_space_map *map, const vista_place_evidence *shown, double point_m[3]);

/* The frame that is so many frames older than the newest, 0 .. count - 1. */
const vista_evidence *vista_space_map_frame(const vista_space_map *map, int32_t age);

#endif
