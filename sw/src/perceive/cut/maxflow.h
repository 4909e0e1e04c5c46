/* Minimum cut between two terminals by augmenting paths, with two search trees (Boykov and Kolmogorov, "An experimental
 * comparison of min-cut/max-flow algorithms for energy minimization in vision", PAMI 26(9), 2004, section 3).
 *
 * The network is the subgraph induced by a subset of the nodes of a vista_graph, plus the terminals S and T:
 *   arc_capacity[a]     capacity of arc a of the graph (the two arcs of an edge may differ)
 *   source_capacity[v]  capacity of S -> v
 *   sink_capacity[v]    capacity of v -> T
 * Arcs with an end outside the subset do not exist. The labels are those of residual reachability, which are unique:
 * they do not depend on the solver nor on the order of nodes and arcs. Everything is integer and deterministic. */
#ifndef VISTA_MAXFLOW_H
#define VISTA_MAXFLOW_H

#include <stdint.h>

#include "common/arena.h"
#include "common/graph.h"
#include "vista/status.h"

#define VISTA_MAXFLOW_ARC_CAPACITY_MAX \
  (INT32_MAX / 2) /* 2^30 - 1: an arc can then take up all that its sister carries */

struct vista_maxflow_branch;

/* Solver state for one graph, used again from cut to cut; its arrays are private to the solver. Between calls no node
 * is marked, so that the cost of a call depends on its subset and not on the graph. */
typedef struct vista_maxflow {
  vista_graph graph;
  struct vista_maxflow_branch *branches; /* node_count */
  int32_t *residual; /* arc_count + node_count */
  int32_t *next_active; /* node_count */
  int32_t *orphans; /* node_count */
  int32_t *opened; /* node_count */
  uint16_t *tree; /* node_count */
} vista_maxflow;

typedef struct vista_maxflow_problem {
  const int32_t *arc_capacity; /* arc_count, 0 .. VISTA_MAXFLOW_ARC_CAPACITY_MAX */
  const int32_t *source_capacity; /* node_count, 0 .. INT32_MAX */
  const int32_t *sink_capacity; /* node_count, 0 .. INT32_MAX */
  const int32_t *subset; /* subset_count distinct nodes; null: all nodes */
  int32_t subset_count; /* ignored when subset is null */
  /* Null: the subset is the network. Else the network grows: its other nodes join it when the search comes to them, and
   * before anything of a node is read, open(context, node) fills in its capacities and those of the arcs out of it,
   * which are 0 where they lead out of the network. The subset is then all whose source capacity is the larger. */
  void (*open)(void *context, int32_t node);
  void *context;
} vista_maxflow_problem;

/* Lays out the solver for a graph, whose arrays must outlive it. When the arena counts, only the graph's counts are
 * read.
 *
 * VISTA_ERROR_RANGE     edges and nodes together exceed 2^30
 * VISTA_ERROR_MEMORY    the arena is too small */
vista_status vista_maxflow_layout(vista_maxflow *maxflow, const vista_graph *graph, vista_arena *arena);

/* Computes the maximum flow and the labels of the subset's nodes; entries of other nodes are neither read nor written:
 *   source_side[v] = 1 if v can be reached from S in the residual graph, else 0   (the smallest source side)
 *   sink_side[v]   = 1 if T can be reached from v in the residual graph, else 0   (null: not wanted)
 * *value is the flow, equal to the weight of the cut around either side; where the network grows, without that which
 * runs S -> v -> T through nodes that the search does not come to.
 *
 * Without sink_side only the source side is searched for, which is often far less work. Capacities are checked for
 * the nodes of the subset and all arcs out of them. On an error nothing is written:
 * VISTA_ERROR_ARGUMENT  sink_side is not null where the network grows
 * VISTA_ERROR_RANGE     a negative capacity or count; a node that is outside the graph or twice in the subset
 * VISTA_ERROR_OVERFLOW  an arc capacity above VISTA_MAXFLOW_ARC_CAPACITY_MAX */
vista_status vista_maxflow_solve(vista_maxflow *maxflow, const vista_maxflow_problem *problem, uint8_t *source_side,
                                 uint8_t *sink_side, int64_t *value);

#endif
