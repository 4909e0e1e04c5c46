/* How far each level direction is free, and where what ends it stands (vista/directions.h).
 *
 * At each of STATIONS distances along a direction stands an upright line of twice the collision radius, its middle at
 * the height of the camera. A line of sight to one of its SAMPLES points tells if its word belongs to a region that was
 * judged (told.h), wherever it ends; what has no word, or lies in a region that could not be judged, tells nothing.
 * One that ends before the station on an accepted region blocks, whether that region has become an obstacle yet or not.
 * The direction is free up to the last station before which no line has less than a fifth of its points told, or
 * as many blocked. It is blocked at the median of the level distances at which those lines of sight ended.
 *
 * Points outside of the matched part of the image do not count; a line that has none there is not seen. */
#ifndef VISTA_FREE_VIEW_H
#define VISTA_FREE_VIEW_H

#include "perceive/frame_view.h"
#include "space/told.h"
#include "vista/directions.h"

/* Fills *directions in for the vertical of the frame. */
void vista_free_view(const vista_frame_view *frame, const vista_told *told, vista_directions *directions);

#endif
