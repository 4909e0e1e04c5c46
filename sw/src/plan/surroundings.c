#include "plan/surroundings.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#include "common/frame.h"
#include "common/numbers.h"
#include "space/space_map.h"

#define GRID VISTA_PLAN_CUBES
_Static_assert(GRID * GRID * GRID == VISTA_PLAN_CUBE_COUNT, "the cubes of the grid");
#define SIDE_SHARE 0.5 /* of the radius: the side of a cube */
#define KEPT_S 8.0
#define SPACING 3 /* lines of sight, from one that may end in a cube to the next */
#define MATCHES_MIN 3 /* of them in a cube, for a frame to tell that something stands in it */
#define STAND_FRAMES 3 /* that agree on that, */
#define FREE_FRAMES 2  /* or that it is free */
#define THROUGH_MIN 7 /* of nine lines of sight that lead to a cube, to see through it */
#define SIDES 5 /* of the view of a camera */
#define STOOD_SHARE 0.25 /* of the radius, around where the vehicle was, */
#define STOOD_APART_SHARE 0.1 /* and from one such place to the next */

double vista_plan_matched_from_m(const vista_frame_view *frame) {
  return frame->camera->focal_px * frame->camera->baseline_m / vista_matched_finest_px(&frame->matched);
}

/* ---- the grid in the world ---- */

static double side_m(const vista_planner *p) { return SIDE_SHARE * p->radius_m; }

static void cube_of(const vista_planner *p, const double point_m[3], int32_t at[3]) {
  for (int i = 0; i < 3; ++i) at[i] = (int32_t)floor(point_m[i] / side_m(p));
}

/* The memory of a cube: those that lie a grid apart share it. */
static int32_t place_of(const int32_t at[3]) {
  return vista_modulo(at[0], GRID) + GRID * (vista_modulo(at[1], GRID) + GRID * vista_modulo(at[2], GRID));
}

static bool is_of(const vista_planner *p, int32_t place, const int32_t at[3]) {
  return memcmp(p->cubes[place].at, at, sizeof p->cubes[place].at) == 0;
}

static bool is_kept(int64_t then_ns, int64_t now_ns) {
  return then_ns != 0 && vista_seconds_between(then_ns, now_ns) < KEPT_S;
}

static vista_plan_cube *take_place(vista_planner *p, int32_t place, const int32_t at[3]) {
  if (!is_of(p, place, at)) {
    p->cubes[place] = (vista_plan_cube){.at = {at[0], at[1], at[2]}};
    p->agree[place] = 0;
  }
  return &p->cubes[place];
}

/* One more frame says that a cube is free (1), or that something stands in it (-1). Whatever contradicts it counts anew. */
static void take_word(vista_planner *p, int32_t place, int said, int64_t t_ns) {
  vista_plan_cube *const cube = &p->cubes[place];
  int8_t *const agree = &p->agree[place];
  if (*agree * said < 0 || !is_kept(cube->t_ns, t_ns)) *agree = 0;
  if (*agree > -STAND_FRAMES && *agree < STAND_FRAMES) *agree = (int8_t)(*agree + said);
  cube->t_ns = t_ns;
}

/* ---- what a frame shows ---- */

typedef struct sight {
  const vista_evidence *e;
  const vista_camera *camera;
  double side_m, matched_from_m;
  int32_t first[3]; /* cube of the grid */
} sight;

static bool is_in_grid(const sight *s, const int32_t at[3]) {
  bool in = true;
  for (int i = 0; i < 3; ++i) in &= at[i] >= s->first[i] && at[i] < s->first[i] + GRID;
  return in;
}

/* Adds what lines of sight end at to the cubes. */
static void match(vista_planner *p, const sight *s) {
  const vista_evidence *const e = s->e;
  const double scale = s->camera->focal_px * s->camera->baseline_m * VISTA_DISPARITY_SCALE;
  const double least = fmax(scale / (0.5 * VISTA_SQRT_3 * GRID * s->side_m), 1.0); /* of what the grid reaches to */
  memset(p->matches, 0, sizeof p->matches);
  for (int32_t row = 0; row < e->height; row += SPACING)
    for (int32_t column = 0; column < e->width; column += SPACING) {
      const ptrdiff_t i = (ptrdiff_t)row * e->width + column;
      if (e->word[i] < least || e->kind[i] != VISTA_SIGHT_WORD) continue;
      const double depth_m = scale / e->word[i], per_px = depth_m / s->camera->focal_px;
      const double at_m[3] = {(column * e->step_px - s->camera->center_u_px) * per_px,
                              (row * e->step_px - s->camera->center_v_px) * per_px, depth_m};
      double point_m[3];
      int32_t at[3];
      vista_frame_to_world(&e->pose, at_m, point_m);
      cube_of(p, point_m, at);
      if (!is_in_grid(s, at)) continue;
      const int32_t place = place_of(at);
      if (p->matches[place] == UINT8_MAX) continue;
      if (p->matches[place]++ == 0) memset(p->sums[place], 0, sizeof p->sums[place]);
      for (int k = 0; k < 3; ++k) p->sums[place][k] += (float)(point_m[k] - at[k] * s->side_m);
    }
}

/* Whether the frame sees through all of a cube at a place in the camera. */
static bool sees_through(const sight *s, const double c[3]) {
  const vista_evidence *const e = s->e;
  const double scale = s->camera->focal_px / c[2] / e->step_px, half = 0.5 * scale * s->side_m;
  const double u = s->camera->center_u_px / e->step_px + scale * c[0];
  const double v = s->camera->center_v_px / e->step_px + scale * c[1];
  if (!(u >= half && u + half < e->width - 1 && v >= half && v + half < e->height - 1)) return false;
  const double behind_px = s->camera->focal_px * s->camera->baseline_m / (c[2] + 0.5 * s->side_m);
  const double off_px = fmax(VISTA_SIGHT_TOLERANCE_PX, VISTA_SIGHT_TOLERANCE_SHARE * behind_px);
  const int32_t farthest = (int32_t)((behind_px - off_px) * VISTA_DISPARITY_SCALE);
  const uint8_t last = c[2] > s->matched_from_m ? VISTA_SIGHT_OUTSIDE : VISTA_SIGHT_LEVEL;
  int32_t through = 0;
  for (int y = -1; y <= 1; ++y)
    for (int x = -1; x <= 1; ++x) {
      const ptrdiff_t i = (ptrdiff_t)(v + y * half + 0.5) * e->width + (ptrdiff_t)(u + x * half + 0.5);
      through += e->kind[i] <= last && vista_evidence_says(e, i, farthest, INT16_MAX) == VISTA_SIGHT_GOES_ON;
    }
  return through >= THROUGH_MIN;
}

static void take_cube(vista_planner *p, const sight *s, const int32_t at[3], const double c[3]) {
  const int32_t place = place_of(at), matches = p->matches[place];
  if (matches >= MATCHES_MIN) {
    vista_plan_cube *const cube = take_place(p, place, at);
    for (int i = 0; i < 3; ++i) cube->from_corner_m[i] = p->sums[place][i] / (float)matches;
    take_word(p, place, -1, s->e->t_ns);
  } else if (sees_through(s, c)) {
    (void)take_place(p, place, at);
    if (p->agree[place] >= 0 || c[2] - s->side_m > s->matched_from_m) take_word(p, place, 1, s->e->t_ns);
  }
}

/* The view of a camera as half-spaces: some of a cube is in view only if the product of each with its middle, as
 * (x, y, z, 1) in the camera, is positive. */
static void take_view(const sight *s, double sides[SIDES][4]) {
  const vista_camera *const camera = s->camera;
  const double right = (camera->width_px - camera->center_u_px) / camera->focal_px;
  const double left = (camera->center_u_px + 1.0) / camera->focal_px;
  const double down = (camera->height_px - camera->center_v_px) / camera->focal_px;
  const double up = (camera->center_v_px + 1.0) / camera->focal_px;
  const double found[SIDES][4] = {{0.0, 0.0, 1.0, -s->side_m},
                                  {-1.0, 0.0, right, 0.0},
                                  {1.0, 0.0, left, 0.0},
                                  {0.0, -1.0, down, 0.0},
                                  {0.0, 1.0, up, 0.0}};
  memcpy(sides, found, sizeof found);
  for (int k = 1; k < SIDES; ++k) sides[k][3] = 0.5 * VISTA_SQRT_3 * s->side_m * vista_norm(sides[k]);
}

/* The cubes of a row of the grid that are in view, give or take one: from *first on and before *beyond. */
static void clip(const double sides[SIDES][4], const double middle[3], const double step[3], int32_t *first,
                 int32_t *beyond) {
  double low = 0.0, high = GRID;
  for (int k = 0; k < SIDES; ++k) {
    const double at = vista_dot(sides[k], middle) + sides[k][3], more = vista_dot(sides[k], step);
    const double crossed = -at / more;
    if (more > 0.0 && crossed > low) low = crossed;
    if (more < 0.0 && crossed + 1.0 < high) high = crossed + 1.0;
    if (more == 0.0 && !(at > 0.0)) high = 0.0;
  }
  *first = low < high ? (int32_t)low : GRID;
  *beyond = low < high ? (int32_t)high : GRID;
}

static void take_frame(const vista_plan_space *space, const vista_evidence *e) {
  vista_planner *const p = space->planner;
  sight s = {e, space->seen.frame->camera, side_m(p), vista_plan_matched_from_m(space->seen.frame), {0}};
  double middle_m[3], corner[3], sides[SIDES][4];
  cube_of(p, space->start_m, s.first);
  for (int i = 0; i < 3; ++i) {
    s.first[i] -= GRID / 2;
    middle_m[i] = (s.first[i] + 0.5) * s.side_m;
  }
  match(p, &s);
  take_view(&s, sides);
  vista_frame_to_camera(&e->pose, middle_m, corner);
  const double *const r = e->pose.rotation;
  const double step[3] = {s.side_m * r[6], s.side_m * r[7], s.side_m * r[8]};
  for (int32_t x = 0; x < GRID; ++x)
    for (int32_t y = 0; y < GRID; ++y) {
      double row[3];
      int32_t first, beyond;
      for (int i = 0; i < 3; ++i) row[i] = corner[i] + s.side_m * (x * r[i] + y * r[3 + i]);
      clip(sides, row, step, &first, &beyond);
      for (int32_t z = first; z < beyond; ++z) {
        const double c[3] = {row[0] + z * step[0], row[1] + z * step[1], row[2] + z * step[2]};
        const int32_t at[3] = {s.first[0] + x, s.first[1] + y, s.first[2] + z};
        if (c[2] > s.side_m) take_cube(p, &s, at, c);
      }
    }
}

/* Keeps where the vehicle is, unless it has hardly moved: then it is there still. */
static void stand(const vista_plan_space *space) {
  vista_planner *const p = space->planner;
  vista_plan_stood *const last = &p->stood[p->last_stood];
  if (last->t_ns == 0 || vista_distance(last->point_m, space->start_m) > STOOD_APART_SHARE * p->radius_m) {
    p->last_stood = (p->last_stood + 1) % VISTA_PLAN_STOOD;
    memcpy(p->stood[p->last_stood].point_m, space->start_m, sizeof space->start_m);
  }
  p->stood[p->last_stood].t_ns = space->t_ns;
}

static void list_standing(vista_plan_space *space) {
  const vista_planner *const p = space->planner;
  space->standing_count = 0;
  for (int32_t k = 0; k < GRID * GRID * GRID; ++k)
    if (p->agree[k] <= -STAND_FRAMES && is_kept(p->cubes[k].t_ns, space->t_ns))
      space->standing[space->standing_count++] = (uint16_t)k;
}

void vista_plan_take_surroundings(vista_plan_space *space) {
  vista_planner *const p = space->planner;
  if (space->seen.space->count > 0) {
    const vista_evidence *const newest = vista_space_map_frame(space->seen.space, 0);
    if (newest->t_ns != p->taken_ns) take_frame(space, newest);
    p->taken_ns = newest->t_ns;
  }
  stand(space);
  list_standing(space);
}

/* ---- what is asked ---- */

double vista_plan_stands_within(const vista_plan_space *space, const double point_m[3], double within_m) {
  const vista_planner *const p = space->planner;
  double nearest2_m2 = vista_square(within_m), middle_m[3];
  bool found = false;
  vista_middle(space->start_m, point_m, middle_m);
  for (int32_t k = 0; k < space->standing_count; ++k) {
    const vista_plan_cube *const cube = &p->cubes[space->standing[k]];
    double at_m[3];
    for (int i = 0; i < 3; ++i) at_m[i] = cube->at[i] * side_m(p) + (double)cube->from_corner_m[i];
    const double apart2_m2 = vista_distance2(at_m, point_m);
    if (!(apart2_m2 < nearest2_m2) || !(vista_distance2(at_m, middle_m) < vista_distance2(at_m, space->start_m)))
      continue;
    nearest2_m2 = apart2_m2;
    found = true;
  }
  return found ? sqrt(nearest2_m2) : INFINITY;
}

bool vista_plan_was_free(const vista_plan_space *space, const double point_m[3], double within_m) {
  const vista_planner *const p = space->planner;
  const double side = side_m(p), reach_m = within_m + 0.25 * side; /* to the middle of a cube that is so near */
  int32_t low[3], high[3], at[3];
  for (int i = 0; i < 3; ++i) {
    low[i] = (int32_t)ceil((point_m[i] - reach_m) / side - 0.5);
    high[i] = (int32_t)floor((point_m[i] + reach_m) / side - 0.5);
  }
  for (at[0] = low[0]; at[0] <= high[0]; ++at[0])
    for (at[1] = low[1]; at[1] <= high[1]; ++at[1])
      for (at[2] = low[2]; at[2] <= high[2]; ++at[2]) {
        double off2_m2 = 0.0;
        for (int i = 0; i < 3; ++i) off2_m2 += vista_square((at[i] + 0.5) * side - point_m[i]);
        if (off2_m2 > vista_square(reach_m)) continue;
        const int32_t place = place_of(at);
        if (p->agree[place] < FREE_FRAMES || !is_of(p, place, at) || !is_kept(p->cubes[place].t_ns, space->t_ns))
          return false;
      }
  return true;
}

bool vista_plan_stood_at(const vista_plan_space *space, const double point_m[3]) {
  const vista_planner *const p = space->planner;
  for (int32_t k = 0; k < VISTA_PLAN_STOOD; ++k)
    if (vista_distance2(p->stood[k].point_m, point_m) <= vista_square(STOOD_SHARE * p->radius_m) &&
        is_kept(p->stood[k].t_ns, space->t_ns))
      return true;
  return false;
}
