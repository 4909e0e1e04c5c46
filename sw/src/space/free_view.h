/* How far each level direction is free, and where what ends it stands (vista/directions.h).
 *
 * At each of STATIONS distances along a direction stands an upright line of twice the collision radius, its middle at
 * the height of the camera. Lines of sight to SAMPLES of its points tell as they do of the flight path (path_view.h),
 * with one difference: one that ends before the station on an accepted region blocks, whether that region has become
 * an obstacle yet or not. The direction is free up to the last station before which no line has less than
 * seen_min_fraction of its points told, or as many blocked. It is blocked at the median of the level distances at which
 * those lines of sight ended.
 *
 * Points outside of the matched part of the image do not count; a line that has none there is not seen. */
#ifndef VISTA_FREE_VIEW_H
#define VISTA_FREE_VIEW_H

#include "common/matched_area.h"
#include "perceive/region/region.h"
#include "vista/directions.h"
#include "vista/parameters.h"
#include "vista/status.h"
#include "vista/types.h"

/* region_of_pixel: height * width, negative: none; regions with their verdicts. Fills free_m and blocked_m for
 * directions->up_camera.
 * VISTA_ERROR_SIZE: a disparity image of another size than the camera's. */
vista_status vista_free_view(const vista_obstacle_map_params *params, const vista_camera *camera,
                             const vista_matched_area *matched, const vista_disparity_image *disparity,
                             const int32_t *region_of_pixel, const vista_regions *regions,
                             vista_directions *directions);

#endif
