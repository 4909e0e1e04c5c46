/* What the engine's words say where a track without a detection should be; internal to libvista. */
#ifndef VISTA_TRACK_EVIDENCE_H
#define VISTA_TRACK_EVIDENCE_H

#include "follow/track_filter.h"
#include "vista/types.h"

typedef enum vista_track_sight {
  VISTA_SIGHT_NOTHING,   /* too few words: what is near or plain is not matched, and has not gone */
  VISTA_SIGHT_ITSELF,    /* most words have its disparity: it stands there, although no region tells it */
  VISTA_SIGHT_SOMETHING, /* most words are of something else, behind it or before it */
} vista_track_sight;

typedef struct vista_track_evidence {
  vista_track_sight sight;
  double disparity_px, sigma_disparity_px; /* ITSELF: mean of those words, and its standard deviation */
} vista_track_evidence;

/* Judges the words within the track's projected extent. disparity == NULL: something else. */
vista_track_evidence vista_track_look_for(const vista_camera *camera, const vista_matched_area *matched,
                                          const vista_disparity_image *disparity, const vista_track_view *view);

#endif
