/* How much of what is below the horizon where the aircraft flies to has a disparity: whatever is seen there, it is the
 * ground or something before it. A plain wall, dark glass or sheet metal that cannot be matched hides that ground and
 * leaves nothing in its place, although the rest of the image may be full of disparities. */
#ifndef VISTA_SRC_GROUND_VIEW_H
#define VISTA_SRC_GROUND_VIEW_H

#include <stdbool.h>

#include "common/flight_path.h"
#include "common/matched_area.h"
#include "vista/types.h"

typedef struct vista_ahead {
  const vista_camera *camera;
  const vista_pose *pose;
  const vista_flight_path *path;
  const double *up_camera; /* NULL: nobody knows where the horizon is */
  double radius_m;         /* of the collision volume */
} vista_ahead;

/* From 0 to 1; 1, too, where hardly anything below the horizon is in view. agreeing: only disparities that another one
 * agrees with count. */
double vista_ground_view(const vista_ahead *ahead, const vista_matched_area *matched, bool agreeing,
                         const vista_disparity_image *disparity);

#endif
