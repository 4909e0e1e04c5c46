/* One track in one frame: birth, hit, miss, confirmation, end; internal to libvista. */
#ifndef VISTA_TRACK_LIFE_H
#define VISTA_TRACK_LIFE_H

#include <stdbool.h>
#include <stdint.h>

#include "follow/track_filter.h"
#include "follow/tracker.h"
#include "perceive/region/reconstruction.h"
#include "vista/parameters.h"
#include "vista/types.h"

typedef struct vista_track_frame {
  const vista_tracker_params *params;
  const vista_camera *camera;
  const vista_matched_area *matched;
  const vista_pose *pose;
  const vista_disparity_image *disparity; /* NULL: not known */
  int64_t t_ns;
  const vista_detection *detections;
  int32_t count;
} vista_track_frame;

/* A newborn at the detection, without id. */
void vista_track_start(const vista_track_frame *frame, const vista_detection *detection, vista_track *track);

/* What the track looks like now; false when it has been passed (or is lost to infinity). */
bool vista_track_look(const vista_track_frame *frame, vista_track *track, vista_track_view *view);

/* Makes the track, seen once, one that moves, and its view anew. */
void vista_track_set_moving(const vista_track_frame *frame, vista_track *track, vista_track_view *view);

/* The detection is the track's; `reshaped`: by its place within the track only. */
void vista_track_take(const vista_track_frame *frame, const vista_detection *detection, const vista_track_view *view,
                      bool reshaped, vista_track *track);
void vista_track_miss(const vista_track_frame *frame, const vista_track_view *view, vista_track *track);

/* Whether it is confirmed and credible by now. */
void vista_track_judge(const vista_track_frame *frame, vista_track *track);

bool vista_track_outlived(const vista_track_frame *frame, const vista_track *track);

#endif
