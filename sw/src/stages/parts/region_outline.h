/* Regions that only their outline tells: a plain wall before a plain sky, internal to libvista.
 *
 * The interior of a smooth region cannot be matched, its edges can (paper, section II-D: the boundary decides). What
 * stands on the ground and hides what is behind it has an outline of one depth: its left edge, its right edge, and
 * the ground that it meets at that depth. Of background seen between things, at most some of these agree: sky
 * reaches the top of the image, and its lower edge, on whatever is before it, is no foot on the ground. */
#ifndef VISTA_SRC_REGION_OUTLINE_H
#define VISTA_SRC_REGION_OUTLINE_H

#include <stdbool.h>
#include <stdint.h>

#include "stages/parts/region_boundary.h"

/* Whether region->label, which grew from no disparity of its own, owns its outline: at least outline_fraction of its
 * left edge, its right edge and its foot at one depth, the foot within foot_m of the ground's plane, its top
 * min_height_m above it. If so, the region is plain, and its disparity and boundary statistics are those of its left
 * and right edges, in pixels along them. Arcs to cells of the same label are inside. */
bool vista_region_owns_outline(vista_region_view *view, const vista_camera *camera, const int32_t *label,
                               vista_region *region);

#endif
