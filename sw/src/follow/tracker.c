#include "follow/tracker.h"

#include <math.h>
#include <stddef.h>

#include "common/numbers.h"
#include "follow/track_association.h"
#include "follow/track_filter.h"
#include "follow/track_life.h"

struct vista_tracker {
  int32_t max_tracks, max_detections;
  int32_t count;
  int32_t next_id;
  bool started;
  int64_t t_ns; /* of the last update */
  int64_t dropped;
  vista_track *tracks; /* oldest first */
  vista_track_view *views;
  int32_t *detection_of_track; /* -1: none */
  vista_track_association *association;
};

vista_status vista_tracker_layout(int32_t max_tracks, int32_t max_detections, vista_arena *arena,
                                  vista_tracker **tracker) {
  *tracker = NULL;
  if (max_tracks < 1 || max_tracks > VISTA_TRACKER_MAX || max_detections < 1 || max_detections > VISTA_TRACKER_MAX)
    return VISTA_ERROR_RANGE;
  const size_t tracks = (size_t)max_tracks;
  vista_tracker *made = vista_arena_take(arena, 1, sizeof *made);
  vista_tracker parts = {.max_tracks = max_tracks,
                         .max_detections = max_detections,
                         .next_id = 1,
                         .tracks = vista_arena_take(arena, tracks, sizeof(vista_track)),
                         .views = vista_arena_take(arena, tracks, sizeof(vista_track_view)),
                         .detection_of_track = vista_arena_take(arena, tracks, sizeof(int32_t))};
  const vista_status status = vista_track_association_layout(max_tracks, max_detections, arena, &parts.association);
  if (status != VISTA_OK || arena->base == NULL) return status;
  *made = parts;
  *tracker = made;
  return VISTA_OK;
}

void vista_tracker_reset(vista_tracker *tracker) {
  tracker->count = 0;
  tracker->started = false;
  tracker->dropped = 0;
}

const vista_track *vista_tracker_tracks(const vista_tracker *tracker, int32_t *count) {
  *count = tracker->count;
  return tracker->tracks;
}

int64_t vista_tracker_dropped(const vista_tracker *tracker) { return tracker->dropped; }

/* ---- checks, before anything changes ---- */

static vista_status check_detection(const vista_detection *d) {
  if (!isfinite(d->u_px) || !isfinite(d->v_px)) return VISTA_ERROR_NUMBER;
  for (int i = 0; i < 9; ++i)
    if (!isfinite(d->covariance_camera_m2[i])) return VISTA_ERROR_NUMBER;
  for (int i = 0; i < 3; ++i)
    if (!isfinite(d->position_camera_m[i])) return VISTA_ERROR_NUMBER;
  const double sizes[] = {d->disparity_px,       d->sigma_u_px,  d->sigma_v_px,
                          d->sigma_disparity_px, d->extent_m[0], d->extent_m[1]};
  for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; ++i) {
    if (!isfinite(sizes[i])) return VISTA_ERROR_NUMBER;
    if (sizes[i] <= 0.0) return VISTA_ERROR_RANGE;
  }
  return VISTA_OK;
}

static vista_status check(const vista_tracker *tracker, const vista_track_frame *f) {
  if (f->count > tracker->max_detections) return VISTA_ERROR_CAPACITY;
  for (int32_t i = 0; i < f->count; ++i) {
    const vista_status status = check_detection(&f->detections[i]);
    if (status != VISTA_OK) return status;
  }
  return tracker->started && f->t_ns <= tracker->t_ns ? VISTA_ERROR_ORDER : VISTA_OK;
}

/* ---- the table of tracks ---- */

/* drift_m: of the camera in this frame, which all tracks share. */
static void predict(vista_tracker *tracker, const vista_track_frame *f, double drift_m) {
  const double dt_s = tracker->started ? vista_seconds_between(tracker->t_ns, f->t_ns) : 0.0;
  for (int32_t i = 0; i < tracker->count; ++i) {
    vista_track_filter_predict(dt_s, &tracker->tracks[i]);
    for (int axis = 0; axis < 3; ++axis) tracker->tracks[i].covariance[7 * axis] += vista_square(drift_m);
    tracker->tracks[i].age_frames += 1;
  }
}

/* Views of all tracks; those that were passed leave the table. */
static void look_at_all(vista_tracker *tracker, const vista_track_frame *f) {
  int32_t kept = 0;
  for (int32_t i = 0; i < tracker->count; ++i) {
    if (!vista_track_look(f, &tracker->tracks[i], &tracker->views[kept])) continue;
    tracker->tracks[kept] = tracker->tracks[i];
    ++kept;
  }
  tracker->count = kept;
}

/* Used up after 2^31 tracks: then from 1 again, past those that still live. `count`: tracks in the table by now. */
static int32_t new_id(vista_tracker *tracker, int32_t count) {
  for (;;) {
    const int32_t id = tracker->next_id;
    tracker->next_id = id < INT32_MAX ? id + 1 : 1;
    bool lives = false;
    for (int32_t i = 0; i < count && !lives; ++i) lives = tracker->tracks[i].id == id;
    if (!lives) return id;
  }
}

/* A track seen once, and a detection that no track explains: perhaps the same, moved. That is one more track, behind
 * the others in the table; both go on as what stands, too. Returns how many there are. */
static int32_t spawn_moving(vista_tracker *tracker, const vista_track_frame *f) {
  int32_t spawned = 0;
  for (int32_t i = 0; i < tracker->count && tracker->count + spawned < tracker->max_tracks; ++i) {
    const int32_t detection = vista_track_association_moved_to(tracker->association, i);
    if (detection < 0) continue;
    vista_track *const track = &tracker->tracks[tracker->count + spawned++];
    const int32_t id = new_id(tracker, tracker->count + spawned - 1);
    *track = tracker->tracks[i];
    track->id = id;
    vista_track_view view;
    vista_track_set_moving(f, track, &view);
    vista_track_take(f, &f->detections[detection], &view, false, track);
  }
  return spawned;
}

static void update(vista_tracker *tracker, const vista_track_frame *f) {
  const int32_t spawned = spawn_moving(tracker, f);
  int32_t kept = 0;
  for (int32_t i = 0; i < tracker->count; ++i) {
    vista_track *const track = &tracker->tracks[i];
    const int32_t detection = tracker->detection_of_track[i];
    if (detection < 0)
      vista_track_miss(f, &tracker->views[i], track);
    else
      vista_track_take(f, &f->detections[detection], &tracker->views[i],
                       vista_track_association_reshaped(tracker->association, i), track);
    vista_track_judge(f, track);
    if (!vista_track_outlived(f, track)) tracker->tracks[kept++] = *track;
  }
  for (int32_t i = 0; i < spawned; ++i) tracker->tracks[kept++] = tracker->tracks[tracker->count + i];
  tracker->count = kept;
}

/* Tentative tracks within a confirmed one, and the younger of two confirmed ones that are within each other. */
static void remove_duplicates(vista_tracker *tracker) {
  for (int32_t i = 0; i < tracker->count; ++i) {
    if (!tracker->tracks[i].confirmed) continue;
    int32_t kept = 0;
    int32_t self = i; /* where track i is while the table closes up */
    for (int32_t j = 0; j < tracker->count; ++j) {
      const bool confirmed = tracker->tracks[j].confirmed;
      bool same = j != i && vista_track_within(&tracker->views[j], &tracker->views[self]);
      if (same && confirmed) same = j > i && vista_track_within(&tracker->views[self], &tracker->views[j]);
      if (same) continue;
      if (j == i) self = kept;
      tracker->tracks[kept] = tracker->tracks[j];
      tracker->views[kept] = tracker->views[j];
      ++kept;
    }
    tracker->count = kept;
    i = self;
  }
}

static double position_variance(const vista_track *track) {
  return track->covariance[0] + track->covariance[7] + track->covariance[14];
}

static bool less_certain(const vista_track *a, const vista_track *b) {
  return a->hits != b->hits ? a->hits < b->hits : position_variance(a) > position_variance(b);
}

/* Make room for a newborn in a full table; false when nobody there is less certain. */
static bool make_room(vista_tracker *tracker, const vista_track *newborn) {
  const vista_track *victim = newborn;
  for (int32_t i = 0; i < tracker->count; ++i)
    if (!tracker->tracks[i].confirmed && less_certain(&tracker->tracks[i], victim)) victim = &tracker->tracks[i];
  ++tracker->dropped;
  if (victim == newborn) return false;
  --tracker->count;
  for (int32_t i = (int32_t)(victim - tracker->tracks); i < tracker->count; ++i) {
    tracker->tracks[i] = tracker->tracks[i + 1];
    tracker->views[i] = tracker->views[i + 1];
  }
  return true;
}

static void start(vista_tracker *tracker, const vista_track_frame *f, const vista_detection *detection) {
  const double *p = detection->position_camera_m;
  if (sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]) > f->params->range_max_m) return;
  vista_track newborn;
  vista_track_view view;
  vista_track_start(f, detection, &newborn);
  if (!vista_track_look(f, &newborn, &view)) return;
  if (tracker->count == tracker->max_tracks && !make_room(tracker, &newborn)) return;
  newborn.id = new_id(tracker, tracker->count);
  tracker->tracks[tracker->count] = newborn;
  tracker->views[tracker->count] = view;
  ++tracker->count;
}

vista_status vista_tracker_update(vista_tracker *tracker, const vista_frame_view *frame,
                                  const vista_detections *detections) {
  const int32_t count = detections->count;
  const vista_track_frame f = {&frame->params->tracker,
                               frame->camera,
                               &frame->matched,
                               &frame->motion.pose,
                               frame->words.data != NULL ? &frame->words : NULL,
                               frame->t_ns,
                               detections->items,
                               count};
  const vista_status status = check(tracker, &f);
  if (status != VISTA_OK) return status;
  predict(tracker, &f, frame->motion.drift_m);
  look_at_all(tracker, &f);
  const vista_track_table table = {tracker->tracks, tracker->views, tracker->count};
  vista_track_associate(tracker->association, &f, &table, tracker->detection_of_track);
  update(tracker, &f);
  look_at_all(tracker, &f);
  for (int32_t i = 0; i < count; ++i)
    if (!vista_track_association_claimed(tracker->association, i)) start(tracker, &f, &f.detections[i]);
  remove_duplicates(tracker);
  tracker->started = true;
  tracker->t_ns = frame->t_ns;
  return VISTA_OK;
}
