/* Which detection belongs to which track: the global assignments, described in tracker.h. */
#ifndef VISTA_TRACK_ASSOCIATION_H
#define VISTA_TRACK_ASSOCIATION_H

#include <stdbool.h>
#include <stdint.h>

#include "common/arena.h"
#include "follow/track_filter.h"
#include "follow/track_life.h"
#include "follow/tracker.h"
#include "vista/parameters.h"
#include "vista/status.h"

typedef struct vista_track_association vista_track_association;

vista_status vista_track_association_layout(int32_t max_tracks, int32_t max_detections, vista_arena *arena,
                                            vista_track_association **association);

typedef struct vista_track_table {
  const vista_track *tracks;
  const vista_track_view *views; /* of each in the frame */
  int32_t count;
} vista_track_table;

/* detection_of_track: an entry a track, -1 = none. */
void vista_track_associate(vista_track_association *association, const vista_track_frame *frame,
                           const vista_track_table *table, int32_t *detection_of_track);

/* What the last call did: whether a track took its detection as one of changed shape; the detection, taken by no track,
 * to which a track that was seen once may have moved, or -1; whether a detection was taken. */
bool vista_track_association_reshaped(const vista_track_association *association, int32_t track);
int32_t vista_track_association_moved_to(const vista_track_association *association, int32_t track);
bool vista_track_association_claimed(const vista_track_association *association, int32_t detection);

/* Whether the inner one is centred within the outer one's extent and at its depth. */
bool vista_track_within(const vista_track_view *inner, const vista_track_view *outer);

#endif
