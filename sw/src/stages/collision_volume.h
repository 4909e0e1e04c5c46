/* How much of each region lies in the collision volume: the points within radius_m of a segment of length_m from the
 * camera along the flight direction a (companion).
 *
 * A pixel (x, y) from the principal point with disparity d is the point q B / d, q = (x, y, f). It lies in the volume
 * when |q x a| B / d <= radius and 0 < q . a B / d <= length. Every pixel of a region's cells that lies on its surface
 * is asked, at its own disparity, whichever side of its border the image puts it on: a street's wall, seen at an angle,
 * passes the aircraft wherever its middle is; a pole that leaves the volume at both ends is in the way in between. */
#ifndef VISTA_COLLISION_VOLUME_H
#define VISTA_COLLISION_VOLUME_H

#include "stages/foveation.h"
#include "stages/region.h"
#include "vista/parameters.h"
#include "vista/status.h"
#include "vista/types.h"

typedef struct vista_collision_volume {
  double direction_camera[3]; /* of flight, unit length, camera */
  double radius_m, length_m;
} vista_collision_volume;

/* Fills volume_pixels of the accepted regions. VISTA_ERROR_SIZE: a disparity image of another size. */
vista_status vista_collision_volume_count(const vista_foveation *foveation, const vista_region_params *params,
                                          const vista_camera *camera, const vista_collision_volume *volume,
                                          const vista_disparity_image *disparity, vista_regions *regions);

#endif
