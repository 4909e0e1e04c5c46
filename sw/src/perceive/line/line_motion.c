#include "perceive/line/line_motion.h"

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "common/frame.h"
#include "common/numbers.h"
#include "common/wide_vectors.h"
#include "perceive/line/straight_lines.h"

#define VIEWS_MIN 3 /* that are kept */
#define DEPTH_MIN 0.05f /* in a view, per depth here: what is nearer is beside it or behind */
#define HYPOTHESES 64
#define SAMPLES_MAX 500 /* of the lines that are looked for together */
#define SHIFT_MIN_PX 8.0 /* of the line in the view that shows most, over all hypotheses */
#define SHIFT_STEP_PX 1.0 /* there, from one hypothesis to the next: half as wide as the thinnest line */
#define SNAP_PX 2 /* a line of the image may be off the ridge it is of */
#define AGAINST 2 /* the most that a view without a line there counts against it */
#define BOX 4 /* samples that are judged together */
#define OWN_MIN 1.5 /* grey levels: a line that is fainter is not looked for */
#define SCORE_MIN 0.35 /* of the line's own contrast, mean of the views */
#define ON_SURFACE 0.5 /* the same, at the disparity of what is beside: such a line is of that */
#define AROUND 3 /* disparities there: with one a step nearer, and one a step farther */
#define SURFACE_POINTS 10 /* of it that tell, about */
#define PEAK_SHARE 0.8 /* Hypotheses that have this share of the best score */
#define PEAK_STEPS 4 /* lie no farther apart than this. */

/* A sample: where it is, its line of sight at depth 1, and the contrast of the line there, with its sign. */
typedef struct vista_line_point {
  float t_px, sight[3];
  int32_t own;
} vista_line_point;

void vista_line_motion_layout(vista_line_motion *motion, vista_arena *arena, int32_t width_px, int32_t height_px) {
  const size_t most = VISTA_MOTION_SAMPLES;
  vista_past_views_layout(&motion->views, arena, width_px, height_px);
  motion->points = vista_arena_take(arena, most, sizeof *motion->points);
  motion->beside_px = vista_arena_take(arena, most, sizeof *motion->beside_px);
  motion->score = vista_arena_take(arena, most * HYPOTHESES, sizeof *motion->score);
  motion->seen = vista_arena_take(arena, most * HYPOTHESES, sizeof *motion->seen);
}

void vista_line_motion_begin(vista_line_motion *motion) { motion->samples_left = SAMPLES_MAX; }

/* The ridge at a pixel, upright or flat; 0 at the rim. */
static int32_t ridge_at(const vista_image *image, bool flat, int32_t u, int32_t v) {
  const int32_t reach = VISTA_RIDGE_REACH;
  if (u < reach || u >= image->width_px - reach || v < reach || v >= image->height_px - reach) return 0;
  const uint8_t *const pixel = image->data + v * image->stride + u;
  const ptrdiff_t side = reach * (flat ? image->stride : 1);
  return vista_past_view_ridge(pixel[-side], *pixel, pixel[side]);
}

/* Whether a line is told by the rows above and below it, and not by the columns beside it. */
static bool lies_flat(const vista_thin_line *line) { return line->flat || fabs(line->slope) > 1.0; }

static int32_t take_points(const vista_frame_view *frame, const vista_thin_line *line, vista_line_motion *motion) {
  const vista_camera *const camera = frame->camera;
  const bool flat = lies_flat(line);
  int32_t count = 0;
  for (int32_t t = vista_moved_sample_px(line, 0); t <= line->last_px && count < VISTA_MOTION_SAMPLES;
       t = vista_moved_sample_px(line, count)) {
    double at_px[2] = {vista_thin_u_px(line, t), vista_thin_v_px(line, t)};
    const int32_t column = (int32_t)lround(at_px[0]), row = (int32_t)lround(at_px[1]);
    int32_t own = 0, sum = 0, moment = 0;
    for (int32_t k = -SNAP_PX; k <= SNAP_PX; ++k) {
      const int32_t here = ridge_at(&frame->image, flat, column + (flat ? 0 : k), row + (flat ? k : 0));
      if (abs(here) > abs(own)) own = here;
      sum += abs(here);
      moment += k * abs(here);
    }
    at_px[flat] = (flat ? row : column) + (double)moment / (sum > 0 ? sum : 1);
    motion->points[count++] = (vista_line_point){
        .t_px = (float)t,
        .sight = {(float)((at_px[0] - camera->center_u_px) / camera->focal_px),
                  (float)((at_px[1] - camera->center_v_px) / camera->focal_px), 1.0f},
        .own = own,
    };
  }
  return count;
}

/* From the camera of the frame into that of a past view: p = turn sight + inverse depth * offset_m. */
typedef struct passage {
  float turn[9], offset_m[3];
  bool flat;       /* how the line lies there, and */
  float across[2]; /* the unit vector across it, if it is far away */
} passage;

static void turned(const passage *p, const float sight[3], float out[3]) {
  for (int i = 0; i < 3; ++i)
    out[i] = p->turn[3 * i] * sight[0] + p->turn[3 * i + 1] * sight[1] + p->turn[3 * i + 2] * sight[2];
}

/* Where a point lies in a view, at depth 1; false: beside it or behind. */
static bool place_in(const passage *p, const vista_line_point *point, double inverse_m, double at[2]) {
  float far[3];
  turned(p, point->sight, far);
  const double depth = far[2] + inverse_m * p->offset_m[2];
  for (int i = 0; i < 2; ++i) at[i] = (far[i] + inverse_m * p->offset_m[i]) / depth;
  return depth > DEPTH_MIN;
}

static passage passage_to(const vista_pose *past, const vista_pose *now, const vista_line_point *first,
                          const vista_line_point *last) {
  passage p;
  double offset_m[3], from[2], to[2];
  vista_frame_to_camera(past, now->translation_m, offset_m);
  for (int i = 0; i < 3; ++i) {
    p.offset_m[i] = (float)offset_m[i];
    for (int k = 0; k < 3; ++k) {
      double sum = 0.0;
      for (int m = 0; m < 3; ++m) sum += past->rotation[3 * m + i] * now->rotation[3 * m + k];
      p.turn[3 * i + k] = (float)sum;
    }
  }
  (void)place_in(&p, first, 0.0, from);
  (void)place_in(&p, last, 0.0, to);
  const double right = to[0] - from[0], down = to[1] - from[1], length = fmax(hypot(right, down), 1e-9);
  p.flat = fabs(right) > fabs(down);
  p.across[0] = (float)(-down / length);
  p.across[1] = (float)(right / length);
  return p;
}

/* How far a point moves in a view, in pixels across the line, between no disparity and one with this inverse depth. */
static double shift_px(const vista_camera *camera, const passage *p, const vista_line_point *point, double inverse_m) {
  double far[2], near[2];
  if (!place_in(p, point, 0.0, far) || !place_in(p, point, inverse_m, near)) return 0.0;
  return fabs(camera->focal_px * (p->across[0] * (near[0] - far[0]) + p->across[1] * (near[1] - far[1])));
}

/* Some hypotheses of the inverse depth: from the first one on, so far apart. */
typedef struct hypotheses {
  float first_m, step_m;
  int32_t count;
} hypotheses;

/* The pixels of a view in which a point lies, for each hypothesis; -1: outside. */
VISTA_WIDE_VECTORS static void place(const passage *p, const vista_camera *camera, const float sight[3],
                                     hypotheses asked, int32_t *restrict pixel) {
  float far[3];
  turned(p, sight, far);
  const int32_t row_px = camera->width_px;
  const float right = far[0], down = far[1], ahead = far[2], right_m = p->offset_m[0], down_m = p->offset_m[1],
              ahead_m = p->offset_m[2], focal = (float)camera->focal_px, cu = (float)camera->center_u_px + 0.5f,
              cv = (float)camera->center_v_px + 0.5f, width = (float)camera->width_px,
              height = (float)camera->height_px;
  for (int32_t h = 0; h < asked.count; ++h) {
    const float inverse_m = asked.first_m + (float)h * asked.step_m, z = ahead + inverse_m * ahead_m;
    const float scale = focal / vista_larger(z, DEPTH_MIN);
    const float u = cu + scale * (right + inverse_m * right_m), v = cv + scale * (down + inverse_m * down_m);
    const int32_t inside = (z > DEPTH_MIN) & (u >= 0.0f) & (u < width) & (v >= 0.0f) & (v < height);
    const int32_t column = (int32_t)vista_larger(vista_smaller(u, width - 1.0f), 0.0f);
    const int32_t row = (int32_t)vista_larger(vista_smaller(v, height - 1.0f), 0.0f);
    pixel[h] = inside * (row * row_px + column + 1) - 1;
  }
}

/* Adds what a view shows at the pixels of a point: as strong a line as the point's own at most. */
VISTA_WIDE_VECTORS static void add_shown(const int16_t *restrict there, const int32_t *restrict pixel, int16_t own,
                                         int32_t count, int16_t *restrict score, int16_t *restrict seen) {
  const int16_t size = (int16_t)(own < 0 ? -own : own), sign = (int16_t)(own < 0 ? -1 : 1);
  for (int32_t h = 0; h < count; ++h) {
    const int16_t inside = (int16_t)(pixel[h] >= 0), same = (int16_t)(sign * there[h]);
    const int16_t most = same > size ? size : same, shown = (int16_t)(most < -AGAINST ? -AGAINST : most);
    score[h] = (int16_t)(score[h] + inside * shown);
    seen[h] = (int16_t)(seen[h] + inside);
  }
}

/* Adds what a past view says of the hypotheses of a point. */
static void look_at(const vista_past_view *view, const passage *p, const vista_camera *camera,
                    const vista_line_point *point, hypotheses asked, int16_t *restrict score, int16_t *restrict seen) {
  const int8_t *restrict const ridge = view->ridge[p->flat];
  int32_t pixel[HYPOTHESES];
  int16_t there[HYPOTHESES];
  place(p, camera, point->sight, asked, pixel);
  for (int32_t h = 0; h < asked.count; ++h) there[h] = ridge[pixel[h] < 0 ? 0 : pixel[h]];
  add_shown(there, pixel, (int16_t)point->own, asked.count, score, seen);
}

/* Whether the line is of what is matched beside it, as most lines are, give or take a step of disparity: the views show
 * it where it is then. beside_px: of all samples; some of them are enough. */
static bool lies_on_surface(const vista_line_motion *motion, const passage *passages, const vista_camera *camera,
                            const float *beside_px, int32_t count, double step_px, double per_px_m) {
  const vista_past_views *const views = &motion->views;
  int32_t shown[AROUND] = {0}, full[AROUND] = {0};
  for (int32_t k = 0; k < count; k += 1 + count / SURFACE_POINTS) {
    const vista_line_point *const point = &motion->points[k];
    const double first_px = fmax((double)beside_px[k] - step_px, 0.0);
    const hypotheses asked = {(float)(first_px * per_px_m), (float)(step_px * per_px_m), AROUND};
    int16_t score[AROUND] = {0}, seen[AROUND] = {0};
    for (int32_t i = 0; i < views->count && beside_px[k] >= 0.0f; ++i)
      look_at(&views->items[i], &passages[i], camera, point, asked, score, seen);
    for (int h = 0; h < AROUND; ++h) {
      shown[h] += score[h];
      full[h] += abs(point->own) * (beside_px[k] < 0.0f ? views->count : seen[h]);
    }
  }
  for (int h = 0; h < AROUND; ++h)
    if (full[h] > 0 && shown[h] > ON_SURFACE * full[h]) return true;
  return false;
}

/* The share of the line's own contrast that the views show where a hypothesis has the samples of a box; negative: too
 * few views hold them. */
static double score_of(const vista_line_motion *motion, int32_t h, int32_t first, int32_t end, int32_t own) {
  int32_t score = 0, seen = 0;
  for (int32_t k = first; k < end; ++k) {
    score += motion->score[k * HYPOTHESES + h];
    seen += motion->seen[k * HYPOTHESES + h];
  }
  return seen < 2 * (end - first) ? -1.0 : (double)score * (end - first) / ((double)seen * own);
}

/* The disparity of the samples around one, in steps: the middle of the hypotheses that score best; negative: none stands
 * out. */
static double best_of(const vista_line_motion *motion, int32_t steps, int32_t k, int32_t count) {
  const int32_t first = k < BOX / 2 ? 0 : k - BOX / 2, end = k + BOX / 2 > count ? count : k + BOX / 2;
  int32_t own = 0, best = -1;
  for (int32_t i = first; i < end; ++i) own += abs(motion->points[i].own);
  if (own < OWN_MIN * (end - first)) return -1.0;
  double scores[HYPOTHESES], highest = SCORE_MIN;
  for (int32_t h = 0; h < steps; ++h) {
    scores[h] = score_of(motion, h, first, end, own);
    if (scores[h] > highest) highest = scores[h], best = h;
  }
  double sum = 0.0, moment = 0.0;
  for (int32_t h = 0; h < steps && best >= 0; ++h) {
    if (!(scores[h] > PEAK_SHARE * highest)) continue;
    if (abs(h - best) > PEAK_STEPS) return -1.0;
    sum += scores[h];
    moment += h * scores[h];
  }
  return best < 0 ? -1.0 : moment / sum;
}

/* How far the line moves in the view that shows the most of it, over all disparities up to this one. */
static double most_shift_px(const vista_camera *camera, const passage *passages, double inverse_m, int32_t count,
                            const vista_line_motion *motion) {
  double most = 0.0;
  for (int32_t i = 0; i < motion->views.count; ++i)
    for (int32_t k = 0; k < count; k += count / 2)
      most = fmax(most, shift_px(camera, &passages[i], &motion->points[k], inverse_m));
  return most;
}

vista_moved_samples vista_line_motion_samples(const vista_frame_view *frame, const vista_thin_line *line,
                                              const float *beside_px, vista_line_motion *motion,
                                              vista_line_sample *samples) {
  const vista_camera *const camera = frame->camera;
  const vista_past_views *const views = &motion->views;
  vista_moved_samples found = {0};
  if (views->count < VIEWS_MIN || !frame->motion.known) return found;
  const int32_t count = take_points(frame, line, motion);
  if (count < BOX) return found;
  passage passages[VISTA_PAST_VIEWS];
  for (int32_t i = 0; i < views->count; ++i)
    passages[i] =
        passage_to(&views->items[i].pose, &frame->motion.pose, &motion->points[0], &motion->points[count - 1]);
  const double per_px_m = 1.0 / (camera->focal_px * camera->baseline_m); /* inverse depth of a pixel of disparity */
  const double most_px = vista_matched_finest_px(&frame->matched);
  const double shift = most_shift_px(camera, passages, most_px * per_px_m, count, motion);
  if (shift < SHIFT_MIN_PX) return found;
  const int32_t steps = (int32_t)fmin(ceil(shift / SHIFT_STEP_PX) + 1.0, HYPOTHESES);
  found.step_px = most_px / (steps - 1);
  found.per_px = most_px / shift;
  if (count > motion->samples_left ||
      lies_on_surface(motion, passages, camera, beside_px, count, found.step_px, per_px_m))
    return found;
  motion->samples_left -= count;
  found.asked = count;
  memset(motion->score, 0, (size_t)count * HYPOTHESES * sizeof *motion->score);
  memset(motion->seen, 0, (size_t)count * HYPOTHESES * sizeof *motion->seen);
  const hypotheses asked = {0.0f, (float)(found.step_px * per_px_m), steps};
  for (int32_t i = 0; i < views->count; ++i)
    for (int32_t k = 0; k < count; ++k)
      look_at(&views->items[i], &passages[i], camera, &motion->points[k], asked,
              motion->score + (ptrdiff_t)k * HYPOTHESES, motion->seen + (ptrdiff_t)k * HYPOTHESES);
  for (int32_t k = 0; k < count; ++k) {
    const double best = best_of(motion, steps, k, count);
    if (best < 0.0) continue;
    samples[found.count++] = (vista_line_sample){motion->points[k].t_px, (float)(best * found.step_px)};
  }
  return found;
}
