#include "health/coherence.h"

#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "align/place.h"
#include "common/frame.h"
#include "common/numbers.h"
#include "common/symmetric.h"
#include "vista/word.h"

#define UNKNOWNS 7 /* turn, step, offset */
#define OFFSET 6
#define LASTING VISTA_COHERENCE_LASTING
#define SIDE_PX (2 * VISTA_PLACE_SIDE) /* of a tile */
#define WORD_STEP_PX 4
#define SPREAD_PX 1.0 /* between the quartiles of a tile's words: more are two surfaces */
#define GRADIENT_MIN 2.5 /* of a corner, as for the rows */
#define NEARER_MOST 1.3 /* A point whose distance shrinks by more looks different. */
#define FLOW_MOST_PX 100.0
#define FEWEST 20
#define PLACE_SIGMA_PX 0.3
#define WORD_SIGMA_PX 0.3
#define ITERATIONS 8
#define WIDE_SIGMAS 12.0
#define SIGMAS 3.0
#define REMEMBERED_S 1.5
#define OFFSET_FLOOR_PX 0.2 /* of one frame: what words and surfaces have in common, */
#define VELOCITY_FLOOR_SHARE 0.02 /* and poses */
#define STEP_MIN_M 0.05
#define CHANGED 25.0 /* squared distance in standard deviations */
#define JUMP_FEWEST 4
#define JUMP_MANY 8 /* of which a quarter on each side may be wrong */
#define JUMP_PX 0.5
#define TURNS VISTA_COHERENCE_TURNS
#define LATE_MOST 3 /* frames */
#define LATE_OVER 4 /* the newest frames, by which it is told, */
#define LATE_FEWEST 2
#define LATE_TURN_RAD 0.001 /* that poses and images differ by in one frame, */
#define LATE_SQUARE 30.0 /* squared distance in such errors, */
#define LATE_SHARE 0.2 /* and what may be left of it */
#define JUMP_SHARE 0.5 /* of a jump: its return is larger, and so is the mean of the frames since */

void vista_coherence_layout(vista_coherence *c, vista_arena *arena, const vista_camera *camera) {
  *c = (vista_coherence){.camera = *camera};
  for (int k = 0; k < 2; ++k) vista_level_layout(camera->width_px / 2, camera->height_px / 2, arena, &c->half[k]);
  vista_level_layout(camera->width_px / 4, camera->height_px / 4, arena, &c->quarter);
}

static void forget_what_lasts(vista_coherence *c) {
  memset(c->information, 0, sizeof c->information);
  memset(c->weighted, 0, sizeof c->weighted);
}

void vista_coherence_reset(vista_coherence *c) {
  c->count = 0;
  c->posed = false;
  c->jump_px = 0.0;
  c->turned = 0;
  forget_what_lasts(c);
}

static int by_value(const void *a, const void *b) {
  const int16_t x = *(const int16_t *)a, y = *(const int16_t *)b;
  return (x > y) - (x < y);
}

/* The disparity of a tile, if most of it has one and it is one surface; else 0. */
static double disparity_of(const vista_coherence *c, const int16_t *words, int32_t u_px, int32_t v_px) {
  int16_t seen[(SIDE_PX / WORD_STEP_PX) * (SIDE_PX / WORD_STEP_PX)];
  int32_t count = 0, all = 0;
  for (int32_t v = v_px + SIDE_PX / 4; v < v_px + 3 * SIDE_PX / 4; v += WORD_STEP_PX / 2)
    for (int32_t u = u_px + SIDE_PX / 4; u < u_px + 3 * SIDE_PX / 4; u += WORD_STEP_PX / 2) {
      const int16_t word = words[(ptrdiff_t)v * c->camera.width_px + u];
      ++all;
      if (word > 0) seen[count++] = word;
    }
  if (count == 0 || 2 * count < all) return 0.0;
  qsort(seen, (size_t)count, sizeof *seen, by_value);
  const int32_t spread = seen[3 * count / 4] - seen[count / 4];
  return spread <= SPREAD_PX * VISTA_DISPARITY_SCALE ? (double)seen[count / 2] / VISTA_DISPARITY_SCALE : 0.0;
}

/* Points of the newest image, evenly over it. */
static void choose(vista_coherence *c, const int16_t *words) {
  const vista_level *const level = &c->quarter;
  const int32_t across = (level->width_px - 2) / VISTA_TILE, down = (level->height_px - 2) / VISTA_TILE;
  const int32_t tiles = across * down;
  c->count = 0;
  if (across <= 0 || down <= 0) return;
  int32_t step = 7; /* prime, and no divisor of the number of tiles: each comes once */
  if (tiles % step == 0) step = tiles % 5 == 0 ? 1 : 5;
  for (int32_t k = 0, tile = 0; k < tiles && c->count < VISTA_COHERENCE_POINTS; ++k, tile = (tile + step) % tiles) {
    const int32_t u0 = 1 + tile % across * VISTA_TILE, v0 = 1 + tile / across * VISTA_TILE;
    if (!vista_tile_has_corners(level, u0, v0, GRADIENT_MIN)) continue;
    const double disparity_px = disparity_of(c, words, 4 * u0, 4 * v0);
    if (disparity_px > 0.0) c->points[c->count++] = (vista_coherent_point){2 * u0, 2 * v0, disparity_px};
  }
}

/* A point where it was found: left over in u and v, their slopes by the unknowns, and 1 / sigma^2. */
typedef struct observation {
  double left_px[2], slopes[2][UNKNOWNS], weight;
  double expected_px; /* the disparity that it has now by the poses */
  int32_t u_px, v_px; /* first pixel of its tile now */
} observation;

/* Where the poses say that a point is now; false: not well to be seen. */
static bool predict(const vista_coherence *c, const vista_coherent_point *p, const vista_pose *now, double at_px[2],
                    double camera_m[3], double ray_m[3]) {
  const vista_camera *const camera = &c->camera;
  const double middle = 0.5 * SIDE_PX - 0.5;
  const double u = 2.0 * p->u0 + middle, v = 2.0 * p->v0 + middle;
  const double depth_m = camera->focal_px * camera->baseline_m / p->disparity_px;
  const double before_m[3] = {(u - camera->center_u_px) / camera->focal_px * depth_m,
                              (v - camera->center_v_px) / camera->focal_px * depth_m, depth_m};
  double world_m[3], still_m[3];
  vista_frame_to_world(&c->pose, before_m, world_m);
  vista_frame_to_camera(now, world_m, camera_m);
  for (int i = 0; i < 3; ++i) still_m[i] = world_m[i] - c->pose.translation_m[i];
  vista_frame_direction_to_camera(now, still_m, ray_m);
  if (!(camera_m[2] > 0.0) || before_m[2] > NEARER_MOST * camera_m[2] || camera_m[2] > NEARER_MOST * before_m[2])
    return false;
  const double scale = camera->focal_px / camera_m[2];
  at_px[0] = camera->center_u_px + scale * camera_m[0] - u;
  at_px[1] = camera->center_v_px + scale * camera_m[1] - v;
  const double to_u = u + at_px[0], to_v = v + at_px[1];
  const bool inside =
      to_u > SIDE_PX && to_v > SIDE_PX && to_u < camera->width_px - SIDE_PX && to_v < camera->height_px - SIDE_PX;
  return inside && hypot(at_px[0], at_px[1]) < FLOW_MOST_PX;
}

/* Slopes of the image by a movement of the point in the camera. */
static void slope(const vista_camera *camera, const double camera_m[3], const double move[3], double *u, double *v) {
  const double scale = camera->focal_px / camera_m[2];
  *u = scale * (move[0] - camera_m[0] / camera_m[2] * move[2]);
  *v = scale * (move[1] - camera_m[1] / camera_m[2] * move[2]);
}

static observation observe(const vista_coherence *c, const vista_coherent_point *p, const double camera_m[3],
                           const double ray_m[3], const double left_px[2], double sigma_px) {
  observation o = {.left_px = {left_px[0], left_px[1]},
                   .expected_px = c->camera.focal_px * c->camera.baseline_m / camera_m[2]};
  for (int k = 0; k < 3; ++k) {
    const double axis[3] = {k == 0, k == 1, k == 2};
    double turned[3];
    vista_cross(axis, camera_m, turned);
    slope(&c->camera, camera_m, turned, &o.slopes[0][k], &o.slopes[1][k]);
    slope(&c->camera, camera_m, axis, &o.slopes[0][3 + k], &o.slopes[1][3 + k]);
  }
  double farther[3];
  for (int i = 0; i < 3; ++i) farther[i] = ray_m[i] / p->disparity_px;
  slope(&c->camera, camera_m, farther, &o.slopes[0][OFFSET], &o.slopes[1][OFFSET]);
  const double by_word = WORD_SIGMA_PX * hypot(o.slopes[0][OFFSET], o.slopes[1][OFFSET]);
  o.weight = 1.0 / (vista_square(PLACE_SIGMA_PX) + vista_square(sigma_px) + vista_square(by_word));
  return o;
}

static void rest_of(const observation *o, const double x[UNKNOWNS], double rest[2]) {
  for (int a = 0; a < 2; ++a) {
    rest[a] = o->left_px[a];
    for (int k = 0; k < UNKNOWNS; ++k) rest[a] -= o->slopes[a][k] * x[k];
  }
}

static double sigmas_of(const observation *o, const double x[UNKNOWNS]) {
  double rest[2];
  rest_of(o, x, rest);
  return sqrt(o->weight * (rest[0] * rest[0] + rest[1] * rest[1]));
}

/* Iterated least squares with weights that fall to 0, from wide to narrow; covariance: of x. */
static bool fit(const observation *seen, int32_t count, double x[UNKNOWNS], double covariance[UNKNOWNS][UNKNOWNS]) {
  static const double prior_sigma[UNKNOWNS] = {0.1, 0.1, 0.1, 5.0, 5.0, 5.0, 20.0};
  for (int k = 0; k < UNKNOWNS; ++k) x[k] = 0.0;
  for (int turn = 0; turn < ITERATIONS; ++turn) {
    const double share = fmin(1.0, turn / (ITERATIONS - 3.0));
    const double limit = WIDE_SIGMAS * pow(SIGMAS / WIDE_SIGMAS, share);
    double m[UNKNOWNS][UNKNOWNS] = {{0}}, right[UNKNOWNS] = {0};
    for (int k = 0; k < UNKNOWNS; ++k) m[k][k] = 1.0 / vista_square(prior_sigma[k]);
    for (int32_t n = 0; n < count; ++n) {
      const observation *const o = &seen[n];
      const double away = sigmas_of(o, x) / limit;
      if (!(away < 1.0)) continue;
      const double weight = o->weight * vista_square(1.0 - away * away);
      for (int a = 0; a < 2; ++a)
        for (int i = 0; i < UNKNOWNS; ++i) {
          right[i] += weight * o->slopes[a][i] * o->left_px[a];
          for (int j = 0; j < UNKNOWNS; ++j) m[i][j] += weight * o->slopes[a][i] * o->slopes[a][j];
        }
    }
    if (!vista_symmetric_invert(UNKNOWNS, m[0])) return false;
    for (int i = 0; i < UNKNOWNS; ++i) {
      x[i] = 0.0;
      for (int j = 0; j < UNKNOWNS; ++j) x[i] += m[i][j] * right[j];
    }
    memcpy(covariance, m, sizeof m);
  }
  return true;
}

/* What lasts, as far as it is known; false: it is not. */
static bool known(const vista_coherence *c, double value[LASTING], double covariance[LASTING][LASTING]) {
  memcpy(covariance, c->information, sizeof c->information);
  if (!vista_symmetric_invert(LASTING, covariance[0])) return false;
  for (int i = 0; i < LASTING; ++i) {
    value[i] = 0.0;
    for (int j = 0; j < LASTING; ++j) value[i] += covariance[i][j] * c->weighted[j];
  }
  return true;
}

/* Whether a frame says something else than those before: what lasted has changed. */
static bool contradicts(const vista_coherence *c, double told[LASTING][LASTING], const double value[LASTING]) {
  double before[LASTING], sum[LASTING][LASTING], square = 0.0;
  if (!known(c, before, sum)) return false;
  for (int i = 0; i < LASTING; ++i)
    for (int j = 0; j < LASTING; ++j) sum[i][j] += told[i][j];
  if (!vista_symmetric_invert(LASTING, sum[0])) return false;
  for (int i = 0; i < LASTING; ++i)
    for (int j = 0; j < LASTING; ++j) square += (value[i] - before[i]) * sum[i][j] * (value[j] - before[j]);
  return square > CHANGED;
}

/* Adds what one frame says of the step and the offset, whose errors are what all points of a frame have in common, too. */
static void remember(vista_coherence *c, const double x[UNKNOWNS], double covariance[UNKNOWNS][UNKNOWNS], double way_m,
                     double passed_s) {
  const double kept = exp(-passed_s / REMEMBERED_S);
  for (int i = 0; i < LASTING; ++i) {
    c->weighted[i] *= kept;
    for (int j = 0; j < LASTING; ++j) c->information[i][j] *= kept;
  }
  if (way_m < STEP_MIN_M) return; /* nothing tells the offset from none */
  double told[LASTING][LASTING], value[LASTING];
  for (int i = 0; i < LASTING; ++i) {
    const double per = i < 3 ? 1.0 / passed_s : 1.0; /* a velocity, and the offset */
    value[i] = per * x[3 + i];
    for (int j = 0; j < LASTING; ++j) told[i][j] = per * (j < 3 ? 1.0 / passed_s : 1.0) * covariance[3 + i][3 + j];
    told[i][i] += vista_square(i < 3 ? VELOCITY_FLOOR_SHARE * way_m / passed_s : OFFSET_FLOOR_PX);
  }
  if (contradicts(c, told, value)) forget_what_lasts(c);
  if (!vista_symmetric_invert(LASTING, told[0])) return;
  for (int i = 0; i < LASTING; ++i)
    for (int j = 0; j < LASTING; ++j) {
      c->information[i][j] += told[i][j];
      c->weighted[i] += told[i][j] * value[j];
    }
}

/* How much larger a point's disparity is than the poses let expect; false: its words do not tell. What the fit says that
 * the poses lack is not allowed for: before a single wall the fit cannot tell a step from an offset. */
static bool change_of(const vista_coherence *c, const observation *o, const int16_t *words, double *change_px) {
  const vista_camera *const camera = &c->camera;
  if (o->u_px < 0 || o->v_px < 0 || o->u_px + SIDE_PX > camera->width_px || o->v_px + SIDE_PX > camera->height_px)
    return false;
  const double disparity_px = disparity_of(c, words, o->u_px, o->v_px);
  *change_px = disparity_px - o->expected_px;
  return disparity_px > 0.0;
}

/* By how much the disparities of most points have changed beside what their motion changes; 0: by less than a jump. */
static double jump_of(const vista_coherence *c, const observation *seen, int32_t found, const int16_t *words) {
  double changes_px[VISTA_COHERENCE_POINTS];
  int32_t count = 0;
  for (int32_t k = 0; k < found; ++k) count += change_of(c, &seen[k], words, &changes_px[count]);
  if (count < JUMP_FEWEST) return 0.0;
  const double median_px = vista_lower_median(changes_px, count); /* and they are sorted */
  const int32_t apart = count < JUMP_MANY ? 0 : count / 4;
  /* After a jump, points are placed by a wrong disparity and approach at a wrong pace, which is no further jump. */
  const double least_px = fmax(JUMP_PX, JUMP_SHARE * fabs(c->jump_px));
  const bool jumped = changes_px[apart] > least_px || changes_px[count - 1 - apart] < -least_px;
  return jumped ? median_px : 0.0;
}

/* Forgets a jump when the mean of the frames since says that there is hardly an offset. */
static void deny_jump(vista_coherence *c, const vista_estimate *offset_px) {
  if (fabs(offset_px->value) + 2.0 * offset_px->sigma < JUMP_SHARE * fabs(c->jump_px)) c->jump_px = 0.0;
}

static void tell(const vista_coherence *c, vista_coherence_result *r) {
  double value[LASTING], covariance[LASTING][LASTING], velocity[3][3];
  r->offset_px.sigma = r->velocity_m_s.sigma = INFINITY;
  if (!known(c, value, covariance)) return;
  for (int i = 0; i < 3; ++i) memcpy(velocity[i], covariance[i], sizeof velocity[i]);
  r->offset_px = (vista_estimate){value[3], sqrt(covariance[3][3])};
  if (!vista_symmetric_invert(3, velocity[0])) return;
  double square = 0.0;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) square += value[i] * velocity[i][j] * value[j];
  /* The error along the one that is found. */
  r->velocity_m_s.value = vista_norm(value);
  r->velocity_m_s.sigma = r->velocity_m_s.value / fmax(sqrt(square), 1e-9);
}

/* Begins the turn of a frame with what its pose says. */
static void begin_turn(vista_coherence *c, const vista_pose *now) {
  memmove(&c->turns[1], &c->turns[0], (TURNS - 1) * sizeof c->turns[0]);
  c->turns[0] = (vista_coherent_turn){0};
  double across[3][3] = {{0}}; /* the camera before, in the camera now */
  for (int k = 0; k < 3; ++k) {
    const double world[3] = {c->pose.rotation[k], c->pose.rotation[3 + k], c->pose.rotation[6 + k]};
    vista_frame_direction_to_camera(now, world, across[k]);
  }
  for (int k = 0; k < 3; ++k) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    c->turns[0].posed_rad[k] = 0.5 * (across[i][j] - across[j][i]);
  }
  if (c->turned < TURNS) ++c->turned;
}

/* The squared distance, in their errors, of what the newest images show from the turns that the poses had `late` frames
 * before, and from those of their own frames; returns how many frames tell. */
static int32_t distances_of(const vista_coherence *c, int32_t late, double *shifted, double *own) {
  int32_t count = 0;
  *shifted = *own = 0.0;
  for (int32_t k = late < 0 ? -late : 0; k < c->turned && k + late < c->turned && count < LATE_OVER; ++k) {
    const vista_coherent_turn *const turn = &c->turns[k];
    if (!turn->shown) continue;
    ++count;
    const double weight = 1.0 / (vista_square(LATE_TURN_RAD) + vista_square(turn->sigma_rad));
    for (int i = 0; i < 3; ++i) {
      *shifted += weight * vista_square(turn->shown_rad[i] - c->turns[k + late].posed_rad[i]);
      *own += weight * vista_square(turn->shown_rad[i] - turn->posed_rad[i]);
    }
  }
  return count;
}

/* By how many frames the images are late against the poses, if what they show is far from the turns of their own poses and
 * near to those of others; else 0. */
static int32_t lateness_of(const vista_coherence *c) {
  int32_t late = 0;
  double least = LATE_SHARE;
  for (int32_t n = -LATE_MOST; n <= LATE_MOST; ++n) {
    double shifted, own;
    if (n == 0 || distances_of(c, n, &shifted, &own) < LATE_FEWEST || own < LATE_SQUARE) continue;
    if (shifted < least * own) late = n, least = shifted / own;
  }
  return late;
}

/* Finds the points of the frame before in this one. */
static void find(const vista_coherence *c, const vista_level *before, const vista_level *after, const vista_pose *now,
                 observation seen[VISTA_COHERENCE_POINTS], vista_coherence_result *r) {
  r->points = c->count;
  for (int32_t k = 0; k < c->count; ++k) {
    const vista_coherent_point *const p = &c->points[k];
    double at_px[2], camera_m[3], ray_m[3];
    if (!predict(c, p, now, at_px, camera_m, ray_m)) continue;
    ++r->asked;
    vista_place place = {.u0 = p->u0, .v0 = p->v0, .du = (float)(0.5 * at_px[0]), .dv = (float)(0.5 * at_px[1])};
    if (!vista_place_refine(before, after, &place)) continue;
    const double left_px[2] = {2.0 * (double)place.du - at_px[0], 2.0 * (double)place.dv - at_px[1]};
    observation *const o = &seen[r->found++];
    *o = observe(c, p, camera_m, ray_m, left_px, 2.0 * (double)place.sigma_v);
    o->u_px = 2 * (int32_t)lround(place.u0 + (double)place.du);
    o->v_px = 2 * (int32_t)lround(place.v0 + (double)place.dv);
  }
}

static void compare(vista_coherence *c, const vista_level *before, const vista_level *after, const int16_t *words,
                    const vista_motion *motion, int64_t t_ns, vista_coherence_result *r) {
  observation seen[VISTA_COHERENCE_POINTS];
  find(c, before, after, &motion->pose, seen, r);
  double x[UNKNOWNS], covariance[UNKNOWNS][UNKNOWNS], squares = 0.0;
  const bool many = r->found >= FEWEST && fit(seen, r->found, x, covariance);
  for (int32_t k = 0; k < r->found && many; ++k) {
    const double sigmas = sigmas_of(&seen[k], x);
    if (sigmas < SIGMAS) ++r->agreeing, squares += 0.5 * sigmas * sigmas;
  }
  r->fitted = many && r->agreeing >= FEWEST && 2 * r->agreeing >= r->found;
  const double jump_px = jump_of(c, seen, r->found, words);
  if (jump_px != 0.0) {
    c->jump_px = fabs(c->jump_px + jump_px) > JUMP_PX ? c->jump_px + jump_px : 0.0;
    forget_what_lasts(c);
  }
  if (!r->fitted) return;
  const double scatter = fmax(1.0, squares / r->agreeing);
  for (int i = 0; i < UNKNOWNS; ++i)
    for (int j = 0; j < UNKNOWNS; ++j) covariance[i][j] *= scatter;
  for (int i = 0; i < 3; ++i) {
    r->turn_rad[i] = x[i];
    r->step_m[i] = x[3 + i];
    r->turn_sigma_rad = fmax(r->turn_sigma_rad, sqrt(covariance[i][i]));
    r->step_sigma_m = fmax(r->step_sigma_m, sqrt(covariance[3 + i][3 + i]));
    c->turns[0].shown_rad[i] = c->turns[0].posed_rad[i] + x[i];
  }
  c->turns[0].sigma_rad = r->turn_sigma_rad;
  c->turns[0].shown = true;
  if (jump_px != 0.0) return; /* this fit is of the disparities before the jump */
  double way_m[3];
  for (int i = 0; i < 3; ++i) way_m[i] = motion->pose.translation_m[i] - c->pose.translation_m[i];
  remember(c, x, covariance, vista_norm(way_m), vista_seconds_between(c->t_ns, t_ns));
}

void vista_coherence_update(vista_coherence *c, const vista_image *left, const int16_t *words,
                            const vista_motion *motion, int64_t t_ns, vista_coherence_result *result) {
  *result = (vista_coherence_result){0};
  const vista_level *const before = &c->half[c->newest], *const after = &c->half[1 - c->newest];
  vista_level_halve(left->data, left->stride, after);
  const bool posed = motion->source == VISTA_MOTION_POSE && !motion->restarted;
  if (posed && c->posed)
    begin_turn(c, &motion->pose);
  else
    c->turned = 0;
  if (posed && c->posed && c->count > 0) compare(c, before, after, words, motion, t_ns, result);
  tell(c, result);
  deny_jump(c, &result->offset_px);
  result->jump_px = c->jump_px;
  result->late = lateness_of(c);
  c->newest = 1 - c->newest;
  vista_level_halve(after->pixels, after->width_px, &c->quarter);
  c->posed = motion->source == VISTA_MOTION_POSE;
  c->pose = motion->pose;
  c->t_ns = t_ns;
  choose(c, words);
  result->chosen = c->count;
}
