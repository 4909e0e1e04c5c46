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
  float free_m[VISTA_DIRECTIONS]; /* how far the camera has seen that nothing stands there, in steps of a 20th of
                                     obstacle_map.collision_length_m. 0: outside of the image; nothing to match there,
                                     as in the sky; or an obstacle, or what may become one, in the first step */
  float blocked_m[VISTA_DIRECTIONS]; /* level distance of the surface that ends it, of an obstacle or of what may become
                                        one. 0: none is seen there, as where nothing can be matched */
} vista_directions;

VISTA_END

#endif
