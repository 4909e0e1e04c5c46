/* What an obstacle stands on leaves its region, pixel by pixel.
 *
 * A cell at the foot of a thing is half ground. With the ground's plane known, two kinds of pixels of an obstacle's
 * region are ground: those whose word is less than ground_height_m above the plane, unless it is well behind the
 * region's surface, as ground seen past a thin thing is; and those without a word that are seen below the foot: there
 * the region's surface would be beneath the plane.
 *
 * It comes last: what the region's words said of its place and verdict has been weighed by then. */
#ifndef VISTA_FOOTING_H
#define VISTA_FOOTING_H

#include "perceive/cells/surface.h"
#include "perceive/cut/refinement.h"
#include "perceive/frame_view.h"
#include "perceive/region/region.h"

/* Takes such pixels of accepted regions out of refinement->label. */
void vista_footing_clear(const vista_frame_view *frame, const vista_surfaces *surfaces, const vista_regions *regions,
                         vista_refinement *refinement);

#endif
