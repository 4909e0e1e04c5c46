/* Which directions are free, how far, and what ends them: what a list of obstacles does not say.
 *
 * Directions are level: columns of one degree of azimuth, from where the camera looks, to the right. They need to know
 * which way is up. What is asked of a column is what flies along it: obstacle_map.collision_radius_m above and below
 * the height of the camera. */
#ifndef VISTA_DIRECTIONS_H
#define VISTA_DIRECTIONS_H

#include <stdbool.h>

#include "vista/api.h"

VISTA_BEGIN

#define VISTA_DIRECTIONS 180          /* columns */
#define VISTA_DIRECTIONS_FIRST_DEG (-90) /* where the first begins; each is a degree wide */

/* The free directions of one frame. */
typedef struct vista_directions {
  double up_camera[3]; /* against gravity, unit length */
  bool up_known; /* otherwise up is -y of the camera */
  float free_m[VISTA_DIRECTIONS]; /* how far the last frames have seen that nothing stands there, in steps of 5 %, up to
                                     obstacle_map.collision_length_m or where disparities say nothing. 0: outside of the
                                     image, blocked or unknown from the first step on */
  float blocked_m[VISTA_DIRECTIONS]; /* level distance of what ends it: matched there, or a confirmed obstacle. 0: it is
                                        not blocked; what is beyond free_m is unknown */
} vista_directions;

VISTA_END

#endif
