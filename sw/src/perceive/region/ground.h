/* Height of a region above the horizontal surface that it adjoins, internal to libvista. */
#ifndef VISTA_SRC_GROUND_H
#define VISTA_SRC_GROUND_H

#include "perceive/region/region_boundary.h"

/* Fits a plane to the horizontal cells around the region's nodes, or takes the ground of the frame where there are
 * none. Returns the part of the region's area that is at least min_height_m off that plane;
 * 1 where there is no such plane, or it leans less than horizontal_deg: nothing to lie on. */
double vista_standing_fraction(const vista_region_view *view, double min_height_m);

#endif
