/* The ground that the path meets as an obstacle of the map, internal to libvista. */
#ifndef VISTA_SRC_TERRAIN_OBSTACLE_H
#define VISTA_SRC_TERRAIN_OBSTACLE_H

#include <stdbool.h>

#include "perceive/frame_view.h"
#include "perceive/terrain/terrain.h"
#include "vista/obstacle.h"

/* Makes an obstacle of the ground that is ahead. Its place is uncertain along the path, and across it by a share of the
 * radius. False: the place is behind the camera. */
bool vista_terrain_obstacle(const vista_frame_view *frame, const vista_terrain *terrain, vista_obstacle *obstacle);

/* Whether something that shows at this point is a part of the ground that the path meets: a hillside may be a region,
 * too, and its middle is not where it is met. */
bool vista_terrain_bears(const vista_terrain *terrain, const vista_obstacle *obstacle, const double point_m[3]);

#endif
