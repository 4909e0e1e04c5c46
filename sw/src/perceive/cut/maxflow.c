/* Two search trees grow towards each other, one rooted at S and one at T, over arcs with residual capacity r > 0:
 *
 *   growth        an active node p takes its free neighbours q as children (S tree: r(p,q) > 0; T tree: r(q,p) > 0);
 *                 a neighbour in the other tree closes a path S -> ... -> T
 *   augmentation  the bottleneck f is pushed along that path: r(p,q) -= f and r(q,p) += f on each arc. Nodes whose
 *                 link to their parent is now occupied become orphans
 *   adoption      each orphan looks for another parent of its tree that still descends from the terminal; if there is
 *                 none it becomes free, its children become orphans, and neighbours that could take it become active
 *
 * When no node is active, no residual arc leaves the S tree and none enters the T tree: the flow is maximal, the S
 * tree is the set reachable from S and the T tree the set that reaches T.
 *
 * Does a candidate parent descend from the terminal? Walking to the root answers, and the nodes on the way are stamped
 * with the number of the augmentation and their distance to the terminal, so that later walks stop early. Of several
 * parents the one nearest to the terminal is taken, which keeps paths short.
 *
 * Nearly all the time goes into walks to the root, so they are given the shortest chain of memory: a node's branch
 * names its parent node and the residual of the link between them, in the direction of the flow. Residuals are numbered
 * as the arcs are, so that those of a node lie side by side, and after them come the links to the terminals; so either
 * tree, and the root itself, is walked and occupied by the same lines. */
#include "perceive/cut/maxflow.h"

#include <stdbool.h>
#include <stddef.h>

/* OUTSIDE is 0, so that zeroed memory marks no node. */
enum { OUTSIDE = 0, FREE = 1, SOURCE_TREE = 2, SINK_TREE = 3 };
enum { NONE = -1, TERMINAL = -2 };
enum { MAX_PAIRS = 1 << 30 }; /* link numbers fit int32_t */

typedef struct vista_maxflow_branch {
  int32_t parent;   /* node, or TERMINAL, or NONE for orphans */
  int32_t link;     /* residual of the flow between this node and its parent */
  uint32_t stamp;   /* augmentation at which the distance was true */
  int32_t distance; /* links to the terminal */
} branch;

/* Double-ended queue of nodes; each is in it at most once, so node_count places are enough. */
typedef struct ring {
  int32_t *nodes;
  int32_t room, first, count;
} ring;

typedef struct search {
  const int32_t *first_arc, *head, *reverse;
  branch *branches;
  int32_t *residual;
  uint16_t *tree;       /* not uint8_t: a store through a character type may alias anything and costs reloads */
  int32_t *next_active; /* queue of active nodes; NONE: not in it, the last one points to itself */
  int32_t active_first, active_last;
  int32_t active_count; /* nodes that became free in the queue do not count */
  bool sink_tree_grows;
  ring orphans;
  uint32_t augmentations;
  int64_t flow;
  const vista_maxflow_problem *problem;
  int32_t first_terminal_link;
  int32_t *opened; /* nodes of the network */
  int32_t opened_count;
  int32_t arc_bits, terminal_bits; /* the OR of all capacities tells whether any is negative or too large */
} search;

/* Residual through which a node of `tree` hands its terminal on to the neighbour at the other end of its arc:
 * tail -> head for the S tree, head -> tail for the T tree. */
static int32_t link_to(const search *s, int32_t arc, int32_t tree) {
  return tree == SOURCE_TREE ? arc : s->reverse[arc];
}

/* The residual through which that neighbour would hand on the terminal. */
static int32_t link_from(const search *s, int32_t arc, int32_t tree) {
  return tree == SOURCE_TREE ? s->reverse[arc] : arc;
}

static void push_back(ring *r, int32_t v) {
  const int32_t last = r->first + r->count++;
  r->nodes[last < r->room ? last : last - r->room] = v;
}

static void push_front(ring *r, int32_t v) {
  r->first = (r->first == 0 ? r->room : r->first) - 1;
  r->count++;
  r->nodes[r->first] = v;
}

static int32_t pop_front(ring *r) {
  const int32_t v = r->nodes[r->first];
  r->first = r->first + 1 == r->room ? 0 : r->first + 1;
  r->count--;
  return v;
}

static bool is_queued(const search *s, int32_t v) { return s->next_active[v] != NONE; }

static void activate(search *s, int32_t v) {
  if (is_queued(s, v) || (s->tree[v] == SINK_TREE && !s->sink_tree_grows)) return;
  s->active_count++;
  s->next_active[v] = v;
  if (s->active_first == NONE) {
    s->active_first = v;
  } else {
    s->next_active[s->active_last] = v;
  }
  s->active_last = v;
}

static int32_t pop_active(search *s) {
  const int32_t v = s->active_first;
  s->active_first = s->next_active[v] == v ? NONE : s->next_active[v];
  s->next_active[v] = NONE;
  if (s->tree[v] != FREE) s->active_count--;
  return v;
}

static void leave_tree(search *s, int32_t v) {
  if (is_queued(s, v)) s->active_count--;
  s->tree[v] = FREE;
}

/* Node v becomes an active child of `parent`; it may be in the queue already, from an earlier life in a tree. */
static void join_tree(search *s, int32_t v, int32_t parent, int32_t link) {
  s->tree[v] = s->tree[parent];
  s->branches[v] = (branch){parent, link, s->branches[parent].stamp, s->branches[parent].distance + 1};
  if (is_queued(s, v)) s->active_count++;
  activate(s, v);
}

static int32_t bottleneck(const search *s, int32_t v, int32_t flow) {
  for (; v >= 0; v = s->branches[v].parent) {
    const int32_t residual = s->residual[s->branches[v].link];
    flow = residual < flow ? residual : flow;
  }
  return flow;
}

/* Orphans are queued with those near the root first: what hangs on them then learns early whether it survives. */
static void push_flow(search *s, int32_t v, int32_t flow) {
  while (v >= 0) {
    const int32_t parent = s->branches[v].parent, link = s->branches[v].link;
    if (parent >= 0) s->residual[s->reverse[link]] += flow;
    if ((s->residual[link] -= flow) == 0) {
      s->branches[v].parent = NONE;
      push_front(&s->orphans, v);
    }
    v = parent;
  }
}

/* Pushes the bottleneck of S -> ... -> p -> q -> ... -> T, where r[link] is the residual of p -> q. */
static void augment(search *s, int32_t p, int32_t q, int32_t link) {
  const int32_t flow = bottleneck(s, q, bottleneck(s, p, s->residual[link]));
  s->residual[link] -= flow;
  s->residual[s->reverse[link]] += flow;
  push_flow(s, p, flow);
  push_flow(s, q, flow);
  s->flow += flow;
  s->augmentations++;
}

/* Links from v to its terminal, or 0 if an orphan is met on the way. */
static int32_t distance_to_terminal(search *s, int32_t v) {
  branch *branches = s->branches;
  const uint32_t now = s->augmentations;
  int32_t walked = 0, u = v;
  while (branches[u].stamp != now) {
    const int32_t parent = branches[u].parent;
    if (parent == NONE) return 0;
    if (parent == TERMINAL) {
      branches[u].stamp = now;
      branches[u].distance = 1;
      break;
    }
    walked++;
    u = parent;
  }
  const int32_t distance = walked + branches[u].distance;
  u = v;
  for (int32_t d = distance; walked > 0; walked--, d--, u = branches[u].parent) {
    branches[u].stamp = now;
    branches[u].distance = d;
  }
  return distance;
}

static void release(search *s, int32_t v) {
  const int32_t tree = s->tree[v];
  for (int32_t a = s->first_arc[v]; a < s->first_arc[v + 1]; a++) {
    const int32_t u = s->head[a];
    if (s->tree[u] != tree) continue;
    if (s->residual[link_from(s, a, tree)] > 0) activate(s, u);
    if (s->branches[u].parent == v) {
      s->branches[u].parent = NONE;
      push_back(&s->orphans, u);
    }
  }
  leave_tree(s, v);
}

static void adopt(search *s) {
  while (s->orphans.count > 0) {
    const int32_t v = pop_front(&s->orphans);
    const int32_t tree = s->tree[v];
    int32_t parent = NONE, parent_link = NONE, nearest = INT32_MAX;
    for (int32_t a = s->first_arc[v]; a < s->first_arc[v + 1]; a++) {
      const int32_t u = s->head[a], link = link_from(s, a, tree);
      if ((s->tree[u] != tree) | (s->residual[link] == 0)) continue; /* one branch: both are hard to foresee */
      const int32_t distance = distance_to_terminal(s, u);
      if (distance > 0 && distance < nearest) {
        nearest = distance;
        parent = u;
        parent_link = link;
      }
    }
    if (parent == NONE) {
      release(s, v);
    } else {
      s->branches[v] = (branch){parent, parent_link, s->augmentations, nearest + 1};
    }
  }
}

/* Loads node v. The part of the flow that runs S -> v -> T is pushed at once. Arcs that leave the subset are loaded
 * like the others: no tree ever looks beyond a head that is OUTSIDE. */
static void load_node(search *s, int32_t v) {
  const vista_maxflow_problem *const problem = s->problem;
  const int32_t terminal_link = s->first_terminal_link + v;
  int32_t bits = 0;
  for (int32_t a = s->first_arc[v]; a < s->first_arc[v + 1]; a++) bits |= s->residual[a] = problem->arc_capacity[a];
  s->next_active[v] = NONE;
  const int32_t from_source = problem->source_capacity[v], to_sink = problem->sink_capacity[v];
  s->terminal_bits |= from_source | to_sink;
  s->arc_bits |= bits;
  s->flow += from_source < to_sink ? from_source : to_sink;
  if (from_source != to_sink) {
    s->tree[v] = from_source > to_sink ? SOURCE_TREE : SINK_TREE;
    s->residual[terminal_link] = from_source > to_sink ? from_source - to_sink : to_sink - from_source;
    s->branches[v] = (branch){TERMINAL, terminal_link, 0, 1};
    activate(s, v);
  }
}

/* The network grows by node v. */
static void open_node(search *s, int32_t v) {
  s->problem->open(s->problem->context, v);
  s->tree[v] = FREE;
  s->opened[s->opened_count++] = v;
  load_node(s, v);
}

/* Scans the arcs of active node v once. After an augmentation the same arc is looked at again, and nothing before it
 * is missed: a neighbour that adoption has set free in the meantime has made v active again. */
static void grow(search *s, int32_t v) {
  const int32_t tree = s->tree[v];
  const int32_t end = s->first_arc[v + 1];
  for (int32_t a = s->first_arc[v]; a < end;) {
    const int32_t q = s->head[a], link = link_to(s, a, tree);
    int32_t met = s->tree[q];
    if (((met != tree) & (s->residual[link] > 0)) && (met != OUTSIDE || s->problem->open != NULL)) {
      if (met == OUTSIDE) {
        open_node(s, q);
        met = s->tree[q];
        if (met == tree) continue;
      }
      if (met != FREE) {
        augment(s, tree == SOURCE_TREE ? v : q, tree == SOURCE_TREE ? q : v, link);
        adopt(s);
        if (s->tree[v] != tree) return;
        continue;
      }
      join_tree(s, q, v, link);
    }
    a++;
  }
}

static vista_status check_capacities(const search *s) {
  if (s->terminal_bits < 0 || s->arc_bits < 0) return VISTA_ERROR_RANGE;
  return s->arc_bits > VISTA_MAXFLOW_ARC_CAPACITY_MAX ? VISTA_ERROR_OVERFLOW : VISTA_OK;
}

/* Grows both trees. When the S tree has no active node, its side of the cut is final, however far the T tree has
 * come; only the labels of the sink side need a T tree that grows. Where nearly every node has a link to T, that would
 * be most of the work. */
static void grow_trees(search *s) {
  while (s->active_count > 0 && check_capacities(s) == VISTA_OK) {
    const int32_t v = pop_active(s);
    if (s->tree[v] != FREE) grow(s, v);
  }
}

/* Marks the nodes that the network starts with. False: one of them is not a node or comes twice. */
static bool mark_subset(search *s, int32_t node_count, const int32_t *subset, int32_t count) {
  for (int32_t k = 0; k < count; k++) {
    const int32_t v = subset == NULL ? k : subset[k];
    if (v < 0 || v >= node_count || s->tree[v] != OUTSIDE) return false;
    s->tree[v] = FREE;
    s->opened[s->opened_count++] = v;
  }
  return true;
}

static vista_status search_all(search *s) {
  const vista_maxflow_problem *const problem = s->problem;
  for (int32_t k = 0, count = s->opened_count; k < count; k++) {
    if (problem->open != NULL) problem->open(problem->context, s->opened[k]);
    load_node(s, s->opened[k]);
  }
  grow_trees(s);
  return check_capacities(s);
}

vista_status vista_maxflow_layout(vista_maxflow *maxflow, const vista_graph *graph, vista_arena *arena) {
  if (graph->node_count > MAX_PAIRS - graph->edge_count) return VISTA_ERROR_RANGE;
  const size_t nodes = (size_t)graph->node_count, edges = (size_t)graph->edge_count;
  *maxflow = (vista_maxflow){
      .graph = *graph,
      .branches = vista_arena_take(arena, nodes, sizeof(branch)),
      .residual = vista_arena_take(arena, 2 * edges + nodes, sizeof(int32_t)),
      .next_active = vista_arena_take(arena, nodes, sizeof(int32_t)),
      .orphans = vista_arena_take(arena, nodes, sizeof(int32_t)),
      .opened = vista_arena_take(arena, nodes, sizeof(int32_t)),
      .tree = vista_arena_take(arena, nodes, sizeof(uint16_t)),
  };
  return arena->base != NULL && arena->used > arena->size ? VISTA_ERROR_MEMORY : VISTA_OK;
}

vista_status vista_maxflow_solve(vista_maxflow *maxflow, const vista_maxflow_problem *problem, uint8_t *source_side,
                                 uint8_t *sink_side, int64_t *value) {
  const int32_t *subset = problem->subset;
  const int32_t node_count = maxflow->graph.node_count;
  const int32_t count = subset == NULL ? node_count : problem->subset_count;
  if (count < 0) return VISTA_ERROR_RANGE;
  if (problem->open != NULL && sink_side != NULL) return VISTA_ERROR_ARGUMENT;

  search s = {
      .first_arc = maxflow->graph.first_arc,
      .head = maxflow->graph.head,
      .reverse = maxflow->graph.reverse,
      .branches = maxflow->branches,
      .residual = maxflow->residual,
      .tree = maxflow->tree,
      .next_active = maxflow->next_active,
      .active_first = NONE,
      .sink_tree_grows = sink_side != NULL,
      .orphans = {.nodes = maxflow->orphans, .room = node_count},
      .problem = problem,
      .first_terminal_link = maxflow->graph.arc_count,
      .opened = maxflow->opened,
  };
  const vista_status status = mark_subset(&s, node_count, subset, count) ? search_all(&s) : VISTA_ERROR_RANGE;
  if (status == VISTA_OK) *value = s.flow;
  for (int32_t k = 0; k < s.opened_count; k++) {
    const int32_t v = s.opened[k];
    if (status == VISTA_OK) {
      source_side[v] = s.tree[v] == SOURCE_TREE;
      if (sink_side != NULL) sink_side[v] = s.tree[v] == SINK_TREE;
    }
    s.tree[v] = OUTSIDE;
  }
  return status;
}
