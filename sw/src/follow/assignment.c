#include "follow/assignment.h"

#include <math.h>
#include <stdbool.h>

/* A cost is a pair, compared by its first member first: the number of forbidden pairs in the assignment, then the
 * sum of costs. Pairs form an ordered group, which is all that the Hungarian method asks for; a large number in the
 * place of "forbidden" would cost the precision of the real costs. */
typedef struct weight {
  int32_t forbidden;
  double cost;
} weight;

struct vista_assignment {
  int32_t max_rows, max_columns;
  /* The shorter side is assigned one item at a time; index 0 of each array stands for "none". */
  weight *short_potential, *long_potential;
  weight *slack;      /* smallest reduced cost to each long item found so far */
  int32_t *match;     /* short item at each long item, 0 = none */
  int32_t *previous;  /* long item before this one on the path */
  bool *visited;
};

static weight plus(weight a, weight b) { return (weight){a.forbidden + b.forbidden, a.cost + b.cost}; }
static weight minus(weight a, weight b) { return (weight){a.forbidden - b.forbidden, a.cost - b.cost}; }
static bool less(weight a, weight b) {
  return a.forbidden != b.forbidden ? a.forbidden < b.forbidden : a.cost < b.cost;
}

vista_status vista_assignment_layout(int32_t max_rows, int32_t max_columns, vista_arena *arena,
                                     vista_assignment **assignment) {
  *assignment = NULL;
  if (max_rows < 1 || max_rows > VISTA_ASSIGNMENT_MAX || max_columns < 1 || max_columns > VISTA_ASSIGNMENT_MAX)
    return VISTA_ERROR_RANGE;
  const size_t shorter = (size_t)(max_rows < max_columns ? max_rows : max_columns) + 1;
  const size_t longer = (size_t)(max_rows < max_columns ? max_columns : max_rows) + 1;
  vista_assignment *made = vista_arena_take(arena, 1, sizeof *made);
  const vista_assignment arrays = {.max_rows = max_rows,
                                   .max_columns = max_columns,
                                   .short_potential = vista_arena_take(arena, shorter, sizeof(weight)),
                                   .long_potential = vista_arena_take(arena, longer, sizeof(weight)),
                                   .slack = vista_arena_take(arena, longer, sizeof(weight)),
                                   .match = vista_arena_take(arena, longer, sizeof(int32_t)),
                                   .previous = vista_arena_take(arena, longer, sizeof(int32_t)),
                                   .visited = vista_arena_take(arena, longer, sizeof(bool))};
  if (arena->base == NULL) return VISTA_OK;
  if (arena->used > arena->size) return VISTA_ERROR_MEMORY;
  *made = arrays;
  *assignment = made;
  return VISTA_OK;
}

typedef struct problem {
  const double *cost;
  int32_t shorter, longer;
  size_t short_step, long_step; /* in cost, from one item to the next */
} problem;

static weight pair_weight(const problem *p, int32_t s, int32_t l) {
  const double cost = p->cost[(size_t)(s - 1) * p->short_step + (size_t)(l - 1) * p->long_step];
  return isinf(cost) ? (weight){1, 0.0} : (weight){0, cost};
}

/* Grow a tree of tight pairs from short item s until it meets a free long item, then flip the path to it. */
static void augment(vista_assignment *a, const problem *p, int32_t s) {
  const weight infinite = {INT32_MAX, 0.0};
  for (int32_t l = 0; l <= p->longer; ++l) {
    a->slack[l] = infinite;
    a->visited[l] = false;
  }
  a->match[0] = s;
  int32_t here = 0;
  do {
    a->visited[here] = true;
    const int32_t from = a->match[here];
    int32_t next = 0;
    weight step = infinite;
    for (int32_t l = 1; l <= p->longer; ++l) {
      if (a->visited[l]) continue;
      const weight reduced = minus(minus(pair_weight(p, from, l), a->short_potential[from]), a->long_potential[l]);
      if (less(reduced, a->slack[l])) {
        a->slack[l] = reduced;
        a->previous[l] = here;
      }
      if (less(a->slack[l], step)) {
        step = a->slack[l];
        next = l;
      }
    }
    for (int32_t l = 0; l <= p->longer; ++l) {
      if (a->visited[l]) {
        a->short_potential[a->match[l]] = plus(a->short_potential[a->match[l]], step);
        a->long_potential[l] = minus(a->long_potential[l], step);
      } else {
        a->slack[l] = minus(a->slack[l], step);
      }
    }
    here = next;
  } while (a->match[here] != 0);
  for (; here != 0; here = a->previous[here]) a->match[here] = a->match[a->previous[here]];
}

vista_status vista_assignment_solve(vista_assignment *assignment, const double *cost, int32_t rows, int32_t columns,
                                    int32_t *column_of_row) {
  if (rows < 0 || columns < 0) return VISTA_ERROR_SIZE;
  if (rows > assignment->max_rows || columns > assignment->max_columns) return VISTA_ERROR_CAPACITY;
  const size_t items = (size_t)rows * (size_t)columns;
  for (size_t i = 0; i < items; ++i)
    if (isnan(cost[i]) || cost[i] == -INFINITY) return VISTA_ERROR_NUMBER;
  const bool by_row = rows <= columns;
  const problem p = {.cost = cost,
                     .shorter = by_row ? rows : columns,
                     .longer = by_row ? columns : rows,
                     .short_step = by_row ? (size_t)columns : 1,
                     .long_step = by_row ? 1 : (size_t)columns};
  for (int32_t s = 0; s <= p.shorter; ++s) assignment->short_potential[s] = (weight){0, 0.0};
  for (int32_t l = 0; l <= p.longer; ++l) {
    assignment->long_potential[l] = (weight){0, 0.0};
    assignment->match[l] = 0;
  }
  for (int32_t s = 1; s <= p.shorter; ++s) augment(assignment, &p, s);
  for (int32_t i = 0; i < rows; ++i) column_of_row[i] = -1;
  for (int32_t l = 1; l <= p.longer; ++l) {
    const int32_t s = assignment->match[l];
    if (s == 0 || pair_weight(&p, s, l).forbidden) continue;
    if (by_row)
      column_of_row[s - 1] = l - 1;
    else
      column_of_row[l - 1] = s - 1;
  }
  return VISTA_OK;
}
