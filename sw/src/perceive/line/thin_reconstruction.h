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

#include "perceive/frame_view.h"
#include "perceive/line/thin.h"
#include "perceive/region/reconstruction.h"
#include "space/collision_volume.h"
#include "vista/status.h"

/* Appends to the detections, and takes bands out of them. first_label: of the first line, further ones count on.
 * VISTA_ERROR_CAPACITY: there are more than fit; the first of them are there then. */
vista_status vista_thin_reconstruct(const vista_frame_view *frame, const vista_thin_lines *lines,
                                    const vista_collision_volume *volume, int32_t first_label,
                                    vista_detections *detections);

#endif
