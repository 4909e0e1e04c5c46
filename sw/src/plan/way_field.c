#include "plan/way_field.h"

#include <math.h>
#include <string.h>

#include "common/frame.h"
#include "common/numbers.h"
#include "plan/angles.h"
#include "plan/primitives.h"
#include "plan/way_sweep.h"

#define GRID VISTA_PLAN_GRID
#define CELL_SHARE 0.5 /* of the radius: the side of a cell */
#define KEPT_S 60.0
#define LEVEL_RADII 2.0 /* what was seen from farther above or below is on another way */
#define NEAR_CELLS 4    /* around what stands: this far, cells are longer to pass, */
#define NEAR_LENGTH 1.5f
#define TOUCH_SHARE 1.2 /* and nearer than this share of the radius they are passed only if nothing else is left */
#define TOUCH_LENGTH 12.0f
#define UNSEEN_LENGTH 1.3f
#define WAY_STEPS 4

enum { UNSEEN = 0, FREE = 1, STANDS = 2 };

/* ---- the grid in the world ---- */

/* hypot is not the same number in each C library. */
static double length_of(double x, double y) { return sqrt(x * x + y * y); }

static double cell_m(const vista_planner *p) { return CELL_SHARE * p->radius_m; }

static void to_grid(const vista_planner *p, const double world_m[3], double at[2]) {
  for (int i = 0; i < 2; ++i) at[i] = vista_dot(p->level[i], world_m) / cell_m(p);
}

/* The memory of a cell: cells that lie a grid apart share it. */
static int32_t place_of(int32_t x, int32_t y) { return vista_modulo(x, GRID) + GRID * vista_modulo(y, GRID); }

static void mark(vista_planner *p, const double at[2], uint8_t kind, const vista_plan_state *state) {
  const int32_t x = (int32_t)floor(at[0]), y = (int32_t)floor(at[1]);
  p->cells[place_of(x, y)] = (vista_plan_cell){x, y, (float)vista_dot(state->up, state->position_m), kind, state->t_ns};
}

/* What was seen of a cell at about this height of the vehicle. */
static uint8_t kind_at(const vista_planner *p, int32_t x, int32_t y, double height_m, int64_t t_ns) {
  const vista_plan_cell *const cell = &p->cells[place_of(x, y)];
  if (cell->x != x || cell->y != y || vista_seconds_between(cell->t_ns, t_ns) > KEPT_S) return UNSEEN;
  return fabs(cell->height_m - height_m) < LEVEL_RADII * p->radius_m ? cell->kind : UNSEEN;
}

/* Any level axes: the world's own ones, as far as they are level. */
static void take_axes(vista_planner *p, const double up[3]) {
  int least = 0;
  for (int i = 1; i < 3; ++i)
    if (fabs(up[i]) < fabs(up[least])) least = i;
  double axis[3] = {0.0, 0.0, 0.0};
  axis[least] = 1.0;
  (void)vista_plan_level(up, axis, p->level[0]);
  vista_cross(up, p->level[0], p->level[1]);
}

/* ---- what is kept ---- */

typedef struct view {
  double from[2], ahead[2], right[2]; /* in cells; unit length */
} view;

static view view_of(const vista_planner *p, const vista_plan_space *space) {
  const vista_pose *const pose = &space->seen.frame->motion.pose;
  double ahead[3], right[3], world[3];
  view v;
  vista_frame_level_axes(space->directions.up_camera, ahead, right);
  to_grid(p, pose->translation_m, v.from);
  for (int i = 0; i < 3; ++i) world[i] = vista_dot(pose->rotation + 3 * i, ahead);
  for (int i = 0; i < 2; ++i) v.ahead[i] = vista_dot(p->level[i], world);
  for (int i = 0; i < 3; ++i) world[i] = vista_dot(pose->rotation + 3 * i, right);
  for (int i = 0; i < 2; ++i) v.right[i] = vista_dot(p->level[i], world);
  return v;
}

/* The level direction of a column, in the axes of the grid. */
static void along_column(const view *v, int32_t column, double along[2]) {
  const double azimuth = (VISTA_DIRECTIONS_FIRST_DEG + column + 0.5) * VISTA_RADIANS_PER_DEGREE;
  double c, s;
  vista_plan_sine_cosine(azimuth, &s, &c);
  for (int i = 0; i < 2; ++i) along[i] = c * v->ahead[i] + s * v->right[i];
}

static void mark_along(vista_planner *p, const view *v, const double along[2], double range, uint8_t kind,
                       const vista_plan_state *state) {
  const double at[2] = {v->from[0] + range * along[0], v->from[1] + range * along[1]};
  mark(p, at, kind, state);
}

void vista_plan_keep(vista_planner *p, const vista_plan_space *space, const vista_plan_state *state) {
  const vista_directions *const d = &space->directions;
  if (!p->has_level) take_axes(p, state->up);
  p->has_level = true;
  const view v = view_of(p, space);
  double at[2], along[2];
  to_grid(p, state->position_m, at);
  mark(p, at, FREE, state);
  for (int32_t k = 0; k < VISTA_DIRECTIONS; ++k) {
    const double ends = d->blocked_m[k] > 0.0f ? fmin(d->free_m[k], d->blocked_m[k]) : d->free_m[k];
    const double most = fmin(ends / cell_m(p), GRID / 2 - 1.0);
    along_column(&v, k, along);
    for (double range = 0.0; range < most; range += 0.5) mark_along(p, &v, along, range, FREE, state);
  }
  for (int32_t k = 0; k < VISTA_DIRECTIONS; ++k) {
    if (!(d->blocked_m[k] > 0.0f) || !(d->blocked_m[k] < cell_m(p) * (GRID / 2 - 1))) continue;
    along_column(&v, k, along);
    mark_along(p, &v, along, d->blocked_m[k] / cell_m(p), STANDS, state);
  }
}

/* ---- the ways ---- */

/* Makes the cells around one at which something stands longer. */
static void lengthen(vista_planner *p, int32_t x, int32_t y) {
  for (int32_t b = y - NEAR_CELLS < 0 ? 0 : y - NEAR_CELLS; b <= y + NEAR_CELLS && b < GRID; ++b)
    for (int32_t a = x - NEAR_CELLS < 0 ? 0 : x - NEAR_CELLS; a <= x + NEAR_CELLS && a < GRID; ++a) {
      const int32_t apart2 = (a - x) * (a - x) + (b - y) * (b - y);
      if (apart2 > NEAR_CELLS * NEAR_CELLS) continue;
      const bool touches = apart2 <= TOUCH_SHARE * TOUCH_SHARE / (CELL_SHARE * CELL_SHARE);
      p->length[b][a] = vista_larger(p->length[b][a], touches ? TOUCH_LENGTH : NEAR_LENGTH);
    }
}

static void lengths(vista_planner *p, const vista_plan_state *state) {
  const double height_m = vista_dot(state->up, state->position_m);
  uint8_t kinds[GRID][GRID];
  for (int32_t y = 0; y < GRID; ++y)
    for (int32_t x = 0; x < GRID; ++x) {
      kinds[y][x] = kind_at(p, p->first[0] + x, p->first[1] + y, height_m, state->t_ns);
      p->length[y][x] = kinds[y][x] == UNSEEN ? UNSEEN_LENGTH : 1.0f;
    }
  for (int32_t y = 0; y < GRID; ++y)
    for (int32_t x = 0; x < GRID; ++x)
      if (kinds[y][x] == STANDS) lengthen(p, x, y);
}

/* Where the ways end: at the goal, and at the rim of the grid, from where they lead straight to it. */
static void begin(vista_planner *p, const double goal[2]) {
  for (int32_t y = -1; y <= GRID; ++y)
    for (int32_t x = -1; x <= GRID; ++x) {
      const bool outside = x < 0 || y < 0 || x == GRID || y == GRID;
      const bool rim = x == 0 || y == 0 || x == GRID - 1 || y == GRID - 1;
      const double off_x = p->first[0] + x + 0.5 - goal[0], off_y = p->first[1] + y + 0.5 - goal[1];
      const bool ends = !outside && (rim || (fabs(off_x) < 1.0 && fabs(off_y) < 1.0));
      p->way[y + 1][x + 1] = ends ? (float)length_of(off_x, off_y) : VISTA_PLAN_WAY_FAR;
    }
}

void vista_plan_spread(vista_planner *p, const vista_plan_state *state, const double goal_m[3]) {
  double here[2], goal[2];
  to_grid(p, state->position_m, here);
  to_grid(p, goal_m, goal);
  for (int i = 0; i < 2; ++i) p->first[i] = (int32_t)floor(here[i]) - GRID / 2;
  lengths(p, state);
  begin(p, goal);
  vista_plan_sweep(p);
}

static int32_t within(double value) { return (int32_t)fmin(fmax(value, 0.0), GRID - 1.0); }

/* The way from a place, between the cells around it. */
static double way_from(const vista_planner *p, const double at[2]) {
  const double x = at[0] - p->first[0] - 0.5, y = at[1] - p->first[1] - 0.5;
  const int32_t left = within(floor(x)), low = within(floor(y)), right = within(left + 1.0), high = within(low + 1.0);
  const double a = fmin(fmax(x - left, 0.0), 1.0), b = fmin(fmax(y - low, 0.0), 1.0);
  const float (*const way)[GRID + 2] = p->way;
  return (1.0 - b) * ((1.0 - a) * way[low + 1][left + 1] + a * way[low + 1][right + 1]) +
         b * ((1.0 - a) * way[high + 1][left + 1] + a * way[high + 1][right + 1]);
}

/* The level direction in which the way from a place goes on, in the axes of the grid: towards the nearer neighbours, since
 * between two ways that are as long as each other the difference of both sides would lead along neither. False: it ends
 * there. */
static bool goes_on_to(const vista_planner *p, const double at[2], double ahead[2]) {
  const double here = way_from(p, at);
  for (int i = 0; i < 2; ++i) {
    double before[2] = {at[0], at[1]}, after[2] = {at[0], at[1]};
    before[i] -= 1.0;
    after[i] += 1.0;
    const double back = here - way_from(p, before), on = here - way_from(p, after);
    ahead[i] = fmax(back, on) <= 0.0 ? 0.0 : on >= back ? on : -back;
  }
  const double length = length_of(ahead[0], ahead[1]);
  for (int i = 0; i < 2; ++i) ahead[i] /= fmax(length, 1e-6);
  return length > 1e-3;
}

vista_plan_way vista_plan_way_along(const vista_planner *p, const double from_m[3], const double level[3],
                                    double most_m) {
  vista_plan_way found = {.length_m = INFINITY};
  double at[2], direction[2], ahead[2], flown = 0.0;
  to_grid(p, from_m, at);
  for (int i = 0; i < 2; ++i) direction[i] = vista_dot(p->level[i], level);
  const double step = most_m / cell_m(p) / WAY_STEPS;
  for (int32_t k = 1; k <= WAY_STEPS; ++k) {
    for (int i = 0; i < 2; ++i) at[i] += step * direction[i];
    flown += step * p->length[within(floor(at[1] - p->first[1]))][within(floor(at[0] - p->first[0]))];
    const double length_m = cell_m(p) * (flown + way_from(p, at));
    if (!(length_m < found.length_m)) continue;
    found.length_m = length_m;
    found.turn = goes_on_to(p, at, ahead) ? length_of(direction[0] - ahead[0], direction[1] - ahead[1]) : 0.0;
  }
  return found;
}
