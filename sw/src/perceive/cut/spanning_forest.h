/* A maximum spanning forest between two terminals, internal to libvista: what a minimum cut is compared with.
 *
 * Every node of a subset joins the terminal at the root of its tree in the maximum spanning tree of the subset and the
 * two terminals, which count as one root (Prim 1957; Couprie et al., "Power watershed", PAMI 33(7), 2011): the
 * strongest of the weakest links on the way to either decides, however few of them there are. Of equal links, the one
 * to T. */
#ifndef VISTA_SRC_SPANNING_FOREST_H
#define VISTA_SRC_SPANNING_FOREST_H

#include <stdint.h>

#include "common/arena.h"
#include "common/graph.h"
#include "vista/status.h"

typedef struct vista_spanning_forest {
  int32_t *heap;  /* node_count: nodes, the strongest link first */
  int32_t *place; /* node_count: in the heap, from 1; 0: in none */
  int32_t *link;  /* node_count: the strongest link to what has grown */
  uint8_t *side;  /* node_count: of that link, 1: S */
} vista_spanning_forest;

/* What is linked, in the terms of vista_maxflow_problem; of several links between two nodes each stands for itself. */
typedef struct vista_forest_problem {
  const int32_t *arc_link;    /* arc_count; 0: none */
  const int32_t *source_link; /* node_count */
  const int32_t *sink_link;   /* node_count */
  const int32_t *subset;      /* subset_count distinct nodes; no arc of theirs leads out of it */
  int32_t subset_count;
} vista_forest_problem;

vista_status vista_spanning_forest_layout(const vista_graph *graph, vista_arena *arena, vista_spanning_forest *forest);

/* source_side[v] of each node of the subset: 1 if it joins S, 0 if it joins T or has no link to either. */
void vista_spanning_forest_grow(vista_spanning_forest *forest, const vista_graph *graph,
                                const vista_forest_problem *problem, uint8_t *source_side);

#endif
