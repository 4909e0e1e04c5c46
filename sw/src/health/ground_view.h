/* How much of what is below the horizon where the aircraft flies to has a disparity: whatever is seen there, it is the
 * ground or something before it. A plain wall, dark glass or sheet metal that cannot be matched hides that ground and
 * leaves nothing in its place, although the rest of the image may be full of disparities. */
#ifndef VISTA_SRC_GROUND_VIEW_H
#define VISTA_SRC_GROUND_VIEW_H

#include <stdbool.h>

#include "perceive/frame_view.h"

/* From 0 to 1; 1, too, where hardly anything below the horizon is in view, or nobody knows where the horizon is.
 * agreeing: only disparities that another one agrees with count. */
double vista_ground_view(const vista_frame_view *frame, bool agreeing);

#endif
