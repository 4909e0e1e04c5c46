#include "space/overhangs.h"

#include <math.h>
#include <stdbool.h>
#include <stddef.h>

#include "common/frame.h"
#include "common/numbers.h"

#define MARGIN_PX 2.0 /* by which the edges of what is matched, and the poses, may be off */
#define ROWS 3        /* of a column, above its foot, in which an older frame has to have seen ground; */
#define ASIDE 4       /* of so many columns to each side */
#define COLUMNS_MIN 5 /* so many, and more than half, have to say the same */
#define EDGE_ROWS 3   /* by which a lower edge differs at most from a column to the next one */
#define ENDS_ROWS 3   /* matched rows, one above the other: something else begins there */
#define STAYS_M 0.1   /* from one frame to the next: who moves less sees no other ground */
#define UPRIGHT_MIN 0.2 /* sine of camera axis and vertical */

enum { NOTHING, STANDS, HANGS }; /* what is in a column, by what it shows */

static ptrdiff_t at(const vista_evidence *e, int32_t x, int32_t y) { return (ptrdiff_t)y * e->width + x; }

/* The row of a column in which a line of sight is so high, at depth 1 and against gravity: those above are higher. */
static double row_at(const vista_frame_view *frame, const vista_evidence *e, int32_t x, double height) {
  const vista_camera *const camera = frame->camera;
  const double *const up = frame->up_camera;
  const double right = (x * e->step_px - camera->center_u_px) / camera->focal_px;
  const double down = (up[0] * right + up[2] - height) / fmax(-up[1], UPRIGHT_MIN);
  return (camera->center_v_px + camera->focal_px * down) / e->step_px;
}

/* The highest row up to which nothing is matched from row y on, but for single words. */
static int32_t top_of(const vista_evidence *e, int32_t x, int32_t y) {
  int32_t top = y, matched = 0;
  while (--y >= 0 && matched < ENDS_ROWS && e->kind[at(e, x, y)] != VISTA_SIGHT_OUTSIDE) {
    matched = e->kind[at(e, x, y)] <= VISTA_SIGHT_LEVEL ? matched + 1 : 0;
    if (matched == 0) top = y;
  }
  return top;
}

/* The lowest row of what seems to stand on the ground in a column and reaches above the horizon; -1: nothing does. */
static int32_t foot_of(const vista_frame_view *frame, const vista_evidence *e, int32_t x) {
  const double horizon = row_at(frame, e, x, 0.0), low = row_at(frame, e, x, -VISTA_SIGHT_LOW);
  for (int32_t y = e->height - 2; y > low && y > 0; --y) {
    if (e->kind[at(e, x, y)] != VISTA_SIGHT_BOUNDED || e->kind[at(e, x, y + 1)] != VISTA_SIGHT_LEVEL) continue;
    const int32_t foot = y;
    y = top_of(e, x, y);
    if (y < horizon) return foot;
  }
  return -1;
}

/* Whether the other frame saw ground where the line of sight through a point of the image (u, v, disparity) seems to end at
 * a wall; stays: whether what it saw there hung. *nearer: how much nearer the place is now. */
static bool shows_ground(const vista_frame_view *frame, const vista_evidence *other, bool stays,
                         const double image_px[3], double *nearer) {
  const vista_camera *const camera = frame->camera;
  double here_m[3], world_m[3], there_m[3], there_px[3];
  vista_frame_point(camera, image_px, here_m);
  vista_frame_to_world(&frame->motion.pose, here_m, world_m);
  vista_frame_to_camera(&other->pose, world_m, there_m);
  if (!(there_m[2] > camera->baseline_m)) return false;
  *nearer = there_m[2] / here_m[2];
  vista_frame_measure(camera, there_m, there_px, NULL);
  const double x = there_px[0] / other->step_px, y = there_px[1] / other->step_px;
  if (!(x > -0.5 && x < other->width - 0.5 && y > -0.5 && y < other->height - 0.5)) return false;
  const ptrdiff_t i = at(other, (int32_t)(x + 0.5), (int32_t)(y + 0.5));
  if (stays) return other->kind[i] == VISTA_SIGHT_OVERHANG;
  const double tolerance_px = fmax(VISTA_SIGHT_TOLERANCE_PX, VISTA_SIGHT_TOLERANCE_SHARE * there_px[2]);
  return other->kind[i] == VISTA_SIGHT_LEVEL && other->word[i] < (there_px[2] + tolerance_px) * VISTA_DISPARITY_SCALE;
}

/* Whether what seems to stand in a column, from row y on, does not by what the other frame saw. */
static bool hangs(const vista_frame_view *frame, const vista_evidence *other, bool stays, const vista_evidence *e,
                  int32_t x, int32_t y) {
  const double word_px = e->word[at(e, x, y + 1)] / (double)VISTA_DISPARITY_SCALE;
  double image_px[3] = {x * e->step_px, (y + 1) * e->step_px, word_px}, nearer = 1.0;
  (void)shows_ground(frame, other, stays, image_px, &nearer);
  /* Above what words of the ground may have covered from there, where as many pixels are more of the surface. */
  image_px[1] -= VISTA_SIGHT_SPREAD_PX * fmax(nearer - 1.0, 0.0) + MARGIN_PX * nearer;
  for (int32_t k = 0; k < ROWS; ++k, image_px[1] -= e->step_px)
    if (!shows_ground(frame, other, stays, image_px, &nearer)) return false;
  return true;
}

/* What seems to stand on the ground in a column, with its foot in row y; -1: nothing does. */
static int16_t judge(const vista_frame_view *frame, const vista_evidence *older, const vista_evidence *before,
                     const vista_evidence *e, int32_t x, int32_t y) {
  if (y < 0) return NOTHING;
  const bool stays = vista_distance(before->pose.translation_m, e->pose.translation_m) < STAYS_M;
  if (!hangs(frame, older, false, e, x, y) && !(stays && hangs(frame, before, true, e, x, y))) return STANDS;
  return vista_evidence_begins(frame, x * e->step_px, (y + 1) * e->step_px) ? HANGS : STANDS;
}

/* Whether the columns around column x bear it out that what is in it hangs. */
static bool is_borne_out(const int16_t *judged, int32_t width, int32_t x) {
  int32_t all = 0, hang = 0;
  for (int32_t k = x < ASIDE ? 0 : x - ASIDE; k <= x + ASIDE && k < width; ++k) {
    all += judged[k] != NOTHING;
    hang += judged[k] == HANGS;
  }
  return judged[x] == HANGS && hang >= COLUMNS_MIN && 2 * hang > all;
}

static void mark(vista_evidence *e, int32_t x, int32_t y) {
  for (const int32_t top = top_of(e, x, y); y >= top; --y)
    if (e->kind[at(e, x, y)] == VISTA_SIGHT_BOUNDED) e->kind[at(e, x, y)] = VISTA_SIGHT_OVERHANG;
}

/* The row in a column at which the lower edge goes on that lies at row y beside it; -1: it does not. */
static int32_t edge_in(const vista_frame_view *frame, const vista_evidence *e, int32_t x, int32_t y) {
  for (int32_t k = 0; k <= 2 * EDGE_ROWS; ++k) {
    const int32_t row = y + (k % 2 == 0 ? k / 2 : -(k + 1) / 2);
    if (row < 1 || row + 1 >= e->height) continue;
    const uint8_t kind = e->kind[at(e, x, row)];
    if ((kind == VISTA_SIGHT_BOUNDED || kind == VISTA_SIGHT_OVERHANG) &&
        e->kind[at(e, x, row + 1)] <= VISTA_SIGHT_LEVEL && top_of(e, x, row) < row_at(frame, e, x, 0.0))
      return row;
  }
  return -1;
}

/* Marks what goes on beside what hangs, along its lower edge, to one side. feet: rows of what hangs, or -1. */
static void mark_along(const vista_frame_view *frame, const int16_t *feet, int32_t side, vista_evidence *e) {
  int32_t edge = -1, missed = 0;
  for (int32_t k = 0; k < e->width; ++k) {
    const int32_t x = side > 0 ? k : e->width - 1 - k, row = edge < 0 ? -1 : edge_in(frame, e, x, edge);
    if (feet[x] < 0 && row < 0) {
      if (++missed > ASIDE) edge = -1;
      continue;
    }
    edge = feet[x] >= 0 ? feet[x] : row;
    missed = 0;
    mark(e, x, edge);
  }
}

void vista_overhangs_mark(const vista_frame_view *frame, const vista_evidence *older, const vista_evidence *before,
                          vista_evidence *newest) {
  int16_t *const feet = newest->low, *const judged = newest->edged; /* scratch */
  for (int32_t x = 0; x < newest->width; ++x) {
    feet[x] = (int16_t)foot_of(frame, newest, x);
    judged[x] = judge(frame, older, before, newest, x, feet[x]);
  }
  for (int32_t x = 0; x < newest->width; ++x)
    if (!is_borne_out(judged, newest->width, x)) feet[x] = -1;
  mark_along(frame, feet, 1, newest);
  mark_along(frame, feet, -1, newest);
}
