/* The surface of the ground around the place where the collision volume meets it, internal to libvista.
 *
 * The cells of one frame, nearest along the path first: where enough of them lie inside the volume, a plane is fitted
 * to those around, by least squares of their disparities (plane_fit.h), and the volume is met with that plane. What
 * noise puts into the volume makes no plane; what stands in it makes one that is too steep, and the search goes on
 * behind. */
#ifndef VISTA_SRC_TERRAIN_SEARCH_H
#define VISTA_SRC_TERRAIN_SEARCH_H

#include <stdbool.h>
#include <stdint.h>

#include "common/flight_path.h"
#include "perceive/cells/cells.h"
#include "perceive/cells/foveation.h"
#include "vista/parameters.h"
#include "vista/types.h"

#define VISTA_TERRAIN_BESIDE 2.0 /* radii from the path: the ground that a plane is found in */

/* Around a path; near a plane its radius is a share of the distance of the path's start from that plane at most. */
typedef struct vista_terrain_volume {
  vista_flight_path path;
  double radius_m, clearance_share;
} vista_terrain_volume;

/* A plane of the world or the camera: normal . P = offset_m, the normal of unit length pointing away
 * from the camera. */
typedef struct vista_terrain_plane {
  double normal[3], offset_m;
} vista_terrain_plane;

/* The place where a volume first meets a plane. */
typedef struct vista_terrain_contact {
  double along_m;    /* along the path */
  double radius_m;   /* of the ball that the volume is swept by */
  double point_m[3]; /* of the plane, that the ball touches */
  double sine;       /* of the angle at which the path descends on the plane there */
} vista_terrain_contact;

/* What the words say of a plane where the volume meets it; areas in px^2. */
typedef struct vista_terrain_sight {
  double expected_px2; /* where it would be seen */
  double valid_px2;    /* of that, with a disparity */
  double agree_px2;    /* of that, on the plane */
} vista_terrain_sight;

typedef struct vista_terrain_view {
  const vista_foveation *foveation;
  const vista_terrain_params *params;
  const vista_camera *camera;
  const double *up; /* camera */
  const vista_cells *cells;
  int32_t *candidates; /* scratch, node_count */
  float *along_m;      /* scratch, node_count */
} vista_terrain_view;

/* False: the path keeps off the plane over its length, or descends on it at less than the smallest angle. */
bool vista_terrain_meet(const vista_terrain_volume *volume, const vista_terrain_plane *plane, double sine_min,
                        vista_terrain_contact *contact);

vista_terrain_sight vista_terrain_look(const vista_terrain_view *view, const vista_terrain_volume *volume,
                                       const vista_terrain_plane *plane, const vista_terrain_contact *contact);

/* The first ground that the volume meets in this frame, in the camera's frame. */
bool vista_terrain_find(const vista_terrain_view *view, const vista_terrain_volume *volume, vista_terrain_plane *plane,
                        vista_terrain_contact *contact);

/* Whether hardly any disparity is where it would be seen. */
bool vista_terrain_dark(const vista_terrain_sight *sight);

/* Whether what was looked at is there. */
bool vista_terrain_seen(const vista_terrain_sight *sight);

#endif
