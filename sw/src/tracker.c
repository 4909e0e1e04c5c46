#include "vista/tracker.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#include "frame.h"
#include "track_association.h"
#include "track_filter.h"

#define WINDOW_BITS 32
#define DEPTH_PASSED_M 0.05 /* a track nearer than this along z is behind the camera */

struct vista_tracker {
  int32_t max_tracks, max_detections;
  int32_t count;
  int32_t next_id;
  bool started;
  int64_t t_ns; /* of the last update */
  int64_t dropped;
  vista_track *tracks; /* ascending id */
  vista_track_view *views;
  int32_t *detection_of_track; /* -1: none */
  vista_track_association *association;
};

typedef struct frame {
  const vista_tracker_params *params;
  const vista_camera *camera;
  const vista_matched_area *matched;
  const vista_pose *pose;
  int64_t t_ns;
  const vista_detection *detections;
  int32_t count;
} frame;

vista_status vista_tracker_layout(int32_t max_tracks, int32_t max_detections, vista_arena *arena,
                                  vista_tracker **tracker) {
  if (arena == NULL || tracker == NULL) return VISTA_ERROR_ARGUMENT;
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

static bool positive(double value) { return isfinite(value) && value > 0.0; }
static bool not_negative(double value) { return isfinite(value) && value >= 0.0; }

static vista_status check_params(const vista_tracker_params *p) {
  const bool good = positive(p->velocity_sigma_m_s) && not_negative(p->moving_sigma_m_s) && not_negative(p->acceleration_psd_m2_s3) &&
                    not_negative(p->position_psd_m2_s) && not_negative(p->attitude_sigma_deg) &&
                    positive(p->gate_chi2) && positive(p->extent_sigma_ratio) && not_negative(p->extent_psd_1_s) &&
                    positive(p->overlap_sigma) && positive(p->overlap_scale) && p->confirm_window >= 1 &&
                    p->volume_pixels >= 0 && p->confirm_window <= WINDOW_BITS && p->moved_hits >= 0 && p->moved_hits <= 16 && p->confirm_hits >= 1 && p->confirm_hits <= p->confirm_window &&
                    p->static_odds >= 1.0 && isfinite(p->static_odds) && not_negative(p->static_tolerance) &&
                    p->static_noise_hits >= 1.0 && isfinite(p->static_noise_hits) && positive(p->static_fade_m) &&
                    not_negative(p->static_speed_min_m_s) && p->miss_max >= 0 && not_negative(p->out_of_view_s) && not_negative(p->blind_zone_s) &&
                    positive(p->range_max_m);
  return good ? VISTA_OK : VISTA_ERROR_RANGE;
}

static vista_status check_matched(const vista_matched_area *m) {
  const bool good = positive(m->disparity_max_px) && not_negative(m->margin_left_px) && not_negative(m->margin_px);
  return good ? VISTA_OK : VISTA_ERROR_RANGE;
}

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

static vista_status check(const vista_tracker *tracker, const frame *f) {
  if (f->count < 0) return VISTA_ERROR_SIZE;
  if (f->count > tracker->max_detections) return VISTA_ERROR_CAPACITY;
  vista_status status = check_params(f->params);
  if (status == VISTA_OK) status = check_matched(f->matched);
  if (status == VISTA_OK) status = vista_frame_check_camera(f->camera);
  if (status == VISTA_OK) status = vista_frame_check_pose(f->pose);
  for (int32_t i = 0; i < f->count && status == VISTA_OK; ++i) status = check_detection(&f->detections[i]);
  if (status != VISTA_OK) return status;
  if (tracker->started && f->t_ns <= tracker->t_ns) return VISTA_ERROR_ORDER;
  return tracker->next_id > INT32_MAX - 2 * f->count ? VISTA_ERROR_OVERFLOW : VISTA_OK;
}

/* ---- one track in this frame ---- */

/* later - earlier, without the signed overflow that a far-fetched pair would give */
static double seconds_between(int64_t earlier_ns, int64_t later_ns) {
  return 1e-9 * (double)((uint64_t)later_ns - (uint64_t)earlier_ns);
}

static int32_t bit_count(uint32_t bits) {
  int32_t count = 0;
  for (; bits != 0; bits &= bits - 1) ++count;
  return count;
}

/* N and M of this track: what is linked over a larger distance has to show it more often. */
static int32_t window_length(const vista_tracker_params *params, const vista_track *track) {
  const int32_t length = params->confirm_window + (track->moved ? params->moved_hits : 0);
  return length < WINDOW_BITS ? length : WINDOW_BITS;
}

static int32_t hits_needed(const vista_tracker_params *params, const vista_track *track) {
  return window_length(params, track) - (params->confirm_window - params->confirm_hits);
}

static int32_t hits_in_window(const vista_tracker_params *params, const vista_track *track) {
  return bit_count(track->window & (UINT32_MAX >> (WINDOW_BITS - window_length(params, track))));
}

/* What the track looks like now; false when it has been passed (or is lost to infinity). */
static bool look(const frame *f, vista_track *track, vista_track_view *view) {
  double camera_m[3];
  vista_frame_to_camera(f->pose, track->position_m, camera_m);
  if (!isfinite(camera_m[0] + camera_m[1] + camera_m[2]) || camera_m[2] <= DEPTH_PASSED_M) return false;
  vista_track_filter_view(f->params, f->camera, f->pose, seconds_between(track->hit_t_ns, f->t_ns), track, view);
  const double u = view->measurement_px[0];
  const double v = view->measurement_px[1];
  const double d = view->measurement_px[2];
  const double margin = f->matched->margin_px;
  track->in_view = u >= f->matched->margin_left_px && u <= f->camera->width_px - 1 - margin && v >= margin &&
                   v <= f->camera->height_px - 1 - margin;
  /* A sigma of doubt counts as blind: no track is blamed where the engine might not match. What left the image
   * before it came near is not blind, it is out of view. */
  const bool near = d + sqrt(view->covariance_px2[8]) > f->matched->disparity_max_px;
  track->in_blind_zone = near && (track->in_view || track->in_blind_zone);
  return true;
}

/* Where the detection is, with its noise at `depth_m`: that of the track is steadier than its own. */
static vista_world_hit world_hit(const frame *f, const vista_detection *detection, double depth_m,
                                 const double variance_px2[3]) {
  const double *const p = detection->position_camera_m;
  const double slant = sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]) / p[2];
  const double per_px_m = depth_m / f->camera->focal_px;
  vista_world_hit hit = {.along_sigma_m = slant * per_px_m * depth_m / f->camera->baseline_m * sqrt(variance_px2[2]),
                         .across_sigma_m = per_px_m * sqrt(fmax(variance_px2[0], variance_px2[1])),
                         .t_ns = f->t_ns};
  vista_frame_to_world(f->pose, p, hit.position_m);
  memcpy(hit.camera_m, f->pose->translation_m, sizeof hit.camera_m);
  return hit;
}

static void judge(const frame *f, vista_track *track) {
  const vista_static_world *const w = &track->world;
  const bool silent = fabs(w->travel_m) <= f->params->static_speed_min_m_s * seconds_between(w->start_t_ns, f->t_ns);
  const bool supported = w->verdict == VISTA_WORLD_OPEN ? silent : w->verdict != VISTA_WORLD_REFUTED;
  track->confirmed = track->confirmed || hits_in_window(f->params, track) >= hits_needed(f->params, track);
  track->credible = track->confirmed && w->verdict != VISTA_WORLD_REFUTED && (track->credible || supported);
}

static void hit(const frame *f, const vista_detection *detection, vista_track *track) {
  track->coasting = false;
  track->label = detection->label;
  track->volume_window = track->volume_window << 1 | (detection->volume_pixels >= f->params->volume_pixels);
  track->window = track->window << 1 | 1u;
  track->hits += 1;
  track->seen_frames += 1;
  track->misses = 0;
  track->hit_t_ns = f->t_ns;
  track->visible_t_ns = f->t_ns;
  track->ellipse = detection->ellipse;
  track->ellipse_depth_m = f->camera->focal_px * f->camera->baseline_m / detection->disparity_px;
}

static void miss(const frame *f, vista_track *track) {
  track->coasting = true;
  track->label = -1;
  if (!track->in_view || track->in_blind_zone) return;
  track->window <<= 1;
  track->seen_frames += 1;
  track->misses += 1;
  track->visible_t_ns = f->t_ns;
}

static bool outlived(const frame *f, const vista_track *track) {
  const vista_tracker_params *params = f->params;
  const double hidden_s = seconds_between(track->visible_t_ns, f->t_ns);
  if (hidden_s > (track->in_blind_zone ? params->blind_zone_s : params->out_of_view_s)) return true;
  if (track->confirmed) return track->misses > params->miss_max;
  const int32_t window = window_length(params, track);
  const int32_t seen = track->seen_frames < window ? track->seen_frames : window;
  return seen - hits_in_window(params, track) > params->confirm_window - params->confirm_hits;
}

/* ---- the table of tracks ---- */

static void predict(vista_tracker *tracker, const frame *f) {
  const double dt_s = tracker->started ? seconds_between(tracker->t_ns, f->t_ns) : 0.0;
  for (int32_t i = 0; i < tracker->count; ++i) {
    vista_track_filter_predict(f->params, dt_s, &tracker->tracks[i]);
    tracker->tracks[i].age_frames += 1;
  }
}

/* Views of all tracks; those that were passed leave the table. */
static void look_at_all(vista_tracker *tracker, const frame *f) {
  int32_t kept = 0;
  for (int32_t i = 0; i < tracker->count; ++i) {
    if (!look(f, &tracker->tracks[i], &tracker->views[kept])) continue;
    tracker->tracks[kept] = tracker->tracks[i];
    ++kept;
  }
  tracker->count = kept;
}

static void take(const frame *f, const vista_detection *detection, const vista_track_view *view, bool reshaped,
                 vista_track *track) {
  double variance_px2[3];
  vista_track_filter_noise(f->params, f->camera, detection, view, reshaped, variance_px2);
  const vista_world_hit seen = world_hit(f, detection, view->camera_m[2], variance_px2);
  vista_static_world_add(f->params, &seen, &track->world);
  vista_track_filter_update(f->params, view, detection, variance_px2, track);
  hit(f, detection, track);
}

/* A track seen once, and a detection that no track explains: perhaps the same, moved. That is one more track, behind the
 * others in the table; both go on as what stands, too. Returns how many there are. */
static int32_t spawn_moving(vista_tracker *tracker, const frame *f) {
  int32_t spawned = 0;
  for (int32_t i = 0; i < tracker->count && tracker->count + spawned < tracker->max_tracks; ++i) {
    const int32_t detection = vista_track_association_moved_to(tracker->association, i);
    if (detection < 0) continue;
    vista_track *const track = &tracker->tracks[tracker->count + spawned++];
    *track = tracker->tracks[i];
    track->id = tracker->next_id++;
    track->moved = true;
    const double since_s = seconds_between(track->hit_t_ns, f->t_ns);
    vista_track_view view;
    vista_track_filter_set_moving(f->params, since_s, track);
    vista_track_filter_view(f->params, f->camera, f->pose, since_s, track, &view);
    take(f, &f->detections[detection], &view, false, track);
  }
  return spawned;
}

static void update(vista_tracker *tracker, const frame *f) {
  const int32_t spawned = spawn_moving(tracker, f);
  int32_t kept = 0;
  for (int32_t i = 0; i < tracker->count; ++i) {
    vista_track *const track = &tracker->tracks[i];
    const int32_t detection = tracker->detection_of_track[i];
    if (detection < 0)
      miss(f, track);
    else
      take(f, &f->detections[detection], &tracker->views[i],
           vista_track_association_reshaped(tracker->association, i), track);
    judge(f, track);
    if (!outlived(f, track)) tracker->tracks[kept++] = *track;
  }
  for (int32_t i = 0; i < spawned; ++i) tracker->tracks[kept++] = tracker->tracks[tracker->count + i];
  tracker->count = kept;
}

/* The older id goes on with the state of whichever of the two was seen in this frame. */
static void merge(vista_tracker *tracker, int32_t older, int32_t younger) {
  const vista_track kept = tracker->tracks[older];
  if (!kept.coasting || tracker->tracks[younger].coasting) return;
  tracker->tracks[older] = tracker->tracks[younger];
  tracker->views[older] = tracker->views[younger];
  tracker->tracks[older].id = kept.id;
  tracker->tracks[older].age_frames = kept.age_frames;
  tracker->tracks[older].hits = kept.hits + 1;
}

/* Tentative tracks within a confirmed one, and the younger of two confirmed ones that are within each other. */
static void remove_duplicates(vista_tracker *tracker, const frame *f) {
  for (int32_t i = 0; i < tracker->count; ++i) {
    if (!tracker->tracks[i].confirmed) continue;
    int32_t kept = 0;
    int32_t self = i; /* where track i is while the table closes up */
    for (int32_t j = 0; j < tracker->count; ++j) {
      const bool confirmed = tracker->tracks[j].confirmed;
      bool same = j != i && vista_track_within(f->params, &tracker->views[j], &tracker->views[self]);
      if (same && confirmed)
        same = j > i && vista_track_within(f->params, &tracker->views[self], &tracker->views[j]);
      if (same && confirmed) merge(tracker, self, j);
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

static bool within_confirmed(const vista_tracker *tracker, const frame *f, const vista_track_view *view) {
  for (int32_t i = 0; i < tracker->count; ++i)
    if (tracker->tracks[i].confirmed && vista_track_within(f->params, view, &tracker->views[i])) return true;
  return false;
}

static void start(vista_tracker *tracker, const frame *f, const vista_detection *detection) {
  const double *p = detection->position_camera_m;
  if (sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]) > f->params->range_max_m) return;
  vista_track newborn;
  vista_track_view view;
  vista_track_filter_start(f->params, f->camera, f->pose, detection, &newborn);
  newborn.hit_t_ns = f->t_ns;
  if (!look(f, &newborn, &view) || within_confirmed(tracker, f, &view)) return;
  if (tracker->count == tracker->max_tracks && !make_room(tracker, &newborn)) return;
  double variance_px2[3];
  vista_track_filter_noise(f->params, f->camera, detection, &view, false, variance_px2);
  const vista_world_hit seen = world_hit(f, detection, p[2], variance_px2);
  vista_static_world_start(f->params, &seen, &newborn.world);
  newborn.id = tracker->next_id++;
  newborn.age_frames = 1;
  newborn.visible_t_ns = f->t_ns;
  judge(f, &newborn);
  tracker->tracks[tracker->count] = newborn;
  tracker->views[tracker->count] = view;
  ++tracker->count;
}

vista_status vista_tracker_update(vista_tracker *tracker, const vista_tracker_params *params,
                                  const vista_camera *camera, const vista_matched_area *matched,
                                  const vista_pose *pose, int64_t t_ns, const vista_detection *detections,
                                  int32_t count) {
  if (tracker == NULL || params == NULL || camera == NULL || matched == NULL || (detections == NULL && count != 0))
    return VISTA_ERROR_ARGUMENT;
  const frame f = {params, camera, matched, pose != NULL ? pose : &vista_frame_still, t_ns, detections, count};
  const vista_status status = check(tracker, &f);
  if (status != VISTA_OK) return status;
  predict(tracker, &f);
  look_at_all(tracker, &f);
  vista_track_associate(tracker->association, params, camera, f.pose, tracker->tracks, tracker->views,
                        tracker->count, detections, count, tracker->detection_of_track);
  update(tracker, &f);
  look_at_all(tracker, &f);
  remove_duplicates(tracker, &f);
  for (int32_t i = 0; i < count; ++i)
    if (!vista_track_association_claimed(tracker->association, i)) start(tracker, &f, &detections[i]);
  tracker->started = true;
  tracker->t_ns = t_ns;
  return VISTA_OK;
}
