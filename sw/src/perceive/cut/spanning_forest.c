#include "perceive/cut/spanning_forest.h"

#include <stdbool.h>
#include <stddef.h>

vista_status vista_spanning_forest_layout(const vista_graph *graph, vista_arena *arena, vista_spanning_forest *forest) {
  const size_t nodes = (size_t)graph->node_count;
  forest->heap = vista_arena_take(arena, nodes, sizeof(int32_t));
  forest->place = vista_arena_take(arena, nodes, sizeof(int32_t));
  forest->link = vista_arena_take(arena, nodes, sizeof(int32_t));
  forest->side = vista_arena_take(arena, nodes, sizeof(uint8_t));
  return VISTA_OK;
}

static bool before(const vista_spanning_forest *f, int32_t a, int32_t b) {
  if (f->link[a] != f->link[b]) return f->link[a] > f->link[b];
  return f->side[a] != f->side[b] ? f->side[a] < f->side[b] : a < b;
}

static void put(vista_spanning_forest *f, int32_t place, int32_t node) {
  f->heap[place - 1] = node;
  f->place[node] = place;
}

static void rise(vista_spanning_forest *f, int32_t node) {
  int32_t place = f->place[node];
  for (; place > 1 && before(f, node, f->heap[place / 2 - 1]); place /= 2) put(f, place, f->heap[place / 2 - 1]);
  put(f, place, node);
}

static int32_t take_first(vista_spanning_forest *f, int32_t *count) {
  const int32_t first = f->heap[0], node = f->heap[--*count];
  int32_t place = 1;
  for (int32_t below; (below = 2 * place) <= *count; place = below) {
    if (below < *count && before(f, f->heap[below], f->heap[below - 1])) below++;
    if (!before(f, f->heap[below - 1], node)) break;
    put(f, place, f->heap[below - 1]);
  }
  if (*count > 0) put(f, place, node);
  f->place[first] = 0;
  return first;
}

/* A link of that strength to what is on that side. */
static void offer(vista_spanning_forest *f, int32_t node, int32_t link, uint8_t side) {
  if (link < f->link[node] || (link == f->link[node] && side >= f->side[node])) return;
  f->link[node] = link;
  f->side[node] = side;
  rise(f, node);
}

void vista_spanning_forest_grow(vista_spanning_forest *forest, const vista_graph *graph,
                                const vista_forest_problem *problem, uint8_t *source_side) {
  vista_spanning_forest *const f = forest;
  int32_t count = 0;
  for (int32_t k = 0; k < problem->subset_count; ++k) {
    const int32_t node = problem->subset[k];
    f->link[node] = problem->sink_link[node];
    f->side[node] = 0;
    put(f, ++count, node);
    rise(f, node);
    offer(f, node, problem->source_link[node], 1);
  }
  while (count > 0) {
    const int32_t node = take_first(f, &count);
    source_side[node] = f->side[node];
    for (int32_t arc = graph->first_arc[node]; arc < graph->first_arc[node + 1]; ++arc) {
      const int32_t other = graph->head[arc];
      if (problem->arc_link[arc] > 0 && f->place[other] > 0) offer(f, other, problem->arc_link[arc], f->side[node]);
    }
  }
}
