/* What the engine's words say where an unseen track should be; internal to libvista. */
#ifndef VISTA_TRACK_EVIDENCE_H
#define VISTA_TRACK_EVIDENCE_H

#include <stdbool.h>

#include "stages/parts/track_filter.h"
#include "vista/types.h"

/* Whether most words of the track's face lie behind it. Words of its own depth or nearer, or none at all, are no proof
 * that it has gone: what is near fills the image and falls into several regions, or is too plain to be matched.
 * disparity == NULL: true. */
bool vista_track_seen_through(const vista_camera *camera, const vista_matched_area *matched,
                              const vista_disparity_image *disparity, const vista_track_view *view);

#endif
