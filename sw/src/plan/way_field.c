#include "plan/way_field.h"

#include <math.h>
#include <string.h>

#include "common/frame.h"
#include "common/numbers.h"
#include "plan/primitives.h"

#define GRID VISTA_PLAN_GRID
#define CELL_SHARE 0.5 /* of the radius: the side of a cell */
#define KEPT_NS INT64_C(60000000000)
#define LEVEL_RADII 2.0 /* what was seen from farther above or below is on another way */
#define NEAR_CELLS 4    /* around what stands: this far, cells are longer to pass, */
#define NEAR_LENGTH 1.5
#define TOUCH_SHARE 1.2 /* and nearer than this share of the radius they are passed only if nothing else is left */
#define TOUCH_LENGTH 12.0
#define UNSEEN_LENGTH 1.3
#define ROUNDS 4 /* of four sweeps each, at most */
#define WAY_STEPS 4
#define FAR_M 1e9

enum { UNSEEN = 0, FREE = 1, STANDS = 2 };

/* ---- the grid in the world ---- */

static double cell_m(const vista_planner *p) { return CELL_SHARE * p->radius_m; }

static void to_grid(const vista_planner *p, const double world_m[3], double at[2]) {
  for (int i = 0; i < 2; ++i) at[i] = vista_dot(p->level[i], world_m) / cell_m(p);
}

/* The memory of a cell: cells that lie a grid apart share it. */
static int32_t place_of(int32_t x, int32_t y) { return (int32_t)((uint32_t)x % GRID + GRID * ((uint32_t)y % GRID)); }

static void mark(vista_planner *p, const double at[2], uint8_t kind, const vista_plan_state *state) {
  const int32_t x = (int32_t)floor(at[0]), y = (int32_t)floor(at[1]);
  p->cells[place_of(x, y)] = (vista_plan_cell){x, y, (float)vista_dot(state->up, state->position_m), kind, state->t_ns};
}

static uint8_t kind_at(const vista_planner *p, int32_t x, int32_t y, const vista_plan_state *state) {
  const vista_plan_cell *const cell = &p->cells[place_of(x, y)];
  if (cell->x != x || cell->y != y || cell->kind == UNSEEN || state->t_ns - cell->t_ns > KEPT_NS) return UNSEEN;
  const double apart_m = fabs(cell->height_m - vista_dot(state->up, state->position_m));
  return apart_m < LEVEL_RADII * p->radius_m ? cell->kind : UNSEEN;
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

static void along_column(const view *v, int32_t column, double range, double at[2]) {
  const double azimuth = (VISTA_DIRECTIONS_FIRST_DEG + column + 0.5) * VISTA_RADIANS_PER_DEGREE;
  for (int i = 0; i < 2; ++i) at[i] = v->from[i] + range * (cos(azimuth) * v->ahead[i] + sin(azimuth) * v->right[i]);
}

void vista_plan_keep(vista_planner *p, const vista_plan_space *space, const vista_plan_state *state) {
  const vista_directions *const d = &space->directions;
  if (!p->has_level) take_axes(p, state->up);
  p->has_level = true;
  const view v = view_of(p, space);
  double at[2];
  to_grid(p, state->position_m, at);
  mark(p, at, FREE, state);
  for (int32_t k = 0; k < VISTA_DIRECTIONS; ++k) {
    const double ends = d->blocked_m[k] > 0.0f ? fmin(d->free_m[k], d->blocked_m[k]) : d->free_m[k];
    const double most = fmin(ends / cell_m(p), GRID / 2 - 1.0);
    for (double range = 0.0; range < most; range += 0.5) {
      along_column(&v, k, range, at);
      mark(p, at, FREE, state);
    }
  }
  for (int32_t k = 0; k < VISTA_DIRECTIONS; ++k) {
    if (!(d->blocked_m[k] > 0.0f) || !(d->blocked_m[k] < cell_m(p) * (GRID / 2 - 1))) continue;
    along_column(&v, k, d->blocked_m[k] / cell_m(p), at);
    mark(p, at, STANDS, state);
  }
}

/* ---- the ways ---- */

/* How long a way through each cell is, in its sides. */
static void lengths(vista_planner *p, const vista_plan_state *state) {
  float (*const length)[GRID] = p->length;
  for (int32_t y = 0; y < GRID; ++y)
    for (int32_t x = 0; x < GRID; ++x)
      length[y][x] = kind_at(p, p->first[0] + x, p->first[1] + y, state) == UNSEEN ? (float)UNSEEN_LENGTH : 1.0f;
  const double touch2 = vista_square(TOUCH_SHARE / CELL_SHARE);
  for (int32_t y = 0; y < GRID; ++y)
    for (int32_t x = 0; x < GRID; ++x) {
      if (kind_at(p, p->first[0] + x, p->first[1] + y, state) != STANDS) continue;
      for (int32_t b = -NEAR_CELLS; b <= NEAR_CELLS; ++b)
        for (int32_t a = -NEAR_CELLS; a <= NEAR_CELLS; ++a) {
          if (x + a < 0 || x + a >= GRID || y + b < 0 || y + b >= GRID) continue;
          const int32_t apart2 = a * a + b * b;
          if (apart2 <= touch2)
            length[y + b][x + a] = vista_larger(length[y + b][x + a], (float)TOUCH_LENGTH);
          else if (apart2 <= NEAR_CELLS * NEAR_CELLS)
            length[y + b][x + a] = vista_larger(length[y + b][x + a], (float)NEAR_LENGTH);
        }
    }
}

/* The length at a cell from that at its neighbours: |grad way| = length. */
static double solved(double a, double b, double length) {
  const double low = fmin(a, b), apart = fabs(a - b);
  if (apart >= length) return low + length;
  return 0.5 * (a + b + sqrt(2.0 * length * length - apart * apart));
}

static double way_at(const vista_planner *p, int32_t x, int32_t y) {
  return x < 0 || y < 0 || x >= GRID || y >= GRID ? FAR_M : (double)p->way[y][x];
}

static bool sweep(vista_planner *p, int32_t turn) {
  bool changed = false;
  for (int32_t j = 0; j < GRID; ++j)
    for (int32_t i = 0; i < GRID; ++i) {
      const int32_t x = turn & 1 ? GRID - 1 - i : i, y = turn & 2 ? GRID - 1 - j : j;
      const double a = fmin(way_at(p, x - 1, y), way_at(p, x + 1, y));
      const double b = fmin(way_at(p, x, y - 1), way_at(p, x, y + 1));
      const float found = (float)solved(a, b, p->length[y][x]);
      if (found < p->way[y][x] - 1e-3f) {
        p->way[y][x] = found;
        changed = true;
      }
    }
  return changed;
}

void vista_plan_spread(vista_planner *p, const vista_plan_state *state, const double goal_m[3]) {
  double here[2], goal[2];
  to_grid(p, state->position_m, here);
  to_grid(p, goal_m, goal);
  for (int i = 0; i < 2; ++i) p->first[i] = (int32_t)floor(here[i]) - GRID / 2;
  lengths(p, state);
  for (int32_t y = 0; y < GRID; ++y)
    for (int32_t x = 0; x < GRID; ++x) {
      const double off = hypot(p->first[0] + x + 0.5 - goal[0], p->first[1] + y + 0.5 - goal[1]);
      const bool rim = x == 0 || y == 0 || x == GRID - 1 || y == GRID - 1;
      p->way[y][x] = (float)(off < 1.0 || rim ? off : FAR_M);
    }
  for (int32_t k = 0; k < ROUNDS; ++k) {
    bool changed = false;
    for (int32_t turn = 0; turn < 4; ++turn) changed |= sweep(p, turn);
    if (!changed) break;
  }
}

static int32_t within(double value) { return (int32_t)fmin(fmax(value, 0.0), GRID - 1.0); }

/* The way from a place, between the cells around it. */
static double way_from(const vista_planner *p, const double at[2]) {
  const double x = at[0] - p->first[0] - 0.5, y = at[1] - p->first[1] - 0.5;
  const int32_t left = within(floor(x)), low = within(floor(y)), right = within(left + 1.0), high = within(low + 1.0);
  const double a = fmin(fmax(x - left, 0.0), 1.0), b = fmin(fmax(y - low, 0.0), 1.0);
  return (1.0 - b) * ((1.0 - a) * p->way[low][left] + a * p->way[low][right]) +
         b * ((1.0 - a) * p->way[high][left] + a * p->way[high][right]);
}

/* The level direction in which the way from a place goes on, in the axes of the grid. False: it ends there. */
static bool goes_on_to(const vista_planner *p, const double at[2], double ahead[2]) {
  for (int i = 0; i < 2; ++i) {
    double before[2] = {at[0], at[1]}, after[2] = {at[0], at[1]};
    before[i] -= 1.0;
    after[i] += 1.0;
    ahead[i] = way_from(p, before) - way_from(p, after);
  }
  const double length = hypot(ahead[0], ahead[1]);
  for (int i = 0; i < 2; ++i) ahead[i] /= fmax(length, 1e-6);
  return length > 1e-3;
}

vista_plan_way vista_plan_way_along(const vista_planner *p, const double from_m[3], const double level[3],
                                    double most_m) {
  vista_plan_way found = {FAR_M, 0.0};
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
    found.turn = goes_on_to(p, at, ahead) ? hypot(direction[0] - ahead[0], direction[1] - ahead[1]) : 0.0;
  }
  return found;
}
