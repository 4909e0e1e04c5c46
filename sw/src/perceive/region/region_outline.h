/* Regions that only their outline tells: a plain wall before a plain sky, internal to libvista.
 *
 * The interior of a smooth region cannot be matched, its edges can (paper, section II-D: the boundary decides). What
 * stands on the ground and hides what is behind it has an outline on one upright surface (upright_plane.h), which may
 * be seen at an angle: its left edge, its right edge, its upper edge, and the line where it meets the ground. An edge
 * outside of what is matched tells nothing, for or against, nor does a horizontal upper edge, which has no words.
 *
 * Of background seen between things, at most some of these agree: sky reaches the top of the image, and its lower edge,
 * on whatever is before it, is no foot on the ground. A plain patch of the ground has a foot, but beside it is more
 * ground, and nothing that stands on that foot. */
#ifndef VISTA_SRC_REGION_OUTLINE_H
#define VISTA_SRC_REGION_OUTLINE_H

#include <stdbool.h>
#include <stdint.h>

#include "common/plane_fit.h"
#include "perceive/region/region.h"
#include "perceive/region/region_boundary.h"

/* Whether region->label, which grew from no disparity of its own, owns its outline. It does when there is an upright
 * surface such that
 * - more than outline_fraction of what is visible of the region's foot lies on it, within foot_m of the ground's plane;
 * - at least that share of its upper edge lies on it, or of its left and of its right edge; one of these two may be
 *   outside of what is matched, if two thirds of the foot lie on it;
 * - it reaches min_height_m above the ground's plane, and hardly beneath it.
 * Then the region becomes plain and *surface is that surface, over pixels from (0, 0). The disparity and the boundary
 * statistics of the region are those of the outline on it, in pixels along it. Arcs to cells of the same label are
 * inside. */
bool vista_region_owns_outline(vista_region_view *view, const int32_t *label, vista_region *region,
                               vista_plane *surface);

#endif
