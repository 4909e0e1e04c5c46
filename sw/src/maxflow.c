/* Two search trees grow towards each other, one rooted at S and one at T, over arcs with residual capacity r > 0:
 *
 *   growth        an active node p takes its free neighbours q as children (S tree: r(p,q) > 0; T tree: r(q,p) > 0);
 *                 a neighbour in the other tree closes a path S -> ... -> T
 *   augmentation  the bottleneck f is pushed along that path; r(p,q) -= f and r(q,p) += f on each arc. Children whose
 *                 arc to their parent is now saturated become orphans
 *   adoption      each orphan looks for another parent of its tree that still descends from the terminal; if there is
 *                 none it becomes free, its children become orphans, and neighbours that could reach it become active
 *
 * When no node is active, no residual arc leaves the S tree and none enters the T tree: the flow is maximal, the S
 * tree is the set reachable from S and the T tree the set that reaches T.
 *
 * Does a candidate parent descend from the terminal? Walking to the root answers, and the nodes on the way are stamped
 * with the number of the augmentation and their distance to the root, so that later walks stop early. Among several
 * parents the one nearest to its root is taken, which keeps paths short.
 *
 * Each arc carries the residuals of both directions, its sister the same two swapped: scanning a node in either tree
 * reads one run of memory, for a grid node one cache line, and only augmentation pays for the copy. */
#include "vista/maxflow.h"

#include <stdbool.h>
#include <stddef.h>

enum { OUTSIDE, FREE, SOURCE_TREE, SINK_TREE }; /* OUTSIDE is 0: zeroed memory marks no node */
enum { NO_ARC = -1, TO_TERMINAL = -2 };         /* parents that are not arcs; NO_ARC: free or orphan */
enum { NO_NODE = -1 };

typedef struct vista_maxflow_node {
  int32_t parent;      /* arc from this node to its parent, or TO_TERMINAL, or NO_ARC */
  int32_t tree;        /* OUTSIDE between calls */
  int32_t first_arc;   /* copied from the graph, to have it beside the rest */
  int32_t terminal;    /* > 0: residual of S -> node, < 0: minus the residual of node -> T */
  int32_t next_active; /* NO_NODE: not queued; the last of the queue points to itself */
  int32_t distance;    /* arcs to the terminal, true at the augmentation number `stamp` */
  uint32_t stamp;
  int32_t end_arc;
} node;

typedef struct vista_maxflow_arc {
  int32_t head;
  int32_t reverse;
  int32_t residual;     /* tail -> head */
  int32_t residual_in;  /* head -> tail */
} arc;

typedef struct search {
  node *nodes;
  arc *arcs;
  int32_t *orphans;
  int32_t node_count; /* size of the ring of orphans */
  int32_t orphan_first, orphan_count;
  int32_t active_first, active_last;
  uint32_t augmentations;
  int64_t flow;
} search;

static void activate(search *s, int32_t v) {
  if (s->nodes[v].next_active != NO_NODE) return;
  s->nodes[v].next_active = v;
  if (s->active_first == NO_NODE) {
    s->active_first = v;
  } else {
    s->nodes[s->active_last].next_active = v;
  }
  s->active_last = v;
}

static int32_t next_active(search *s) {
  const int32_t v = s->active_first;
  if (v == NO_NODE) return NO_NODE;
  const int32_t next = s->nodes[v].next_active;
  s->active_first = next == v ? NO_NODE : next;
  s->nodes[v].next_active = NO_NODE;
  return v;
}

static void push_orphan(search *s, int32_t v) {
  s->nodes[v].parent = NO_ARC;
  int32_t last = s->orphan_first + s->orphan_count++;
  if (last >= s->node_count) last -= s->node_count;
  s->orphans[last] = v;
}

/* Orphans nearest to the root first: their descendants then find out early whether the branch survives. */
static void push_orphan_first(search *s, int32_t v) {
  s->nodes[v].parent = NO_ARC;
  s->orphan_first = (s->orphan_first == 0 ? s->node_count : s->orphan_first) - 1;
  s->orphan_count++;
  s->orphans[s->orphan_first] = v;
}

static int32_t pop_orphan(search *s) {
  const int32_t v = s->orphans[s->orphan_first];
  s->orphan_first = s->orphan_first + 1 == s->node_count ? 0 : s->orphan_first + 1;
  s->orphan_count--;
  return v;
}

static void push(arc *arcs, int32_t a, int32_t flow) {
  arc *forward = &arcs[a], *backward = &arcs[forward->reverse];
  forward->residual -= flow;
  forward->residual_in += flow;
  backward->residual += flow;
  backward->residual_in -= flow;
}

/* Pushes the bottleneck along S -> ... -> tail(bridge) -> head(bridge) -> ... -> T. */
static void augment(search *s, int32_t bridge) {
  node *nodes = s->nodes;
  arc *arcs = s->arcs;
  const int32_t source_end = arcs[arcs[bridge].reverse].head, sink_end = arcs[bridge].head;

  int32_t flow = arcs[bridge].residual;
  int32_t v = source_end;
  for (int32_t a; (a = nodes[v].parent) != TO_TERMINAL; v = arcs[a].head) {
    if (arcs[a].residual_in < flow) flow = arcs[a].residual_in;
  }
  if (nodes[v].terminal < flow) flow = nodes[v].terminal;
  v = sink_end;
  for (int32_t a; (a = nodes[v].parent) != TO_TERMINAL; v = arcs[a].head) {
    if (arcs[a].residual < flow) flow = arcs[a].residual;
  }
  if (-nodes[v].terminal < flow) flow = -nodes[v].terminal;

  push(arcs, bridge, flow);
  v = source_end;
  for (int32_t a; (a = nodes[v].parent) != TO_TERMINAL;) {
    const int32_t parent = arcs[a].head;
    push(arcs, arcs[a].reverse, flow);
    if (arcs[a].residual_in == 0) push_orphan_first(s, v);
    v = parent;
  }
  nodes[v].terminal -= flow;
  if (nodes[v].terminal == 0) push_orphan_first(s, v);
  v = sink_end;
  for (int32_t a; (a = nodes[v].parent) != TO_TERMINAL;) {
    const int32_t parent = arcs[a].head;
    push(arcs, a, flow);
    if (arcs[a].residual == 0) push_orphan_first(s, v);
    v = parent;
  }
  nodes[v].terminal += flow;
  if (nodes[v].terminal == 0) push_orphan_first(s, v);

  s->flow += flow;
  s->augmentations++;
}

/* Arcs from v to its terminal, or 0 if an orphan is met on the way. */
static int32_t distance_to_terminal(search *s, int32_t v) {
  node *nodes = s->nodes;
  const arc *arcs = s->arcs;
  const uint32_t now = s->augmentations;
  int32_t distance = 0, u = v;
  while (nodes[u].stamp != now) {
    const int32_t a = nodes[u].parent;
    if (a == NO_ARC) return 0;
    if (a == TO_TERMINAL) {
      nodes[u].stamp = now;
      nodes[u].distance = 1;
      break;
    }
    distance++;
    u = arcs[a].head;
  }
  distance += nodes[u].distance;
  int32_t remaining = distance;
  for (u = v; nodes[u].stamp != now; u = arcs[nodes[u].parent].head) {
    nodes[u].stamp = now;
    nodes[u].distance = remaining--;
  }
  return distance;
}

static void release(search *s, int32_t v, bool source) {
  node *nodes = s->nodes;
  const int32_t tree = nodes[v].tree;
  for (int32_t a = nodes[v].first_arc; a < nodes[v].end_arc; a++) {
    const arc *out = &s->arcs[a];
    const int32_t u = out->head;
    if (nodes[u].tree != tree) continue;
    if ((source ? out->residual_in : out->residual) > 0) activate(s, u);
    if (nodes[u].parent == out->reverse) push_orphan(s, u);
  }
  nodes[v].tree = FREE;
}

static void adopt(search *s) {
  node *nodes = s->nodes;
  while (s->orphan_count > 0) {
    const int32_t v = pop_orphan(s);
    const int32_t tree = nodes[v].tree;
    const bool source = tree == SOURCE_TREE;
    int32_t best = NO_ARC, best_distance = INT32_MAX;
    for (int32_t a = nodes[v].first_arc; a < nodes[v].end_arc; a++) {
      const arc *out = &s->arcs[a];
      if ((source ? out->residual_in : out->residual) == 0 || nodes[out->head].tree != tree) continue;
      const int32_t distance = distance_to_terminal(s, out->head);
      if (distance > 0 && distance < best_distance) {
        best = a;
        best_distance = distance;
      }
    }
    if (best == NO_ARC) {
      release(s, v, source);
    } else {
      nodes[v].parent = best;
      nodes[v].stamp = s->augmentations;
      nodes[v].distance = best_distance + 1;
    }
  }
}

/* Scans the arcs of active node v once. After an augmentation the same arc is looked at again: nodes scanned before it
 * that have become free in the meantime have made v active again. */
static void grow(search *s, int32_t v) {
  node *nodes = s->nodes, *p = &nodes[v];
  const int32_t tree = p->tree;
  const bool source = tree == SOURCE_TREE;
  for (int32_t a = p->first_arc; a < p->end_arc;) {
    const arc *out = &s->arcs[a];
    if ((source ? out->residual : out->residual_in) == 0) {
      a++;
      continue;
    }
    node *q = &nodes[out->head];
    if (q->tree == FREE) {
      q->tree = tree;
      q->parent = out->reverse;
      q->stamp = p->stamp;
      q->distance = p->distance + 1;
      activate(s, out->head);
    } else if (q->tree != tree) {
      augment(s, source ? a : out->reverse);
      adopt(s);
      if (p->tree != tree) return;
      continue;
    }
    a++;
  }
}

static bool mark_subset(node *nodes, const vista_graph *graph, const vista_maxflow_problem *problem, int32_t count,
                        int32_t *marked) {
  const int32_t *subset = problem->subset;
  for (*marked = 0; *marked < count; (*marked)++) {
    const int32_t v = subset == NULL ? *marked : subset[*marked];
    if (v < 0 || v >= graph->node_count || nodes[v].tree != OUTSIDE) return false;
    nodes[v].tree = FREE;
  }
  return true;
}

/* Loads node v and its arcs. The part of the flow that runs S -> v -> T is pushed at once. */
static vista_status load_node(search *s, const vista_graph *graph, const vista_maxflow_problem *problem, int32_t v) {
  const int32_t from_source = problem->source_capacity[v], to_sink = problem->sink_capacity[v];
  if (from_source < 0 || to_sink < 0) return VISTA_ERROR_RANGE;
  node *p = &s->nodes[v];
  p->first_arc = graph->first_arc[v];
  p->end_arc = graph->first_arc[v + 1];
  for (int32_t a = p->first_arc; a < p->end_arc; a++) {
    const int32_t head = graph->head[a], reverse = graph->reverse[a];
    arc *out = &s->arcs[a];
    out->head = head;
    out->reverse = reverse;
    if (s->nodes[head].tree == OUTSIDE) {
      out->residual = out->residual_in = 0;
      continue;
    }
    out->residual = problem->arc_capacity[a];
    out->residual_in = problem->arc_capacity[reverse];
    if (out->residual < 0 || out->residual_in < 0) return VISTA_ERROR_RANGE;
    if (out->residual > INT32_MAX - out->residual_in) return VISTA_ERROR_OVERFLOW;
  }
  p->terminal = from_source - to_sink;
  s->flow += from_source < to_sink ? from_source : to_sink;
  p->next_active = NO_NODE;
  p->stamp = 0;
  if (p->terminal == 0) {
    p->parent = NO_ARC;
  } else {
    p->tree = p->terminal > 0 ? SOURCE_TREE : SINK_TREE;
    p->parent = TO_TERMINAL;
    p->distance = 1;
    activate(s, v);
  }
  return VISTA_OK;
}

vista_status vista_maxflow_layout(vista_maxflow *maxflow, const vista_graph *graph, vista_arena *arena) {
  if (maxflow == NULL || graph == NULL || arena == NULL) return VISTA_ERROR_ARGUMENT;
  *maxflow = (vista_maxflow){
      .node_count = graph->node_count,
      .arc_count = graph->arc_count,
      .nodes = vista_arena_take(arena, (size_t)graph->node_count, sizeof(node)),
      .arcs = vista_arena_take(arena, (size_t)graph->arc_count, sizeof(arc)),
      .orphans = vista_arena_take(arena, (size_t)graph->node_count, sizeof(int32_t)),
  };
  return arena->base != NULL && arena->used > arena->size ? VISTA_ERROR_MEMORY : VISTA_OK;
}

vista_status vista_maxflow_solve(vista_maxflow *maxflow, const vista_graph *graph,
                                 const vista_maxflow_problem *problem, uint8_t *source_side, uint8_t *sink_side,
                                 int64_t *value) {
  if (maxflow == NULL || graph == NULL || problem == NULL || source_side == NULL || value == NULL)
    return VISTA_ERROR_ARGUMENT;
  if (problem->arc_capacity == NULL || problem->source_capacity == NULL || problem->sink_capacity == NULL)
    return VISTA_ERROR_ARGUMENT;
  if (maxflow->node_count != graph->node_count || maxflow->arc_count != graph->arc_count) return VISTA_ERROR_SIZE;
  if (maxflow->nodes == NULL || graph->first_arc == NULL) return VISTA_ERROR_ARGUMENT;
  if (problem->subset != NULL && problem->subset_count < 0) return VISTA_ERROR_RANGE;

  const int32_t *subset = problem->subset;
  const int32_t count = subset == NULL ? graph->node_count : problem->subset_count;
  search s = {
      .nodes = maxflow->nodes,
      .arcs = maxflow->arcs,
      .orphans = maxflow->orphans,
      .node_count = maxflow->node_count,
      .active_first = NO_NODE,
      .active_last = NO_NODE,
  };
  int32_t marked;
  vista_status status = mark_subset(s.nodes, graph, problem, count, &marked) ? VISTA_OK : VISTA_ERROR_RANGE;
  for (int32_t k = 0; k < marked && status == VISTA_OK; k++)
    status = load_node(&s, graph, problem, subset == NULL ? k : subset[k]);
  if (status == VISTA_OK) {
    for (int32_t v; (v = next_active(&s)) != NO_NODE;)
      if (s.nodes[v].tree != FREE) grow(&s, v);
    *value = s.flow;
  }
  for (int32_t k = 0; k < marked; k++) {
    const int32_t v = subset == NULL ? k : subset[k];
    if (status == VISTA_OK) {
      source_side[v] = s.nodes[v].tree == SOURCE_TREE;
      if (sink_side != NULL) sink_side[v] = s.nodes[v].tree == SINK_TREE;
    }
    s.nodes[v].tree = OUTSIDE;
  }
  return status;
}
