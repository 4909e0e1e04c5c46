/* Thin lines to detections, which join those of the regions before the tracker.
 *
 * A line is long, and what counts of it is where it comes closest to the flight path: that point stands for it. Its
 * covariance is that of any detection (reconstruction.h), with the noise along the line, where nothing but the path
 * marks the point, larger than across it. Its extent is that of the part of the line within the collision volume's
 * radius of the point. Lines that stay farther from the path than twice that radius are left out: nothing depends on
 * them.
 *
 * Matching widens a wire before the sky to a band of blocks, which is a region of its own whose middle is that of what
 * happens to be in view. A detection that is such a band, narrow, along the line and at its disparity, gives way to a
 * line in the collision volume; beside the volume the line gives way, because a post's region is steadier than its
 * lines. */
#ifndef VISTA_THIN_RECONSTRUCTION_H
#define VISTA_THIN_RECONSTRUCTION_H

#include <stdint.h>

#include "perceive/line/thin.h"
#include "perceive/region/reconstruction.h"
#include "space/collision_volume.h"
#include "vista/parameters.h"
#include "vista/status.h"
#include "vista/types.h"

/* Appends to, and takes bands out of, the *detection_count detections. first_label: of the first of them, further ones
 * count on. VISTA_ERROR_CAPACITY: more than `capacity` in all; the first of them are written then. */
vista_status vista_thin_reconstruct(const vista_thin_line *lines, int32_t line_count, const vista_camera *camera,
                                    const vista_collision_volume *volume, const vista_reconstruction_params *params,
                                    int32_t first_label, vista_detection *detections, int32_t capacity,
                                    int32_t *detection_count);

#endif
