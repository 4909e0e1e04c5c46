/* Regions that are nothing but the edge of what stands before them. Internal to libvista. */
#ifndef VISTA_SRC_SLIVER_H
#define VISTA_SRC_SLIVER_H

#include <stdbool.h>

#include "perceive/region/region.h"
#include "perceive/region/region_boundary.h"

/* Whether most of the region's own pixels, as they were found last, lie within half a block of something that is
 * clearly nearer. All that the block shows there may be that thing's edge. Matched at the edge's own disparity it is
 * what widens things; before a plain sky or in fog, next to nothing decides for another one, and the strip that
 * results keeps beside its thing, frame after frame. */
bool vista_region_is_sliver(const vista_region_view *view, const vista_region *region);

#endif
