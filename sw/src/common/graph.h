/* The topology that all cuts of a camera share: an undirected graph stored as half-edges ("arcs") sorted by tail.
 *
 * Edge e = {u, v} becomes the arc u -> v, number edge_arc[e], and its sister v -> u, number reverse[edge_arc[e]].
 * The arcs out of node v are first_arc[v] .. first_arc[v + 1] - 1, in the order of the edge list. Weights are not
 * part of the topology: they come as arrays over arcs, so that one graph serves every frame. */
#ifndef VISTA_GRAPH_H
#define VISTA_GRAPH_H

#include <stdint.h>

#include "common/arena.h"
#include "vista/status.h"

typedef struct vista_graph {
  int32_t node_count;
  int32_t edge_count;
  int32_t arc_count;        /* 2 * edge_count */
  const int32_t *first_arc; /* node_count + 1 */
  const int32_t *head;      /* arc_count: node that the arc points to */
  const int32_t *reverse;   /* arc_count: sister arc */
  const int32_t *edge_arc;  /* edge_count: the arc edges[2 e] -> edges[2 e + 1] */
} vista_graph;

/* Builds the graph of `edge_count` undirected edges; edges holds the end nodes (u0, v0, u1, v1, ...).
 * Parallel edges are allowed and keep their own arcs, so their capacities add up; self loops are not.
 * When the arena only counts, edges is not read and the arrays of *graph stay null.
 *
 * VISTA_ERROR_RANGE     node_count < 1, edge_count outside 0 .. 2^30 - 1, an end node outside the graph, a self loop
 * VISTA_ERROR_MEMORY    the arena is too small */
vista_status vista_graph_build(vista_graph *graph, vista_arena *arena, int32_t node_count, const int32_t *edges,
                               int32_t edge_count);

#endif
