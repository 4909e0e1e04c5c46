/* How much of each region lies in the collision volume: the points within radius_m of the path that is flown next, an
 * arc or a straight line from the camera on (motion.h; companion: straight).
 *
 * A pixel (x, y) from the principal point with disparity d is the point q B / d, q = (x, y, f). Straight, along a, it
 * lies in the volume when |q x a| B / d <= radius and 0 < q . a B / d <= length. Of an arc with curvature c in the
 * plane of a and n, the point (X, Y, Z) along a, n and across is in when hypot((1 - c rho) / c, Z) <= radius with
 * c rho = hypot(c X, 1 - c Y), and X > 0, atan2(c X, 1 - c Y) <= c length.
 *
 * Block matching widens what stands before something by up to half a block: a pixel tells of what is outline_px away.
 * So the volume's radius is smaller by outline_px Z / f. Where the aircraft will be is uncertain, too, the more so the
 * farther ahead: what is beside the rim of the volume there is passed as often as not. So the radius is smaller by
 * path_sigmas standard deviations of that, down to half of it.
 *
 * Every pixel of a region's cells that lies on its surface is asked, at its own disparity, whichever side of its border
 * the image puts it on: a street's wall, seen at an angle, passes the aircraft wherever its middle is; a pole that
 * leaves the volume at both ends is in the way in between. */
#ifndef VISTA_COLLISION_VOLUME_H
#define VISTA_COLLISION_VOLUME_H

#include "common/flight_path.h"
#include "perceive/cells/cells.h"
#include "perceive/frame_view.h"
#include "perceive/region/region.h"

typedef struct vista_collision_volume {
  double direction_camera[3]; /* of flight at the camera, unit length */
  double radius_m, length_m;
  double normal_camera[3]; /* towards the centre of the arc, unit length, orthogonal to the direction */
  double outline_px;       /* that things seem wider than they are, to each side: the volume is narrower by as much */
  double curvature_1_m;    /* 0: straight; at most a quarter of a circle over length_m */
  double sigma_rad;        /* of the direction, each axis */
  double path_sigmas;      /* of the path, by which the volume is narrower */
} vista_collision_volume;

/* The volume around the path of a frame, in the coordinates of its camera. */
vista_collision_volume vista_collision_volume_around(const vista_frame_view *frame);

/* The path in the middle of the volume, in the coordinates of the camera. */
vista_flight_path vista_collision_volume_path(const vista_collision_volume *volume);

/* Fills volume_pixels of the accepted regions, and of those that have any, where the volume meets them: the middle of
 * the tenth of their area in the volume that a ball of its radius, with its centre on the path, touches first. Of a
 * tree that is the side of its crown towards the aircraft, of a wall seen at an angle the part that is flown into, and
 * neither is the middle. Cells nearer than the surface are its relief, up to half the size of the thing. What noise
 * brings nearer is taken off, as independent errors are: of the squares, so that a crown is met at its leaves and a
 * noisy wall in its surface. met_sigma_m is of the range: by the matcher, by what was taken off, by the relief, and by
 * the slope of the surface times how far the aircraft may leave the path. */
void vista_collision_volume_count(const vista_frame_view *frame, const vista_collision_volume *volume,
                                  const vista_cells *cells, vista_regions *regions);

#endif
