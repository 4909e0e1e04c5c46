/* Finds where the flight path meets the ground, and how far away that is.
 *
 * Ground is a surface to fly along and never a region that is an obstacle, whatever its inclination. But ground that
 * the collision volume meets is a danger: a hillside ahead, rising terrain, a meadow on which the aircraft descends, be
 * it to land. The surface there is found in the words (terrain_search.h) as a plane and kept in the world; each
 * frame asks where the volume around the path flown next meets it. So the place follows a path that changes, and what
 * is warned of is the point that is hit.
 *
 * Low flight is no collision: the volume reaches down by clearance_share of the distance from that surface at most,
 * and a path that descends on a surface by less than angle_min_deg flies along it. Without own motion there is no path.
 *
 * A place that wanders is no place: whoever sinks in a gust, low over level ground, is not about to touch it. So it is
 * warned of only while it stays where it is, and where the path all but grazes the ground, once it has for a while.
 *
 * Confirmed like a track (tracker.h): M of N frames, and the static-world test, which is asked of the point where the
 * line of sight of the first hit meets the surface: it stays where it is in the world, wherever the path leads. */
#ifndef VISTA_TERRAIN_H
#define VISTA_TERRAIN_H

#include <stdbool.h>
#include <stdint.h>

#include "common/arena.h"
#include "follow/static_world.h"
#include "perceive/cells/cells.h"
#include "perceive/cells/foveation.h"
#include "perceive/frame_view.h"
#include "perceive/terrain/terrain_search.h"
#include "vista/obstacle.h"
#include "vista/status.h"

typedef struct vista_terrain {
  int32_t *candidates; /* scratch, node_count */
  float *along_m;      /* scratch, node_count */
  bool known;          /* there is a surface, confirmed or not: */
  bool confirmed, credible; /* as of a track */
  bool steady;              /* the contact stays where it is */
  bool coasting;            /* not seen in this frame */
  bool blind;               /* nor can it be: nearer than is matched, or out of view */
  bool ahead;               /* the path of this frame meets it: contact, sigma_m */
  int32_t age_frames, misses;
  uint32_t window;      /* the last 32 frames, bit 0 the newest, 1 = hit */
  int64_t seen_t_ns;    /* last hit */
  vista_terrain_plane plane; /* world */
  vista_static_world world;
  vista_terrain_contact contact; /* world */
  double sigma_m; /* standard deviation of the contact along the path */
  int32_t places;       /* contacts that these are means of: */
  double place_m[3];    /* the contact, world */
  double wander_m2;     /* of its distance from there along the path, squared */
  int64_t first_t_ns, place_t_ns; /* of the first and the last one */
} vista_terrain;

vista_status vista_terrain_layout(vista_terrain *terrain, vista_arena *arena, const vista_foveation *foveation);

/* Forgets the surface. */
void vista_terrain_reset(vista_terrain *terrain);

/* Looks for the surface in a frame, and asks where its path meets it. */
void vista_terrain_update(const vista_frame_view *frame, const vista_cells *cells, vista_terrain *terrain);

/* Makes an obstacle of the ground that is ahead. Its place is uncertain along the path, and across it by a share of the
 * radius. False: the place is behind the camera. */
bool vista_terrain_obstacle(const vista_frame_view *frame, const vista_terrain *terrain, vista_obstacle *obstacle);

/* Whether something that shows at this point is a part of the ground that the path meets: a hillside may be a region,
 * too, and its middle is not where it is met. */
bool vista_terrain_bears(const vista_terrain *terrain, const vista_obstacle *obstacle, const double point_m[3]);

#endif
