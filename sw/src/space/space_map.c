#include "space/space_map.h"

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <string.h>

#include "common/frame.h"
#include "common/numbers.h"
#include "space/overhangs.h"

#define SAMPLES 20       /* lines of sight across a disc, at most, */
#define BALL_SAMPLES 12  /* and across a ball: many of them are asked for */
#define UPRIGHT_MIN 5.0  /* lines of sight to an upright line, at least, */
#define UPRIGHT_MAX 12.0 /* and at most in view */
#define UPRIGHT_MOST 48.0
#define FRACTION_BITS 16 /* of a pixel of the picture */
#define FRACTIONS 65536.0
#define IN_VIEW_MIN 12   /* lines of sight that a frame needs to tell of a place, */
#define IN_VIEW_SHARE 0.25 /* and of all that lead to it this share */
#define FIT_SHARE 0.5     /* of its depth: the radius of a ball that fits into the view; */
#define NEAREST_SHARE 0.5 /* one that is nearer than this share of its radius is beside the camera */
#define BALL_VIEW_SHARE 0.6 /* of a ball, that has to be in view: what is beside may stand in the rest of it */
#define VOTE_MIN 3.0     /* A frame votes if so many lines of sight end at the place, */
#define VOTE_SHARE 0.02  /* and this share of all. */
#define FOOT_SHARE 0.15  /* It shows a foot if this share are bounded there by the ground, */
#define FOOT_BEYOND 0.1  /* and fewer than this go on beyond. */

vista_status vista_space_map_layout(vista_space_map *map, vista_arena *arena, const vista_camera *camera) {
  map->camera = *camera;
  for (int32_t k = 0; k < VISTA_SPACE_FRAMES; ++k) vista_evidence_layout(&map->frames[k], arena, camera);
  return arena->base != NULL && arena->used > arena->size ? VISTA_ERROR_MEMORY : VISTA_OK;
}

void vista_space_map_reset(vista_space_map *map) { map->count = map->newest = map->lines.count = 0; }

const vista_evidence *vista_space_map_frame(const vista_space_map *map, int32_t age) {
  return &map->frames[(map->newest + VISTA_SPACE_FRAMES - age) % VISTA_SPACE_FRAMES];
}

static bool follows_closely(const vista_space_map *map) {
  if (map->count < 2) return false;
  return vista_seconds_between(vista_space_map_frame(map, 1)->t_ns, vista_space_map_frame(map, 0)->t_ns) <
         VISTA_SPACE_SPACING_S;
}

void vista_space_map_add(vista_space_map *map, const vista_frame_view *frame, const vista_surfaces *surfaces,
                         const vista_thin_lines *lines) {
  if (map->count == 0) {
    map->count = 1;
  } else if (!follows_closely(map)) {
    map->newest = (map->newest + 1) % VISTA_SPACE_FRAMES;
    map->count += map->count < VISTA_SPACE_FRAMES;
  }
  vista_evidence_take(frame, surfaces, &map->frames[map->newest]);
  if (map->count > 1 && frame->motion.known)
    vista_overhangs_mark(frame, vista_space_map_frame(map, map->count - 1), vista_space_map_frame(map, 1),
                         &map->frames[map->newest]);
  vista_kept_lines_add(&map->lines, frame, lines);
}

/* What was matched at a place: sums over its lines of sight, in pixels of the picture and 1/16 px. */
typedef struct matched {
  int32_t count;
  int64_t u, v, word, word2;
} matched;

static inline void add_match(matched *m, int32_t column, int32_t row, int32_t word) {
  ++m->count;
  m->u += column;
  m->v += row;
  m->word += word;
  m->word2 += (int64_t)word * word;
}

/* How the lines of sight of one frame end that lead to a disc. */
typedef struct looks {
  int32_t asked, all, beyond, overhung;
  double radius_m; /* of the disc */
  matched at, feet;
} looks;

/* The words that are at a place: 1/16 px, both included. */
typedef struct range {
  int32_t farthest, nearest;
} range;

static range range_at(double wanted_px) {
  const double tolerance_px = fmax(VISTA_SIGHT_TOLERANCE_PX, VISTA_SIGHT_TOLERANCE_SHARE * wanted_px);
  return (range){(int32_t)ceil(fmin((wanted_px - tolerance_px) * VISTA_DISPARITY_SCALE, INT16_MAX)),
                 (int32_t)floor(fmin((wanted_px + tolerance_px) * VISTA_DISPARITY_SCALE, INT16_MAX))};
}

static inline void look_at(const vista_evidence *e, range at, int32_t column, int32_t row, looks *l) {
  const ptrdiff_t i = (ptrdiff_t)row * e->width + column;
  const uint8_t kind = e->kind[i];
  const vista_sight_says says = vista_evidence_says(e, i, at.farthest, at.nearest);
  l->all += kind != VISTA_SIGHT_OUTSIDE;
  l->overhung += kind == VISTA_SIGHT_OVERHANG;
  l->beyond += says == VISTA_SIGHT_GOES_ON;
  if (says == VISTA_SIGHT_ENDS)
    add_match(&l->at, column, row, e->word[i]);
  else if (says == VISTA_SIGHT_AT_FOOT)
    add_match(&l->feet, column, row, e->word[i]);
}

/* Where lines of sight to a disc pass the picture, along one of its axes: the middles of as many equal parts. */
typedef struct axis {
  int32_t count, first, beyond; /* those from `first` on and before `beyond` pass it */
  int32_t at[SAMPLES];
} axis;

static axis axis_of(double middle, double reach, double step, int32_t size) {
  axis a = {0};
  const double least = middle - reach + 0.5 * step;
  for (double at = least; at < middle + reach && a.count < SAMPLES; at = least + a.count * step) {
    a.first += at < -0.5;
    a.beyond += at < size - 0.5;
    a.at[a.count++] = (int32_t)(at + 0.5);
  }
  return a;
}

/* The lines of sight of a row that lead to the disc: from `first` on and before `beyond`. */
typedef struct span {
  int32_t first, beyond;
} span;

/* reach: of the disc, in steps; count: lines of sight across it. */
static void take_spans(double reach, int32_t count, span spans[SAMPLES]) {
  for (int32_t k = 0; k < count; ++k) {
    const double half = sqrt(fmax(vista_square(reach) - vista_square(k + 0.5 - reach), 0.0));
    spans[k] = (span){(int32_t)ceil(reach - half - 0.5), (int32_t)ceil(reach + half - 0.5)};
  }
}

/* The words that are no farther from a depth than that, both included. */
static range range_around(const vista_camera *camera, double depth_m, double deep_m) {
  const double scale = camera->focal_px * camera->baseline_m;
  range at = range_at(scale / depth_m);
  if (!(deep_m > 0.0)) return at;
  at.farthest = range_at(scale / (depth_m + deep_m)).farthest;
  at.nearest = deep_m < depth_m ? range_at(scale / (depth_m - deep_m)).nearest : INT16_MAX;
  return at;
}

/* wide: the spans of a disc that more than `samples` lines of sight would lead to. */
static looks look_through(const vista_evidence *e, const vista_camera *camera, const double point_m[3], double radius_m,
                          double deep_m, int32_t samples, const span wide[SAMPLES]) {
  looks l = {0};
  double c[3];
  vista_frame_to_camera(&e->pose, point_m, c);
  if (deep_m > 0.0 && c[2] > NEAREST_SHARE * radius_m) radius_m = fmin(radius_m, FIT_SHARE * c[2]);
  l.radius_m = radius_m;
  if (!(c[2] > radius_m)) return l; /* the camera is in it, or beyond it */
  const double scale = camera->focal_px / c[2];
  const double u = (camera->center_u_px + scale * c[0]) / e->step_px;
  const double v = (camera->center_v_px + scale * c[1]) / e->step_px, reach = scale * radius_m / e->step_px;
  if (!(u + reach >= 0.0 && u - reach < e->width && v + reach >= 0.0 && v - reach < e->height)) return l;
  const bool is_wide = 2.0 * reach > samples;
  const double step = is_wide ? 2.0 * reach / samples : 1.0;
  const axis columns = axis_of(u, reach, step, e->width), rows = axis_of(v, reach, step, e->height);
  const range at = range_around(camera, c[2], deep_m);
  span narrow[SAMPLES];
  if (!is_wide) take_spans(reach, rows.count, narrow);
  const span *const spans = is_wide ? wide : narrow;
  for (int32_t y = 0; y < rows.count; ++y) {
    l.asked += spans[y].beyond - spans[y].first;
    if (y < rows.first || y >= rows.beyond) continue;
    const int32_t from = spans[y].first > columns.first ? spans[y].first : columns.first;
    const int32_t to = spans[y].beyond < columns.beyond ? spans[y].beyond : columns.beyond;
    for (int32_t x = from; x < to; ++x) look_at(e, at, columns.at[x], rows.at[y], &l);
  }
  return l;
}

static looks look_along(const vista_evidence *e, const vista_camera *camera, const vista_upright *line) {
  looks l = {0};
  double middle[3], up[3];
  vista_frame_to_camera(&e->pose, line->middle_m, middle);
  if (!(middle[2] > line->half_m)) return l;
  vista_frame_direction_to_camera(&e->pose, line->up, up);
  double first[2], step[2];
  const double low = camera->focal_px / ((middle[2] - line->half_m * up[2]) * e->step_px);
  const double high = camera->focal_px / ((middle[2] + line->half_m * up[2]) * e->step_px);
  const double center[2] = {camera->center_u_px / e->step_px, camera->center_v_px / e->step_px};
  for (int i = 0; i < 2; ++i) {
    first[i] = center[i] + low * (middle[i] - line->half_m * up[i]);
    step[i] = center[i] + high * (middle[i] + line->half_m * up[i]) - first[i];
  }
  const double across = fmax(fabs(step[0]), fabs(step[1])), most = UPRIGHT_MAX * fmax(across / e->height, 1.0);
  l.asked = (int32_t)fmin(fmax(across, UPRIGHT_MIN), fmin(most, UPRIGHT_MOST));
  const range at = range_at(camera->focal_px * camera->baseline_m / middle[2]);
  int64_t place[2], stride[2];
  for (int i = 0; i < 2; ++i) {
    stride[i] = (int64_t)(FRACTIONS * step[i] / l.asked);
    place[i] = (int64_t)(FRACTIONS * (first[i] + 0.5)) + stride[i] / 2;
  }
  for (int32_t k = 0; k < l.asked; ++k, place[0] += stride[0], place[1] += stride[1]) {
    const int64_t column = place[0] >> FRACTION_BITS, row = place[1] >> FRACTION_BITS;
    if (column >= 0 && column < e->width && row >= 0 && row < e->height)
      look_at(e, at, (int32_t)column, (int32_t)row, &l);
  }
  return l;
}

static void place_at(vista_place_evidence *found, const vista_evidence *e, const matched *m, int32_t age) {
  const double count = m->count, word = (double)m->word / count;
  found->u_px = (double)m->u / count * e->step_px;
  found->v_px = (double)m->v / count * e->step_px;
  found->disparity_px = word / VISTA_DISPARITY_SCALE;
  found->spread_px = sqrt(fmax((double)m->word2 / count - word * word, 0.0)) / VISTA_DISPARITY_SCALE;
  found->age = age;
}

/* Adds what a frame of this age shows: it votes, it shows a foot, or it sees through. */
static void take_looks(vista_place_evidence *found, const vista_evidence *e, const looks *l, int32_t age) {
  const double beyond = (double)l->beyond / l->all;
  const bool votes = l->at.count >= fmax(VOTE_MIN, VOTE_SHARE * l->all);
  const bool foot = l->feet.count >= FOOT_SHARE * l->all && beyond < FOOT_BEYOND;
  if (votes && found->votes == 0) place_at(found, e, &l->at, age);
  if (foot && found->disparity_px == 0.0) place_at(found, e, &l->feet, age);
  const double overhung = (double)l->overhung / l->all;
  if (found->frames == 0) {
    found->beyond_newest = beyond;
    found->overhung = overhung;
    found->radius_m = l->radius_m;
  }
  if (found->frames == 1) found->overhung = fmin(found->overhung, overhung);
  ++found->frames;
  found->votes += votes;
  found->feet += foot;
  found->beyond += (beyond - found->beyond) / found->frames;
}

/* Adds the thin things that pass through a place. from_m: where it is flown to from, which makes it as deep as it is wide;
 * null: it is as deep as the map can tell. */
static void take_lines(const vista_space_map *map, const double point_m[3], double radius_m, const double *from_m,
                       vista_place_evidence *found) {
  if (map->lines.count == 0) return;
  const vista_evidence *const newest = vista_space_map_frame(map, 0);
  const vista_camera *const camera = &map->camera;
  vista_kept_ball ball = {.radius_m = radius_m, .deep_m = radius_m, .from_m = from_m};
  memcpy(ball.point_m, point_m, sizeof ball.point_m);
  memcpy(ball.camera_m, newest->pose.translation_m, sizeof ball.camera_m);
  const double range_m = vista_distance(point_m, ball.camera_m);
  if (from_m == NULL)
    ball.deep_m = range_m * fmax(VISTA_SIGHT_TOLERANCE_SHARE,
                                 VISTA_SIGHT_TOLERANCE_PX * range_m / (camera->focal_px * camera->baseline_m));
  double at_m[3], camera_m[3], at_px[3];
  found->lines = vista_kept_lines_frames(&map->lines, &ball, at_m);
  if (found->lines == 0 || found->disparity_px > 0.0) return;
  vista_frame_to_camera(&newest->pose, at_m, camera_m);
  if (!(camera_m[2] > camera->baseline_m)) return;
  vista_frame_measure(camera, camera_m, at_px, NULL);
  found->u_px = at_px[0];
  found->v_px = at_px[1];
  found->disparity_px = at_px[2];
  found->age = 0;
}

static vista_place_evidence look(const vista_space_map *map, const double point_m[3], double radius_m,
                                 const double *from_m) {
  const double deep_m = from_m == NULL ? 0.0 : radius_m;
  const int32_t samples = from_m == NULL ? SAMPLES : BALL_SAMPLES;
  span wide[SAMPLES];
  take_spans(0.5 * samples, samples, wide);
  vista_place_evidence found = {0};
  for (int32_t age = 0; age < map->count; ++age) {
    const vista_evidence *const e = vista_space_map_frame(map, age);
    const looks l = look_through(e, &map->camera, point_m, radius_m, deep_m, samples, wide);
    if (l.all >= IN_VIEW_MIN && l.all >= (deep_m > 0.0 ? BALL_VIEW_SHARE : IN_VIEW_SHARE) * l.asked)
      take_looks(&found, e, &l, age);
  }
  take_lines(map, point_m, radius_m, from_m, &found);
  return found;
}

vista_place_evidence vista_space_map_look(const vista_space_map *map, const double point_m[3], double radius_m) {
  return look(map, point_m, radius_m, NULL);
}

vista_place_evidence vista_space_map_look_around(const vista_space_map *map, const double point_m[3], double radius_m,
                                                 const double from_m[3]) {
  return look(map, point_m, radius_m, from_m);
}

vista_place_evidence vista_space_map_look_upright(const vista_space_map *map, const vista_upright *line,
                                                  int32_t frames) {
  vista_place_evidence found = {0};
  for (int32_t age = 0; age < map->count && age < frames; ++age) {
    const vista_evidence *const e = vista_space_map_frame(map, age);
    const looks l = look_along(e, &map->camera, line);
    if (l.all >= VOTE_MIN)
      take_looks(&found, e, &l, age);
    else if (age == 0)
      return found;
  }
  take_lines(map, line->middle_m, line->half_m, NULL, &found);
  return found;
}

void vista_space_map_matched(const vista_space_map *map, const vista_place_evidence *shown, double point_m[3]) {
  const double measured_px[3] = {shown->u_px, shown->v_px, shown->disparity_px};
  double camera_m[3];
  vista_frame_point(&map->camera, measured_px, camera_m);
  vista_frame_to_world(&vista_space_map_frame(map, shown->age)->pose, camera_m, point_m);
}
