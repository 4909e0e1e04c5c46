#include "follow/track_life.h"

#include <math.h>
#include <string.h>

#include "common/bits.h"
#include "common/frame.h"
#include "common/numbers.h"
#include "follow/track_evidence.h"

#define MOVED_HITS 2 /* a track that moves needs this many hits, and has this many frames, more to be confirmed */
/* A track outside the matched part of the image, which is not in the way, coasts for this long. */
#define OUT_OF_VIEW_S 0.3
/* A track without a detection, not in the way, is followed by the words at its place for this long. */
#define FOLLOW_S 1.0
/* Or until its disparity has moved by this, if nothing is matched there and that takes no longer than FOLLOW_S. */
#define HOLD_PX 0.6
#define DEPTH_PASSED_M 0.05 /* a track nearer than this along z is behind the camera */
#define LOST_PX (1.0 / VISTA_DISPARITY_SCALE) /* one that went on to where no word can be is lost */

/* N and M of this track: what is linked over a larger distance has to show it more often. */
static int32_t window_length(const vista_tracker_params *params, const vista_track *track) {
  const int32_t length = params->confirm_window + (track->moved ? MOVED_HITS : 0);
  return length < VISTA_WINDOW_BITS ? length : VISTA_WINDOW_BITS;
}

static int32_t hits_needed(const vista_tracker_params *params, const vista_track *track) {
  return window_length(params, track) - (params->confirm_window - params->confirm_hits);
}

static int32_t hits_in_window(const vista_tracker_params *params, const vista_track *track) {
  return vista_window_count(track->window, window_length(params, track));
}

bool vista_track_look(const vista_track_frame *f, vista_track *track, vista_track_view *view) {
  double camera_m[3];
  vista_frame_to_camera(f->pose, track->position_m, camera_m);
  if (!isfinite(camera_m[0] + camera_m[1] + camera_m[2]) || camera_m[2] <= DEPTH_PASSED_M) return false;
  vista_track_filter_view(f->params, f->camera, f->pose, vista_seconds_between(track->hit_t_ns, f->t_ns), track, view);
  const double *const at_px = view->measurement_px;
  if (at_px[2] < LOST_PX) return false;
  track->in_view = vista_matched_holds(f->matched, f->camera, at_px[0], at_px[1], at_px[2]);
  /* A sigma of doubt counts as blind: no track is blamed where the engine might not match. What left the image
   * before it came near is not blind, it is out of view. */
  const bool near = at_px[2] + sqrt(view->covariance_px2[8]) > f->matched->disparity_max_px;
  track->in_blind_zone = near && (track->in_view || track->in_blind_zone);
  return true;
}

/* The place of a detection, with the noise that it has at `depth_m`: the depth of the track, steadier than its own. */
static vista_world_hit world_hit(const vista_track_frame *f, const vista_detection *detection, double depth_m,
                                 const double variance_px2[3]) {
  const double *const p = detection->position_camera_m;
  const double slant = sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]) / p[2];
  const double per_px_m = depth_m / f->camera->focal_px;
  vista_world_hit hit = {.along_sigma_m = slant * per_px_m * depth_m / f->camera->baseline_m * sqrt(variance_px2[2]),
                         .across_sigma_m = per_px_m * sqrt(fmax(variance_px2[0], variance_px2[1])),
                         .t_ns = f->t_ns,
                         .foot_seen = detection->foot_seen,
                         .foot_share = detection->foot_share};
  vista_frame_to_world(f->pose, p, hit.position_m);
  memcpy(hit.camera_m, f->pose->translation_m, sizeof hit.camera_m);
  return hit;
}

void vista_track_judge(const vista_track_frame *f, vista_track *track) {
  vista_static_world_decide(&track->world, track->unrepeated || vista_static_world_silent(&track->world, f->t_ns),
                            hits_in_window(f->params, track), hits_needed(f->params, track), &track->confirmed,
                            &track->credible);
}

/* From the position to the middle of what is seen: the border of the image may hide the larger part. */
static void find_seen_off(const vista_track_frame *f, vista_track *track) {
  double camera_m[3], seen_px[3], seen_m[3];
  vista_frame_to_camera(f->pose, track->position_m, camera_m);
  vista_frame_measure(f->camera, camera_m, seen_px, NULL);
  seen_px[0] = track->ellipse.center_u_px;
  seen_px[1] = track->ellipse.center_v_px;
  vista_frame_point(f->camera, seen_px, camera_m);
  vista_frame_to_world(f->pose, camera_m, seen_m);
  for (int i = 0; i < 3; ++i) track->seen_off_m[i] = seen_m[i] - track->position_m[i];
}

static void hit(const vista_track_frame *f, const vista_detection *detection, vista_track *track) {
  track->coasting = track->followed = track->held = false;
  track->label = detection->label;
  track->edges_only = track->plain && !detection->plain;
  track->plain = track->plain || detection->plain;
  track->unrepeated = detection->unrepeated;
  if (detection->plain || detection->line) track->lasting_sigma_m = vista_track_lasting_sigma_m(detection);
  if (!track->edges_only) vista_track_filter_meet(f->pose, detection, track);
  if (!track->edges_only)
    track->volume_window = track->volume_window << 1 | (detection->volume_pixels >= VISTA_VOLUME_PIXELS);
  track->window = track->window << 1 | 1u;
  track->hits += 1;
  track->seen_frames += 1;
  track->misses = 0;
  track->hit_t_ns = track->seen_t_ns = track->visible_t_ns = f->t_ns;
  track->ellipse = detection->ellipse;
  track->ellipse_depth_m = f->camera->focal_px * f->camera->baseline_m / detection->disparity_px;
  find_seen_off(f, track);
}

/* How far the region wanders, and how far it was expected to by the noise of its detections and of the prediction. */
static void scatter(const vista_detection *detection, const vista_track_view *view, const double variance_px2[3],
                    vista_track *track) {
  const double off_px[3] = {detection->u_px - view->measurement_px[0], detection->v_px - view->measurement_px[1],
                            detection->disparity_px - view->measurement_px[2]};
  const double weight = 1.0 / fmin(track->hits, VISTA_SCATTER_HITS);
  for (int i = 0; i < 3; ++i) {
    const double expected_px2 = view->covariance_px2[4 * i] + variance_px2[i];
    track->scatter_px2[i] += weight * (vista_square(off_px[i]) - track->scatter_px2[i]);
    track->lasting_px2[i] += weight * (off_px[i] * track->off_px[i] - track->lasting_px2[i]);
    track->off_px[i] = off_px[i];
    track->expected_px2[i] += weight * (expected_px2 - track->expected_px2[i]);
  }
}

void vista_track_take(const vista_track_frame *f, const vista_detection *detection, const vista_track_view *view,
                      bool reshaped, vista_track *track) {
  double variance_px2[3];
  vista_track_filter_noise(f->params, f->camera, detection, view, reshaped, variance_px2);
  const vista_world_hit seen = world_hit(f, detection, view->camera_m[2], variance_px2);
  vista_static_world_add(&seen, &track->world);
  scatter(detection, view, variance_px2, track);
  vista_track_filter_update(view, detection, variance_px2, track);
  hit(f, detection, track);
}

/* The words at its place correct the range; where it is across the line of sight they do not tell. */
static void follow(const vista_track_frame *f, const vista_track_evidence *evidence, const vista_track_view *view,
                   vista_track *track) {
  const vista_detection seen = {.u_px = view->measurement_px[0],
                                .v_px = view->measurement_px[1],
                                .disparity_px = evidence->disparity_px,
                                .sigma_disparity_px = evidence->sigma_disparity_px,
                                .extent_m = {track->extent_m[0], track->extent_m[1]},
                                .cut_u = true,
                                .cut_v = true};
  const double variance_px2[3] = {vista_square(f->camera->width_px), vista_square(f->camera->height_px),
                                  vista_square(evidence->sigma_disparity_px)};
  vista_track_filter_update(view, &seen, variance_px2, track);
  track->coasting = false;
  track->followed = true;
  track->seen_t_ns = track->visible_t_ns = f->t_ns;
}

/* Says whether a track is in the way, as far as its last hits tell. */
static bool in_the_way(const vista_track *track) {
  return track->credible && vista_window_count(track->volume_window, 3) > 0;
}

/* Says whether a track is waited for where nothing is matched. Sharp textures are matched where their disparity is
 * about a whole number, and may be lost half way to the next one. So a track is waited for until its disparity has
 * moved on by hold_px, unless that takes longer than follow_s. What counts is the aircraft's own travel: a chance match
 * that seems to fly along would be waited for for ever. */
static bool may_be_held(const vista_track_frame *f, const vista_track *track) {
  if (track->credible && track->plain) return true;
  const double unseen_s = vista_seconds_between(track->seen_t_ns, f->t_ns);
  if (track->credible && unseen_s <= VISTA_HOLD_S) return true;
  const double seen_px = f->camera->focal_px * f->camera->baseline_m / track->ellipse_depth_m;
  double stood_m[3], camera_m[3];
  for (int i = 0; i < 3; ++i) stood_m[i] = track->position_m[i] - unseen_s * track->velocity_m_s[i];
  vista_frame_to_camera(f->pose, stood_m, camera_m);
  if (!(camera_m[2] > 0.0)) return false;
  const double moved_px = fabs(f->camera->focal_px * f->camera->baseline_m / camera_m[2] - seen_px);
  return moved_px <= HOLD_PX && moved_px * FOLLOW_S >= HOLD_PX * unseen_s;
}

void vista_track_miss(const vista_track_frame *f, const vista_track_view *view, vista_track *track) {
  track->coasting = true;
  track->followed = track->held = false;
  track->label = -1;
  if (!track->in_view || track->in_blind_zone) return;
  const vista_track_evidence evidence = vista_track_look_for(f->camera, f->matched, f->disparity, view);
  const double undetected_s = vista_seconds_between(track->hit_t_ns, f->t_ns);
  if (track->credible && evidence.sight == VISTA_SIGHT_ITSELF && (in_the_way(track) || undetected_s <= FOLLOW_S)) {
    follow(f, &evidence, view, track);
    return;
  }
  track->held = evidence.sight == VISTA_SIGHT_NOTHING && may_be_held(f, track);
  if (track->held) return;
  track->window <<= 1;
  track->seen_frames += 1;
  track->misses += 1;
  track->visible_t_ns = f->t_ns;
}

bool vista_track_outlived(const vista_track_frame *f, const vista_track *track) {
  const vista_tracker_params *params = f->params;
  const double hidden_s = vista_seconds_between(track->visible_t_ns, f->t_ns);
  const bool kept = track->in_blind_zone || track->held || in_the_way(track);
  /* What has moved by itself may come back: in a turn of the camera, for one. */
  const double away_s = track->moved ? fmax(FOLLOW_S, OUT_OF_VIEW_S) : OUT_OF_VIEW_S;
  if (hidden_s > (kept ? VISTA_BLIND_ZONE_S : away_s)) return true;
  if (track->confirmed) return track->misses > params->miss_max;
  const int32_t window = window_length(params, track);
  const int32_t seen = track->seen_frames < window ? track->seen_frames : window;
  return seen - hits_in_window(params, track) > params->confirm_window - params->confirm_hits;
}

void vista_track_start(const vista_track_frame *f, const vista_detection *detection, vista_track *track) {
  vista_track_view view;
  double variance_px2[3];
  vista_track_filter_start(f->params, f->camera, f->pose, detection, track);
  vista_track_filter_view(f->params, f->camera, f->pose, 0.0, track, &view);
  vista_track_filter_noise(f->params, f->camera, detection, &view, false, variance_px2);
  const vista_world_hit seen = world_hit(f, detection, detection->position_camera_m[2], variance_px2);
  vista_static_world_start(&seen, &track->world);
  track->age_frames = 1;
  track->hit_t_ns = track->seen_t_ns = track->visible_t_ns = f->t_ns;
  vista_track_judge(f, track);
}

void vista_track_set_moving(const vista_track_frame *f, vista_track *track, vista_track_view *view) {
  const double since_s = vista_seconds_between(track->hit_t_ns, f->t_ns);
  track->moved = true;
  vista_track_filter_set_moving(f->params, since_s, track);
  vista_track_filter_view(f->params, f->camera, f->pose, since_s, track, view);
}
