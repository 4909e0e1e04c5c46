/* How far the flight path is seen: up to where "no obstacle" means free space.
 *
 * At each of STATIONS distances along the path stands a disc of radius_m across it, the collision volume's
 * cross-section. A pixel of the disc's image tells of it when its word belongs to a region that was judged: either the
 * line of sight passes through the disc and ends beyond, or it ends before, on something that is an obstacle, ground,
 * or too small to be one. All lines of sight to the disc run inside the volume, if that is straight. A plain surface of
 * which the outline was matched counts with the range of that outline. What has no word, and what lies in a region that
 * could not be judged, tells nothing: sky, a bare wall, a mist of chance matches look all alike.
 *
 * The path is seen up to the last distance before which no disc has less than seen_min_fraction of its pixels told.
 * Pixels outside of the matched part of the image do not count; a disc that has none there is not seen. */
#ifndef VISTA_PATH_VIEW_H
#define VISTA_PATH_VIEW_H

#include "perceive/frame_view.h"
#include "space/told.h"

/* From 0 to the length of the frame's path. */
double vista_path_view(const vista_frame_view *frame, const vista_told *told);

#endif
