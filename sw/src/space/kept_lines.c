#include "space/kept_lines.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "common/frame.h"
#include "common/numbers.h"

#define KEPT_S 60.0
#define FRAME_S 0.1 /* the most that one frame may count for: after a gap as well one frame is no proof */
#define MISSED_SHARE 4.5 /* of the time for which a line was shown, that frames in a row may miss it, */
#define SHOWN_S 0.5 /* of which no more than this counts: something that moved on was shown, too */
#define SAME_KEPT 5 /* frames that saw a line: pieces of more of them tell no more */
#define SAME_M 0.5 /* apart: pieces of one line */
#define FOUND_SLOPE 0.2 /* of a line in the image, from which on it is found in most frames */
#define POINTS 9 /* of a line that are looked at to tell whether it is in view, */
#define IN_VIEW 3 /* and of these, in view, to blame a frame */

/* Whether the frame would show the line if it were there. */
static bool should_show(const vista_frame_view *frame, const vista_kept_line *line) {
  const vista_camera *const camera = frame->camera;
  double first_px[2] = {0}, last_px[2] = {0};
  int in_view = 0;
  for (int k = 0; k < POINTS; ++k) {
    double point_m[3], camera_m[3], at_px[3];
    for (int i = 0; i < 3; ++i) point_m[i] = line->from_m[i] + (double)k / (POINTS - 1) * line->along_m[i];
    vista_frame_to_camera(&frame->motion.pose, point_m, camera_m);
    if (!(camera_m[2] > camera->baseline_m)) continue;
    vista_frame_measure(camera, camera_m, at_px, NULL);
    if (at_px[2] > frame->matched.disparity_max_px) continue;
    if (!vista_matched_holds(&frame->matched, camera, at_px[0], at_px[1], at_px[2])) continue;
    memcpy(in_view++ == 0 ? first_px : last_px, at_px, sizeof first_px);
  }
  return in_view >= IN_VIEW && fabs(last_px[1] - first_px[1]) >= FOUND_SLOPE * fabs(last_px[0] - first_px[0]);
}

/* The piece of a line that is certain, in the world; false: none is. */
static bool piece_of(const vista_frame_view *frame, const vista_thin_line *line, vista_kept_line *piece) {
  int32_t first = line->first_px, last = line->last_px;
  while (first <= last && !vista_thin_is_certain(line, first)) ++first;
  while (first <= last && !vista_thin_is_certain(line, last)) --last;
  if (first >= last) return false;
  double camera_m[3], to_m[3];
  piece->sigma_m = 0.0;
  for (int end = 0; end < 2; ++end) {
    const double t = end == 0 ? first : last;
    vista_thin_point(line, frame->camera, t, camera_m);
    /* cppcheck-suppress legacyUninitvar ; it is what is set here */
    vista_frame_to_world(&frame->motion.pose, camera_m, end == 0 ? piece->from_m : to_m);
    const double share = vista_thin_sigma_px(line, t) / vista_thin_disparity_px(line, t);
    piece->sigma_m = fmax(piece->sigma_m, share * vista_norm(camera_m));
  }
  for (int i = 0; i < 3; ++i) {
    piece->along_m[i] = to_m[i] - piece->from_m[i];
    piece->middle_m[i] = piece->from_m[i] + 0.5 * piece->along_m[i];
  }
  piece->half_m = 0.5 * vista_norm(piece->along_m);
  piece->t_ns = frame->t_ns;
  piece->shown_s = FRAME_S;
  piece->missed_s = 0.0;
  return true;
}

/* Whether the balls around them touch, which is all that most lines are asked. */
static inline bool is_near(const vista_kept_line *line, const vista_kept_ball *ball) {
  double apart[3];
  for (int i = 0; i < 3; ++i) apart[i] = ball->point_m[i] - line->middle_m[i];
  const double reach_m = line->half_m + ball->radius_m + ball->deep_m + line->sigma_m;
  return vista_dot(apart, apart) <= vista_square(reach_m);
}

/* The point of a line that is nearest to another. */
static void nearest_to(const vista_kept_line *line, const double point_m[3], double at_m[3]) {
  double from[3];
  for (int i = 0; i < 3; ++i) from[i] = point_m[i] - line->from_m[i];
  const double share = vista_dot(from, line->along_m) / fmax(vista_dot(line->along_m, line->along_m), 1e-9);
  for (int i = 0; i < 3; ++i) at_m[i] = line->from_m[i] + fmin(fmax(share, 0.0), 1.0) * line->along_m[i];
}

/* The point of a line nearest to the middle of the ball, if it is in it. */
static bool meets(const vista_kept_line *line, const vista_kept_ball *ball, double at_m[3]) {
  double off[3], sight[3];
  nearest_to(line, ball->point_m, at_m);
  for (int i = 0; i < 3; ++i) {
    sight[i] = ball->point_m[i] - ball->camera_m[i];
    off[i] = at_m[i] - ball->point_m[i];
  }
  const double along_m = vista_dot(off, sight) / fmax(vista_norm(sight), 1e-9);
  const double across2_m2 = vista_dot(off, off) - vista_square(along_m);
  return across2_m2 <= vista_square(ball->radius_m) && fabs(along_m) <= ball->deep_m + line->sigma_m;
}

static bool passes(const vista_kept_line *line, const vista_kept_line *other, const vista_frame_view *frame) {
  vista_kept_ball ball = {.radius_m = SAME_M, .deep_m = SAME_M + other->sigma_m};
  double at_m[3];
  memcpy(ball.point_m, other->middle_m, sizeof ball.point_m);
  memcpy(ball.camera_m, frame->motion.pose.translation_m, sizeof ball.camera_m);
  return is_near(line, &ball) && meets(line, &ball, at_m);
}

/* A piece that a frame found, and what is kept of its line. */
typedef struct found_piece {
  vista_kept_line piece;
  int32_t newer;    /* frames that saw it, VISTA_SPACE_SPACING_S or more apart, among the pieces looked at so far, */
  int64_t oldest_t_ns; /* and the last of them */
} found_piece;

/* Whether the frame shows a kept line: one of the pieces that it found is of it, and has been shown for as long then.
 * From the newest line on; *spare: whether those of before tell all that this one does. */
static bool is_shown(const vista_frame_view *frame, double frame_s, vista_kept_line *line, found_piece *found,
                     int32_t count, bool *spare) {
  bool shown = false;
  *spare = false;
  for (int32_t k = 0; k < count; ++k) {
    found_piece *const f = &found[k];
    if (!passes(line, &f->piece, frame) && !passes(&f->piece, line, frame)) continue;
    shown = true;
    f->piece.shown_s = fmax(f->piece.shown_s, fmin(line->shown_s + frame_s, SHOWN_S));
    *spare |= f->newer >= SAME_KEPT && line->half_m <= f->piece.half_m;
    if (vista_seconds_between(line->t_ns, f->oldest_t_ns) < VISTA_SPACE_SPACING_S) continue;
    ++f->newer;
    f->oldest_t_ns = line->t_ns;
  }
  if (shown) line->shown_s = fmin(line->shown_s + frame_s, SHOWN_S);
  return shown;
}

/* Lets go of pieces that are too old, or that frames should show and do not, or that newer ones stand for. found: pieces
 * that this one shows. */
static int32_t keep(vista_kept_line *items, int32_t count, int64_t previous_t_ns, const vista_frame_view *frame,
                    found_piece *found, int32_t found_count) {
  const double frame_s = fmin(vista_seconds_between(previous_t_ns, frame->t_ns), FRAME_S);
  int32_t first = count;
  for (int32_t i = count - 1; i >= 0; --i) { /* from the newest on, which move to the end */
    vista_kept_line *const line = &items[i];
    bool spare;
    if (is_shown(frame, frame_s, line, found, found_count, &spare))
      line->missed_s = 0.0;
    else if (should_show(frame, line))
      line->missed_s += frame_s;
    if (spare || line->missed_s > MISSED_SHARE * line->shown_s ||
        vista_seconds_between(line->t_ns, frame->t_ns) > KEPT_S)
      continue;
    items[--first] = *line;
  }
  memmove(items, items + first, (size_t)(count - first) * sizeof *items);
  return count - first;
}

void vista_kept_lines_add(vista_kept_lines *kept, const vista_frame_view *frame, const vista_thin_lines *lines) {
  if (!frame->motion.known) {
    kept->count = 0;
    return;
  }
  found_piece found[VISTA_THIN_MAX];
  int32_t count = 0;
  for (int32_t i = 0; i < lines->count; ++i) {
    if (!piece_of(frame, &lines->items[i], &found[count].piece)) continue;
    found[count].newer = 1;
    found[count++].oldest_t_ns = frame->t_ns;
  }
  kept->count = keep(kept->items, kept->count, kept->t_ns, frame, found, count);
  kept->t_ns = frame->t_ns;
  const int32_t over = kept->count + count - VISTA_LINES_KEPT;
  if (over > 0) {
    kept->count -= over;
    memmove(kept->items, kept->items + over, (size_t)kept->count * sizeof kept->items[0]);
  }
  for (int32_t k = 0; k < count; ++k) kept->items[kept->count++] = found[k].piece;
}

/* Whether the line is in the way of what flies to the ball. */
static bool is_flown_to(const vista_kept_line *line, const vista_kept_ball *ball) {
  if (ball->from_m == NULL) return true;
  double middle_m[3], of_middle_m[3], of_start_m[3];
  vista_middle(ball->from_m, ball->point_m, middle_m);
  nearest_to(line, middle_m, of_middle_m);
  nearest_to(line, ball->from_m, of_start_m);
  return vista_distance2(of_middle_m, middle_m) < vista_distance2(of_start_m, ball->from_m);
}

int32_t vista_kept_lines_frames(const vista_kept_lines *kept, const vista_kept_ball *ball, double at_m[3]) {
  int32_t frames = 0;
  int64_t t_ns = 0;
  for (int32_t i = 0; i < kept->count; ++i) {
    const vista_kept_line *const line = &kept->items[i];
    double met_m[3];
    if (!is_near(line, ball) || !meets(line, ball, met_m) || !is_flown_to(line, ball)) continue;
    if (frames == 0 || vista_seconds_between(t_ns, line->t_ns) >= VISTA_SPACE_SPACING_S) {
      ++frames;
      t_ns = line->t_ns;
    }
    memcpy(at_m, met_m, sizeof met_m);
  }
  return frames;
}
