/* How far each level direction is free, and where what ends it stands (vista/directions.h), read from the map of space.
 *
 * Places stand along each direction as far apart as those on the flight path, each an upright line as high as they are,
 * its middle at the height of the camera. What the newest frames show of it, and a confirmed obstacle that stands there,
 * are weighed by the odds of the path (path_places.h). A direction is free up to the last place before which all are.
 * If the next one is rather occupied, the direction is blocked where that was matched, or where the obstacle is; else
 * nobody knows what is there.
 *
 * The newest frame has to see through a place, too, if that is in its view: what is blind now calls nothing free. Where
 * the camera's motion is not known it is asked alone. */
#ifndef VISTA_FREE_DIRECTIONS_H
#define VISTA_FREE_DIRECTIONS_H

#include <stdint.h>

#include "perceive/frame_view.h"
#include "space/face.h"
#include "space/space_map.h"
#include "vista/directions.h"
#include "vista/obstacle.h"

/* Fills *directions in for the vertical of the frame, which the map has taken already. faces: of the obstacles. */
void vista_free_directions(const vista_frame_view *frame, const vista_space_map *map, const vista_obstacle *obstacles,
                           const vista_face *faces, int32_t count, vista_directions *directions);

#endif
