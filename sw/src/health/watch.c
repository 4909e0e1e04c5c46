#include "health/watch.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#include "common/frame.h"
#include "common/numbers.h"

#define PART_PX 8 /* of a row, compared at once */
#define WHITE 250 /* grey levels, from which on a pixel is burnt out */
#define NOISE_MIN 0.5 /* grey levels: with less, a live image may stay as it is */
#define MOVED_M 0.02 /* between two frames: the images have to differ */
#define LOOK_M 30.0 /* the part of the image where the path leads is as wide as the volume so far ahead */
#define SIDEWAYS_M 3.0
#define FROZEN_SHARE 0.9
#define STUCK_SHARE 0.2
#define STILL_STUCK_SHARE 0.1 /* of what was stuck in the pair before */
#define NOISE_KEPT 0.995 /* Dirt takes the noise away that tells it. */
#define HELD 8 /* frames: those that the map of space keeps, and until a track is confirmed */
#define GAP_S 0.5 /* between two pairs: longer than any source pauses, */
#define GAP_TIMES 4.0 /* and than this one did before by so many times */
#define SIGNIFICANT 7.0 /* standard deviations */
#define STEP_M 0.4 /* that a pose may be off in one frame, */
#define STEP_SHARE 0.15 /* and of the way */
#define TURN_RAD 0.008
#define CORRECTED_M 0.1 /* by which a navigation filter corrects itself */
#define ACCELERATION_M_S2 10.0 /* of a vehicle that nothing else tells of, */
#define ACCELERATION_MAX_M_S2 50.0 /* and of any */
#define ANGULAR_RAD_S2 10.0 /* the same of its turn, */
#define TURNED_RAD 0.02 /* and what a navigation filter corrects that by */
#define SCATTERS 5.0
#define SCATTER_SHARE 0.1 /* of a pose, in the mean of the scatter */
#define SHOWN_SHARE 0.5
#define FOUND_SHARE 0.2 /* of the points that should be seen, */
#define FOUND_DROP 0.5 /* after a frame in which twice as many were, */
#define FOUND_LEAST 0.05 /* or after any */
#define ASKED_MIN 24
#define OFFSET_PX 0.5
#define VELOCITY_M_S 0.2 /* that the poses lack, */
#define VELOCITY_SHARE 0.02 /* and of the speed */
#define LASTING 9.0 /* standard deviations of what is averaged */

void vista_watch_layout(vista_watch *w, vista_arena *arena, const vista_camera *camera, double radius_m) {
  *w = (vista_watch){.camera = *camera, .radius_m = radius_m};
  vista_coherence_layout(&w->coherence, arena, camera);
  for (int side = 0; side < 2; ++side)
    w->before[side] = vista_arena_take(arena, (size_t)camera->width_px * (size_t)camera->height_px, 1);
}

void vista_watch_reset(vista_watch *w) {
  vista_coherence_reset(&w->coherence);
  w->began = w->posed = w->stuck = false;
  w->way = (vista_watched_way){0};
  w->passed_s = w->noise = w->found_share = 0.0;
  w->doubted = w->restarted = w->jumped = w->differed = 0;
}

void vista_watch_time_went_back(vista_watch *w) { w->jumped = HELD + 1; }

void vista_watch_begin_anew(vista_watch *w) { w->restarted = HELD + 1; }

/* Columns and rows of an image. */
typedef struct window {
  int32_t left, right, top, bottom;
} window;

typedef struct shares {
  int64_t whole, same, ahead, same_ahead; /* parts of rows that are not burnt out */
} shares;

static bool is_white(uint64_t part) {
  const uint8_t *const pixels = (const uint8_t *)&part;
  int white = 0;
  for (int k = 0; k < PART_PX; ++k) white += pixels[k] >= WHITE;
  return white == PART_PX;
}

/* Compares an image with the one before, whose place it takes. */
static shares compare(const vista_image *image, uint8_t *before, const window *ahead) {
  shares s = {0};
  for (int32_t v = 0; v < image->height_px; ++v) {
    const uint8_t *const row = image->data + v * image->stride;
    uint8_t *const old = before + (ptrdiff_t)v * image->width_px;
    const bool high = v >= ahead->top && v < ahead->bottom;
    for (int32_t u = 0; u + PART_PX <= image->width_px; u += PART_PX) {
      uint64_t now, then;
      memcpy(&now, row + u, sizeof now);
      memcpy(&then, old + u, sizeof then);
      const bool same = now == then;
      if (same && is_white(now)) continue;
      const bool within = high && u >= ahead->left && u < ahead->right;
      ++s.whole;
      s.same += same;
      s.ahead += within;
      s.same_ahead += same && within;
    }
    memcpy(old, row, (size_t)image->width_px);
  }
  return s;
}

static bool at_least(int64_t part, int64_t whole, double share) {
  return whole > 0 && (double)part >= share * (double)whole;
}

/* Where the flight leads; empty where that is not in view. */
static window ahead_of(const vista_watch *w, const vista_motion *motion) {
  const vista_camera *const camera = &w->camera;
  double to[3];
  vista_frame_direction_to_camera(&motion->pose, motion->direction, to);
  if (!(to[2] * LOOK_M > SIDEWAYS_M)) return (window){0};
  const double half = camera->focal_px * w->radius_m / (LOOK_M * to[2]);
  const double u = camera->center_u_px + camera->focal_px * to[0] / to[2];
  const double v = camera->center_v_px + camera->focal_px * to[1] / to[2];
  return (window){
      (int32_t)fmax(0.0, fmin(u - half, camera->width_px)), (int32_t)fmax(0.0, fmin(u + half, camera->width_px)),
      (int32_t)fmax(0.0, fmin(v - half, camera->height_px)), (int32_t)fmax(0.0, fmin(v + half, camera->height_px))};
}

static uint32_t bit(vista_health_reason reason) { return UINT32_C(1) << reason; }

static uint32_t judge_images(vista_watch *w, const vista_image *const sides[2], double noise, bool moved,
                             const window *ahead) {
  uint32_t reasons = 0;
  bool frozen[2] = {false, false}, asked[2] = {false, false}, stuck = false;
  const double share = w->stuck ? STILL_STUCK_SHARE : STUCK_SHARE;
  w->noise = fmax(noise, (w->stuck ? 1.0 : NOISE_KEPT) * w->noise);
  for (int side = 0; side < 2; ++side) {
    if (sides[side]->data == NULL) continue;
    const shares s = compare(sides[side], w->before[side], ahead);
    asked[side] = w->began && w->had[side];
    frozen[side] = at_least(s.same, s.whole, FROZEN_SHARE);
    stuck |= asked[side] && moved && w->noise > NOISE_MIN && at_least(s.same_ahead, s.ahead, share);
  }
  w->stuck = stuck;
  if (stuck) reasons |= bit(VISTA_HEALTH_VIEW_STUCK);
  /* Without poses one camera that stands still tells itself by the other one, which does not. */
  const bool one = asked[0] && asked[1] && frozen[0] != frozen[1];
  if (one || (moved && ((asked[0] && frozen[0]) || (asked[1] && frozen[1])))) reasons = bit(VISTA_HEALTH_IMAGES_FROZEN);
  return reasons;
}

static bool is_significant(vista_estimate of, double sigmas, double least) {
  return fabs(of.value) > least && fabs(of.value) > sigmas * of.sigma;
}

static bool moves_otherwise(vista_watch *w, const vista_coherence_result *c, double way_m) {
  bool lost = false;
  if (c->asked >= ASKED_MIN && c->chosen >= ASKED_MIN) { /* an image that shows nothing is no image of elsewhere */
    const double share = (double)c->found / c->asked;
    lost = share < FOUND_SHARE && (share < FOUND_LEAST || share < FOUND_DROP * w->found_share || w->doubted > 0);
    w->found_share = share;
  }
  const double step_m = STEP_M + STEP_SHARE * way_m;
  const bool jumped =
      c->fitted &&
      (is_significant((vista_estimate){vista_norm(c->step_m), c->step_sigma_m}, SIGNIFICANT, step_m) ||
       is_significant((vista_estimate){vista_norm(c->turn_rad), c->turn_sigma_rad}, SIGNIFICANT, TURN_RAD));
  return lost || jumped || c->late != 0;
}

static bool lacks_something(const vista_coherence_result *c, double speed_m_s) {
  const double least_m_s = VELOCITY_M_S + VELOCITY_SHARE * speed_m_s;
  return c->jump_px != 0.0 || is_significant(c->offset_px, LASTING, OFFSET_PX) ||
         is_significant(c->velocity_m_s, LASTING, least_m_s);
}

/* Goes on giving a reason for HELD frames after the last in which it was found. */
static uint32_t held(int32_t *frames, bool found, vista_health_reason reason) {
  if (found)
    *frames = HELD;
  else if (*frames > 0)
    --*frames;
  return *frames > 0 ? bit(reason) : 0;
}

typedef struct leading {
  bool elsewhere; /* after poses that were refused or missing */
  bool doubtful;  /* no image shows it */
  bool impossible; /* images show it, and no vehicle moves so */
} leading;

/* Asks whether the images show most of what a pose is off the last velocity. */
static bool is_shown(const vista_coherence_result *c, double off_m) {
  return c->fitted && vista_norm(c->step_m) + 2.0 * c->step_sigma_m < SHOWN_SHARE * off_m;
}

static leading judge_way(vista_watched_way *way, const double step_m[3], double passed_s,
                         const vista_coherence_result *c) {
  leading found = {0};
  double off[3];
  for (int i = 0; i < 3; ++i) off[i] = step_m[i] - way->rate_m_s[i] * passed_s;
  const double off_m = vista_norm(off), reach_s2 = 0.5 * passed_s * (passed_s + way->rate_s);
  const double scatter_m = CORRECTED_M + SCATTERS * sqrt(way->scatter2_m2);
  const double may_m = scatter_m + ACCELERATION_M_S2 * reach_s2;
  const double ahead_m = vista_norm(way->rate_m_s) * passed_s;
  if (way->refused || way->missed) {
    const bool stands = vista_norm(step_m) < MOVED_M && off_m > scatter_m;
    found.elsewhere = stands || off_m > (way->refused ? STEP_M + STEP_SHARE * ahead_m : may_m);
    return found;
  }
  found.doubtful = off_m > may_m && !is_shown(c, off_m);
  found.impossible = !found.doubtful && off_m > scatter_m + ACCELERATION_MAX_M_S2 * reach_s2;
  const double share = fmax(SCATTER_SHARE, 1.0 / ++way->scattered);
  way->scatter2_m2 += share * (vista_square(fmin(off_m, may_m)) - way->scatter2_m2);
  return found;
}

/* The turn from one attitude to another, in the world. */
static void turn_between(const double before[9], const double now[9], double turn_rad[3]) {
  double between[9] = {0};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) between[3 * i + j] = vista_dot(&now[3 * i], &before[3 * j]);
  const double sine[3] = {0.5 * (between[7] - between[5]), 0.5 * (between[2] - between[6]),
                          0.5 * (between[3] - between[1])};
  const double length = vista_norm(sine), cosine = 0.5 * (between[0] + between[4] + between[8] - 1.0);
  const double scale = length > 0.0 ? atan2(length, cosine) / length : 0.0;
  for (int i = 0; i < 3; ++i) turn_rad[i] = scale * sine[i];
}

/* Asks whether an attitude is one that the last turn does not lead to, and that no image shows. */
static bool turns_otherwise(const vista_watched_way *way, const double turn_rad[3], double passed_s,
                            const vista_coherence_result *c) {
  double off[3];
  for (int i = 0; i < 3; ++i) off[i] = turn_rad[i] - way->turn_rad_s[i] * passed_s;
  const double off_rad = vista_norm(off);
  const bool shown = c->fitted && vista_norm(c->turn_rad) + 2.0 * c->turn_sigma_rad < SHOWN_SHARE * off_rad;
  return off_rad > TURNED_RAD + ANGULAR_RAD_S2 * 0.5 * passed_s * (passed_s + way->rate_s) && !shown;
}

/* Follows the poses that are believed, and judges where this one leads. */
static leading follow_way(vista_watched_way *way, const vista_motion *motion, int64_t t_ns,
                          const vista_coherence_result *c) {
  leading found = {0};
  way->refused |= motion->source == VISTA_MOTION_REFUSED;
  way->missed |= motion->source == VISTA_MOTION_CARRIED_ON;
  if (motion->source != VISTA_MOTION_POSE) return found;
  if (motion->restarted) *way = (vista_watched_way){0};
  const double passed_s = vista_seconds_between(way->t_ns, t_ns), *const at_m = motion->pose.translation_m;
  double step_m[3], turn_rad[3];
  for (int i = 0; i < 3; ++i) step_m[i] = at_m[i] - way->at_m[i];
  turn_between(way->rotation, motion->pose.rotation, turn_rad);
  if (way->rated) {
    found = judge_way(way, step_m, passed_s, c);
    found.doubtful |= !way->refused && !way->missed && turns_otherwise(way, turn_rad, passed_s, c);
  }
  way->rated = way->began;
  way->rate_s = passed_s;
  for (int i = 0; i < 3 && way->rated; ++i) {
    way->rate_m_s[i] = step_m[i] / passed_s;
    way->turn_rad_s[i] = turn_rad[i] / passed_s;
  }
  memcpy(way->at_m, at_m, sizeof way->at_m);
  memcpy(way->rotation, motion->pose.rotation, sizeof way->rotation);
  way->began = true;
  way->refused = way->missed = false;
  way->t_ns = t_ns;
  return found;
}

bool vista_watch_words(vista_watch *w, bool differ) {
  return held(&w->differed, differ, VISTA_HEALTH_WORDS_DIFFER) == 0;
}

void vista_watch_pair(vista_watch *w, const vista_image *left, const vista_image *right, double noise,
                      const vista_result *result, int64_t t_ns, vista_watched *found) {
  const vista_motion *const motion = &result->motion;
  const vista_image *const sides[2] = {left, right};
  const bool posed = motion->source == VISTA_MOTION_POSE;
  double step_m[3] = {0};
  for (int i = 0; i < 3 && posed && w->posed; ++i) step_m[i] = motion->pose.translation_m[i] - w->pose.translation_m[i];
  const bool moved = vista_norm(step_m) > MOVED_M;
  const window ahead = ahead_of(w, motion);
  *found = (vista_watched){.reasons = judge_images(w, sides, noise, moved, &ahead)};
  const bool frozen = (found->reasons & bit(VISTA_HEALTH_IMAGES_FROZEN)) != 0;
  if (frozen) vista_coherence_reset(&w->coherence); /* what stands still tells neither offset nor velocity */
  if (left->data != NULL)
    vista_coherence_update(&w->coherence, left, result->views->words, motion, t_ns, &found->coherence);
  else
    vista_coherence_reset(&w->coherence);
  const leading way = follow_way(&w->way, motion, t_ns, &found->coherence);
  const bool otherwise = moves_otherwise(w, &found->coherence, vista_norm(step_m));
  found->reasons |= held(&w->doubted, frozen || otherwise || way.doubtful, VISTA_HEALTH_MOTION_DOUBTFUL);
  if (w->doubted == 0 && lacks_something(&found->coherence, motion->speed_m_s))
    found->reasons |= bit(VISTA_HEALTH_DISPARITIES_OFF);
  const double passed_s = w->began ? vista_seconds_between(w->t_ns, t_ns) : 0.0;
  const bool gap = w->passed_s > 0.0 && passed_s > fmax(GAP_S, GAP_TIMES * w->passed_s);
  found->reasons |= held(&w->jumped, gap || way.impossible, VISTA_HEALTH_TIME_JUMP);
  found->reasons |= held(&w->restarted, motion->restarted || way.elsewhere, VISTA_HEALTH_POSE_JUMP);
  w->began = true;
  w->t_ns = t_ns;
  w->passed_s = passed_s;
  for (int side = 0; side < 2; ++side) w->had[side] = sides[side]->data != NULL;
  w->posed = posed;
  w->pose = motion->pose;
}
