#include "common/graph.h"

#include <stdbool.h>
#include <stddef.h>

#define MAX_EDGES ((int32_t)((1u << 30) - 1)) /* arc numbers fit int32_t */

static bool edges_are_valid(const int32_t *edges, int32_t edge_count, int32_t node_count) {
  for (int32_t e = 0; e < edge_count; e++) {
    const int32_t u = edges[2 * (size_t)e], v = edges[2 * (size_t)e + 1];
    if (u < 0 || u >= node_count || v < 0 || v >= node_count || u == v) return false;
  }
  return true;
}

/* Counting sort of the half-edges by tail. first_arc enters zeroed; while arcs are placed, first_arc[v] is the next
 * free place of v, so it ends one node ahead and is shifted back. */
static void sort_half_edges(const int32_t *edges, int32_t edge_count, int32_t node_count, int32_t *first_arc,
                            int32_t *head, int32_t *reverse, int32_t *edge_arc) {
  const size_t ends = 2 * (size_t)edge_count;
  for (size_t k = 0; k < ends; k++) first_arc[edges[k] + 1]++;
  for (int32_t v = 0; v < node_count; v++) first_arc[v + 1] += first_arc[v];
  for (int32_t e = 0; e < edge_count; e++) {
    const int32_t u = edges[2 * (size_t)e], v = edges[2 * (size_t)e + 1];
    const int32_t arc = first_arc[u]++, sister = first_arc[v]++;
    head[arc] = v;
    head[sister] = u;
    reverse[arc] = sister;
    reverse[sister] = arc;
    edge_arc[e] = arc;
  }
  for (int32_t v = node_count; v > 0; v--) first_arc[v] = first_arc[v - 1];
  first_arc[0] = 0;
}

vista_status vista_graph_build(vista_graph *graph, vista_arena *arena, int32_t node_count, const int32_t *edges,
                               int32_t edge_count) {
  if (node_count < 1 || edge_count < 0 || edge_count > MAX_EDGES) return VISTA_ERROR_RANGE;

  const size_t nodes = (size_t)node_count, arcs = 2 * (size_t)edge_count;
  int32_t *first_arc = vista_arena_take(arena, nodes + 1, sizeof *first_arc);
  int32_t *head = vista_arena_take(arena, arcs, sizeof *head);
  int32_t *reverse = vista_arena_take(arena, arcs, sizeof *reverse);
  int32_t *edge_arc = vista_arena_take(arena, (size_t)edge_count, sizeof *edge_arc);
  *graph = (vista_graph){.node_count = node_count, .edge_count = edge_count, .arc_count = 2 * edge_count};
  if (arena->base == NULL) return VISTA_OK;
  if (arena->used > arena->size) return VISTA_ERROR_MEMORY;

  if (!edges_are_valid(edges, edge_count, node_count)) return VISTA_ERROR_RANGE;
  sort_half_edges(edges, edge_count, node_count, first_arc, head, reverse, edge_arc);
  graph->first_arc = first_arc;
  graph->head = head;
  graph->reverse = reverse;
  graph->edge_arc = edge_arc;
  return VISTA_OK;
}
