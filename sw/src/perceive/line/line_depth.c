#include "perceive/line/line_depth.h"

#include <math.h>
#include <stdint.h>

#include "common/numbers.h"
#include "perceive/scales.h"
#include "vista/word.h"

#define AGREE_PX 0.6 /* such words agree with a straight line in space within this */
#define AGREE_SHARE 0.7 /* least of these words that agree */
#define ROWS_MIN 24 /* whose words agree */
#define ROW_SHARE 0.1 /* least of the line's rows whose words agree */
/* Least of the rows with any word on the line whose words agree; the others are of what is behind. */
#define WORD_SHARE 0.27
#define ROWS_SURE 40 /* so many rows whose words agree are enough, whatever share that is */
/* Most of the line's rows that have something beside it as near as itself: on a surface it is no thing of its own. */
#define LEVEL_SHARE 0.25
#define LENGTH_MIN_M 1.5 /* of a line */
#define HEIGHT_M 0.5 /* more than half of a line stands at least this far above the ground */
#define PROPOSALS 64
#define LEVER_PX 16.0 /* at least, between the two rows of a proposal */
#define PREFILTER_PX 1 /* by which the Sobel mask widens the block */
#define CLEAR_PX 4.0 /* between what a block at a side sees and the middle of the line, and to the second word there */
#define ASIDE_PX 2 /* a word may lie so far beside the line */
#define END_ROWS 4 /* whose words agree at each end of a line */
#define END_ODDS 3.0 /* natural logarithm: beyond, words would be of the line if it went on */
#define BIAS_PX 0.15 /* error of all words of a line */
#define ROW_ERROR_PX 0.1 /* by which the rows of the two images are off */
#define LEAN_MAX 10.0 /* columns per row: words say nothing of a line that is flatter */
#define MOVED_MIN 10 /* samples by the camera's motion that agree, */
#define MOVED_SHARE 0.25 /* and their least share of all that were asked for */
#define MOVED_STEPS 1.1 /* steps between hypotheses within which they agree */
#define APART_SIGMAS 2.0 /* of such a disparity, by which the line is nearer than what is beside it */
#define STEP_ERROR 0.3 /* of a step: a rounded number's standard deviation */
#define POSE_ERROR_PX 0.5 /* by which poses and ridges are off in the image, along a whole line */

/* What the loops over the rows share. */
typedef struct reading {
  const vista_line_view *view;
  const vista_thin_line *line;
  double side_px; /* along the row to where a block no longer holds the line */
  double apart_px; /* of disparity: what is beside the line and farther by less is as near as the line */
} reading;

/* Negative without one. */
static double word_at(const vista_line_view *view, const vista_thin_line *line, int32_t across, int32_t along) {
  const vista_disparity_image *const words = &view->frame->levels[0];
  const int32_t u = line->flat ? along : across, v = line->flat ? across : along;
  if (u < 0 || u >= words->width_px || v < 0 || v >= words->height_px) return -1.0;
  const int16_t word = words->data[v * words->stride + u];
  return word < 0 ? -1.0 : (double)word / VISTA_DISPARITY_SCALE;
}

/* The nearest of the words beside the line; negative without any. */
static double beside(const reading *r, int32_t t) {
  const double across = vista_thin_across_px(r->line, t);
  double nearest = -1.0;
  for (int side = -1; side <= 1; side += 2)
    for (int k = 0; k < 2; ++k)
      nearest =
          fmax(nearest, word_at(r->view, r->line, (int32_t)lround(across + side * (r->side_px + k * CLEAR_PX)), t));
  return nearest;
}

/* Negative without one; `apart`: nearer than what is beside it. */
static double on_line(const reading *r, int32_t t, double side, bool *apart) {
  const int32_t across = (int32_t)lround(vista_thin_across_px(r->line, t));
  const int32_t places[3] = {across, across - ASIDE_PX, across + ASIDE_PX};
  double any = -1.0;
  *apart = false;
  for (int k = 0; k < 3 && !*apart; ++k) {
    const double word = word_at(r->view, r->line, places[k], t);
    if (word <= 0.0) continue;
    *apart = side < 0.0 || word >= side + r->apart_px;
    if (*apart || any < 0.0) any = word;
  }
  return any;
}

/* Rows that agree with d = at + slope (v - t0). */
static int32_t agreeing(const vista_line_sample *samples, int32_t count, float t0, float at, float slope, float reach) {
  int32_t on = 0;
  for (int32_t i = 0; i < count; ++i)
    on += fabsf(samples[i].disparity_px - at - slope * (samples[i].t_px - t0)) <= reach;
  return on;
}

/* The proposal that most samples agree with; the two of each are chosen by a fixed sequence. */
static int32_t propose(const vista_line_sample *samples, int32_t count, float t0, float reach, float *at,
                       float *slope) {
  uint32_t random = 1;
  int32_t most = 0;
  for (int k = 0; k < PROPOSALS; ++k) {
    random = random * 1664525u + 1013904223u;
    /* NOLINTNEXTLINE(clang-analyzer-core.DivideZero): whoever asks has ROWS_MIN of them */
    const vista_line_sample *const a = &samples[(random >> 8) % (uint32_t)count];
    random = random * 1664525u + 1013904223u;
    const vista_line_sample *const b = &samples[(random >> 8) % (uint32_t)count];
    if (fabsf(a->t_px - b->t_px) < (float)LEVER_PX) continue;
    const float g = (b->disparity_px - a->disparity_px) / (b->t_px - a->t_px);
    const float d = a->disparity_px + g * (t0 - a->t_px);
    const int32_t on = agreeing(samples, count, t0, d, g, reach);
    if (on <= most) continue;
    most = on;
    *at = d;
    *slope = g;
  }
  return most;
}

/* Columns that the line passes from one row to the next. */
static double columns_per_row(const vista_thin_line *line) { return line->flat ? 1.0 / line->slope : line->slope; }

/* Least squares over the samples that agree with what *found says; their number. */
static int32_t refine(const vista_line_view *view, int32_t count, double reach, vista_thin_line *found) {
  const vista_line_sample *const samples = view->samples;
  const double middle = vista_thin_middle_px(found);
  double n = 0.0, t = 0.0, d = 0.0, tt = 0.0, td = 0.0, dd = 0.0;
  for (int32_t i = 0; i < count; ++i) {
    const double time = samples[i].t_px - middle, word = samples[i].disparity_px;
    if (fabs(word - found->disparity_px - found->disparity_slope * time) > reach) continue;
    n += 1.0, t += time, d += word, tt += time * time, td += time * word, dd += word * word;
  }
  const double spread = tt - t * t / n, along = td - t * d / n;
  if (n < 2.0 || !(spread > 0.0)) return 0;
  const double slope = along / spread, residual = fmax(dd - d * d / n - slope * along, 0.0) / n;
  const double rows = fmax(n / view->frame->params->stereo.block_size, 1.0);
  found->disparity_slope = slope;
  found->lasting_sigma_px = ROW_ERROR_PX * fabs(columns_per_row(found));
  found->disparity_sigma_px = sqrt(vista_square(BIAS_PX) + residual / rows);
  found->disparity_slope_sigma = sqrt((residual + vista_square(BIAS_PX)) / rows / (spread / n));
  /* Moved to the middle of the samples, where level and slope do not depend on each other. */
  const double v_px = vista_thin_v_px(found, middle + t / n);
  found->u_px = vista_thin_u_px(found, middle + t / n);
  found->v_px = v_px;
  found->disparity_px = d / n;
  return (int32_t)n;
}

/* Whether most of the line that is seen stands above the ground by at least the given height. */
static bool stands(const reading *r, const vista_camera *camera, const vista_thin_line *found) {
  const vista_line_view *const view = r->view;
  if (!view->surfaces->ground_found) return true;
  int32_t above = 0;
  for (int32_t t = found->first_px; t <= found->last_px; ++t) {
    const double d = vista_thin_disparity_px(found, t);
    above += d > 0.0 && vista_plane_height_m(&view->surfaces->ground, camera, vista_thin_u_px(r->line, t),
                                             vista_thin_v_px(r->line, t), d) >= HEIGHT_M;
  }
  return 2 * above > found->last_px - found->first_px + 1;
}

/* Length in metres of the line. */
static double length_m(const vista_camera *camera, const vista_thin_line *line) {
  double ends_m[2][3];
  const double t[2] = {line->first_px, line->last_px};
  for (int k = 0; k < 2; ++k) {
    const double d = fmax(vista_thin_disparity_px(line, t[k]), 1e-3), per_px = camera->baseline_m / d;
    ends_m[k][0] = (vista_thin_u_px(line, t[k]) - camera->center_u_px) * per_px;
    ends_m[k][1] = (vista_thin_v_px(line, t[k]) - camera->center_v_px) * per_px;
    ends_m[k][2] = camera->focal_px * per_px;
  }
  const double along[3] = {ends_m[1][0] - ends_m[0][0], ends_m[1][1] - ends_m[0][1], ends_m[1][2] - ends_m[0][2]};
  return vista_norm(along);
}

/* Whether something beside the line is as near as it, or nearer. */
static bool is_level(const reading *r, const vista_thin_line *found, int32_t t) {
  const double side = beside(r, t);
  return side >= 0.0 && side > vista_thin_disparity_px(found, t) - r->apart_px;
}

/* Rows with something beside the line that is as near as it, or nearer. */
static int32_t level_rows(const reading *r, const vista_thin_line *found) {
  int32_t level = 0;
  for (int32_t t = found->first_px; t <= found->last_px; ++t) level += is_level(r, found, t);
  return level;
}

static int32_t take_samples(const reading *r, vista_line_sample *samples, vista_thin_line *found) {
  int32_t count = 0;
  for (int32_t t = found->first_px; t <= found->last_px; ++t) {
    bool apart;
    const double word = on_line(r, t, beside(r, t), &apart);
    found->rows += word > 0.0;
    if (apart) samples[count++] = (vista_line_sample){(float)t, (float)word};
  }
  return count;
}

static bool agrees(const vista_thin_line *found, const vista_line_sample *sample, double reach) {
  return fabs(sample->disparity_px - vista_thin_disparity_px(found, sample->t_px)) <= reach;
}

/* Rows from one to another, in either order, with any word on the line. */
static int32_t rows_with_words(const reading *r, int32_t from, int32_t to) {
  int32_t rows = 0;
  bool apart;
  for (int32_t t = from < to ? from : to; t <= (from < to ? to : from); ++t) rows += on_line(r, t, -1.0, &apart) > 0.0;
  return rows;
}

/* The row up to which a line goes on beyond the last one whose words agree, as far as the image shows it. What
 * continues it there may be the edge of something behind, such as a row of windows above a post; then the words are
 * that thing's. A share `seen` of the rows between the agreeing ends has words of the line: it is unlikely that none of
 * many more rows has one by chance. */
static int32_t extended(const reading *r, const vista_ridge *ridge, int32_t agreed, int32_t step, double seen) {
  const int32_t end = vista_straight_line_end(ridge, r->line, agreed, step);
  const double blocks =
      (end == agreed ? 0 : rows_with_words(r, agreed + step, end)) / (double)r->view->frame->params->stereo.block_size;
  return blocks * -log(1.0 - fmin(seen, 0.95)) > END_ODDS ? agreed : end;
}

/* A wire does not end in mid-air: where words and ridge are lost before trees or a facade, it goes on downward, and a flat
 * one to both sides, as far as pieces of the image's line were linked, and no farther than it is long so far, until the
 * ground or something beside it is as near as it. Upward it does not: a pole may end there. */
static int32_t continued(const reading *r, const vista_camera *camera, const vista_thin_line *found, int32_t step) {
  const vista_line_view *const view = r->view;
  const int32_t length = found->last_px - found->first_px, from = step > 0 ? found->last_px : found->first_px;
  const int32_t limit = step > 0 ? r->line->last_px - from : from - r->line->first_px;
  int32_t level = 0, run = 0, more = 0;
  while (more < length && more < limit && run < VISTA_STRIP_ROWS) {
    const int32_t t = from + step * (more + 1);
    const double u = vista_thin_u_px(r->line, t), v = vista_thin_v_px(r->line, t),
                 d = vista_thin_disparity_px(found, t);
    if (!(d > 0.0) ||
        (view->surfaces->ground_found && vista_plane_height_m(&view->surfaces->ground, camera, u, v, d) <= 0.0))
      break;
    run = is_level(r, found, t) ? run + 1 : 0;
    level += run > 0;
    ++more;
  }
  if (run == VISTA_STRIP_ROWS) more -= run, level -= run;
  return level > LEVEL_SHARE * more ? from : from + step * more;
}

/* Sets the ends of a line: the first and the last row whose samples agree, and on from there as far as the image shows
 * it. Rows that are alone do not count. words: the samples are those of rows with words on the line. */
static void set_ends(const reading *r, const vista_camera *camera, double reach, bool words, vista_thin_line *found) {
  const vista_ridge *const ridge = r->view->ridge;
  const vista_line_sample *const samples = r->view->samples;
  const int32_t count = found->rows_apart;
  int32_t seen = 0, first = found->first_px, last = found->last_px;
  for (int32_t i = 0; i < count && seen < END_ROWS; ++i)
    if (agrees(found, &samples[i], reach) && ++seen == END_ROWS) first = (int32_t)samples[i].t_px;
  seen = 0;
  for (int32_t i = count - 1; i >= 0 && seen < END_ROWS; --i)
    if (agrees(found, &samples[i], reach) && ++seen == END_ROWS) last = (int32_t)samples[i].t_px;
  const double share = words ? found->rows_on / fmax(rows_with_words(r, first, last), 1.0) : 0.0;
  found->first_px = extended(r, ridge, first, -1, share);
  found->last_px = extended(r, ridge, last, 1, share);
  const int32_t end = continued(r, camera, found, 1);
  if (found->flat) found->first_px = continued(r, camera, found, -1);
  found->last_px = end;
}

/* Finds how high above the ground the lower end of a line is, as it is found for a region (region.h). */
static void find_foot(const vista_line_view *view, const vista_camera *camera, vista_thin_line *found) {
  const double t = found->flat && found->slope < 0.0 ? found->first_px : found->last_px;
  found->foot_seen = view->surfaces->ground_found;
  if (found->foot_seen)
    found->foot_share = vista_plane_share_above(&view->surfaces->ground, camera, vista_thin_u_px(found, t),
                                                vista_thin_v_px(found, t), vista_thin_disparity_px(found, t));
}

/* Whether the line, whose disparity is known, is a thing of its own; fills what else there is to tell of it. */
static bool is_thing(const reading *r, double reach, bool words, vista_thin_line *own) {
  const vista_camera *const camera = r->view->frame->camera;
  set_ends(r, camera, reach, words, own);
  if (!(vista_thin_disparity_px(own, own->first_px) > 0.0) || !(vista_thin_disparity_px(own, own->last_px) > 0.0))
    return false;
  own->rows_level = level_rows(r, own);
  if (own->rows_level > LEVEL_SHARE * (own->last_px - own->first_px + 1)) return false;
  if (length_m(camera, own) < LENGTH_MIN_M || !stands(r, camera, own)) return false;
  find_foot(r->view, camera, own);
  return true;
}

/* Fits a straight line in disparity to the samples; whether so many agree with it. */
static bool fit(const vista_line_view *view, double fewest, double reach, vista_thin_line *own) {
  float at = 0.0f, slope = 0.0f;
  if (own->rows_apart < fewest) return false;
  if (propose(view->samples, own->rows_apart, (float)vista_thin_middle_px(own), (float)reach, &at, &slope) < fewest)
    return false;
  own->disparity_px = at;
  own->disparity_slope = slope;
  for (int k = 0; k < 2; ++k) own->rows_on = refine(view, own->rows_apart, reach, own);
  return own->rows_on >= fmax(fewest, 2 * END_ROWS);
}

static bool depth_by_words(const reading *r, vista_thin_line *found) {
  const int32_t rows = r->line->last_px - r->line->first_px + 1;
  if (fabs(columns_per_row(r->line)) > LEAN_MAX) return false;
  vista_thin_line own = *r->line;
  own.rows_apart = take_samples(r, r->view->samples, &own);
  if (!fit(r->view, fmax(ROWS_MIN, ROW_SHARE * rows), AGREE_PX, &own)) return false;
  if (own.rows_on < AGREE_SHARE * own.rows_apart) return false;
  if (own.rows_on < ROWS_SURE && own.rows_on < WORD_SHARE * own.rows) return false;
  if (!is_thing(r, AGREE_PX, true, &own)) return false;
  *found = own;
  return true;
}

/* Leaves those samples that are nearer than what is beside the line. */
static int32_t keep_apart(const reading *r, vista_line_sample *samples, int32_t count) {
  int32_t kept = 0;
  for (int32_t i = 0; i < count; ++i) {
    const double side = beside(r, (int32_t)samples[i].t_px);
    if (side < 0.0 || samples[i].disparity_px >= side + r->apart_px) samples[kept++] = samples[i];
  }
  return kept;
}

static bool depth_by_motion(reading *r, vista_thin_line *found) {
  vista_line_sample *const samples = r->view->samples;
  vista_line_motion *const motion = r->view->motion;
  for (int32_t k = 0; k < VISTA_MOTION_SAMPLES; ++k) {
    const int32_t t = vista_moved_sample_px(r->line, k);
    if (t > r->line->last_px) break;
    motion->beside_px[k] = (float)beside(r, t);
  }
  const vista_moved_samples moved =
      vista_line_motion_samples(r->view->frame, r->line, motion->beside_px, motion, samples);
  const double sigma_px = hypot(POSE_ERROR_PX * moved.per_px, STEP_ERROR * moved.step_px);
  const double reach = fmax(AGREE_PX, MOVED_STEPS * moved.step_px);
  r->apart_px = VISTA_SURFACE_PX + APART_SIGMAS * sigma_px;
  vista_thin_line own = *r->line;
  own.rows = moved.count;
  own.rows_apart = keep_apart(r, samples, moved.count);
  if (!fit(r->view, fmax(MOVED_MIN, MOVED_SHARE * moved.asked), reach, &own)) return false;
  if (own.rows_on < AGREE_SHARE * moved.count) return false;
  own.lasting_sigma_px = sigma_px;
  if (!is_thing(r, reach, false, &own)) return false;
  *found = own;
  return true;
}

bool vista_line_depth(const vista_line_view *view, const vista_thin_line *line, vista_thin_line *found) {
  const double radius = view->frame->matched.margin_px + PREFILTER_PX; /* of the block */
  reading r = {view, line, radius * (1.0 + fabs(line->slope)) + CLEAR_PX, VISTA_SURFACE_PX};
  return depth_by_words(&r, found) || depth_by_motion(&r, found);
}
