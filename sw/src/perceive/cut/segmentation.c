#include "perceive/cut/segmentation.h"

#include <math.h>
#include <stdbool.h>
#include <stddef.h>

#include "common/plane_fit.h"
#include "perceive/cut/seed_step.h"
#include "perceive/cut/spanning_forest.h"
#include "perceive/scales.h"

#define UNKNOWN_LINK 0.03 /* of VISTA_FLOW_SCALE: what it costs to take a textureless cell into an obstacle */
#define MISMATCH_LINK 0.5 /* the same per pixel of disparity beyond the seed's own range, at most four times this */

vista_status vista_segmentation_layout(vista_segmentation *segmentation, vista_arena *arena,
                                       const vista_foveation *foveation) {
  vista_segmentation *const s = segmentation;
  const size_t nodes = (size_t)foveation->max_nodes;
  s->label = vista_arena_take(arena, nodes, sizeof(int32_t));
  s->source_capacity = vista_arena_take(arena, nodes, sizeof(int32_t));
  s->sink_capacity = vista_arena_take(arena, nodes, sizeof(int32_t));
  s->subset = vista_arena_take(arena, nodes, sizeof(int32_t));
  s->starts = vista_arena_take(arena, nodes, sizeof(int32_t));
  s->steps = vista_arena_take(arena, nodes, sizeof(int32_t));
  s->carried_px = vista_arena_take(arena, nodes, sizeof(float));
  s->role = vista_arena_take(arena, nodes, sizeof(uint16_t));
  s->source_side = vista_arena_take(arena, nodes, sizeof(uint8_t));
  s->capacity = vista_arena_take(arena, (size_t)foveation->graph.arc_count, sizeof(int32_t));
  const vista_status merging = vista_merge_layout(foveation, arena, &s->merge);
  if (merging != VISTA_OK) return merging;
  vista_spanning_forest forest;
  const vista_status growing = vista_spanning_forest_layout(&foveation->graph, arena, &forest);
  if (growing != VISTA_OK) return growing;
  s->forest = vista_arena_take(arena, 1, sizeof *s->forest);
  if (s->forest != NULL) *s->forest = forest;
  const vista_status status = vista_seeds_layout(&s->seeds, arena, foveation);
  if (status != VISTA_OK) return status;
  return vista_maxflow_layout(&s->maxflow, &foveation->graph, arena);
}

/* What a cut reads; bundled because every step of it needs the same. */
typedef struct view {
  const vista_foveation *foveation;
  const vista_segmentation_params *params;
  const vista_cells *cells;
  const vista_surfaces *surfaces;
  const vista_affinity *affinity;
} view;

/* Data term of a free cell: pull towards T while an obstacle seed is cut out. */
static int32_t sink_link(const view *w, const vista_seeds *seeds, int32_t seed, int32_t node) {
  if (seeds->max_disparity_px[seed] < 0.0f) return 0; /* the rest has no disparity to disagree with */
  if (w->surfaces->horizontal[node]) return (int32_t)(w->params->horizontal_link * VISTA_FLOW_SCALE);
  const float d = w->cells->disparity_px[node];
  if (d < 0.0f) return (int32_t)(UNKNOWN_LINK * VISTA_FLOW_SCALE);
  const float beyond = fmaxf(d - seeds->max_disparity_px[seed], seeds->min_disparity_px[seed] - d);
  return (int32_t)(MISMATCH_LINK * VISTA_FLOW_SCALE * (double)fminf(fmaxf(beyond, 0.0f), 4.0f));
}

/* What a node is to the cut at hand. LINKED: the flow has come to a free one. */
enum { NOT_REACHED, SOURCE, SINK, FREE, LINKED, CUT_OUT };

/* Breadth first from the seed, one step further: takes what touches the cells of the last step into the cut, unless it
 * is in it already or in none any more. Cells of other seeds and those after the last step can only be on T's side. */
static void gather_step(const view *w, vista_segmentation *s) {
  const int32_t *const first_arc = w->foveation->graph.first_arc, *const head = w->foveation->graph.head;
  const int32_t *const seed_of_node = s->seeds.seed_of_node;
  uint16_t *const role = s->role;
  int32_t *const subset = s->subset, *const steps = s->steps;
  const int32_t step = s->step + 1, end = s->subset_count;
  const bool last = step >= w->params->reach;
  int32_t count = end;
  for (int32_t k = s->expanded_count; k < end; ++k) {
    const int32_t node = subset[k];
    if (role[node] == SINK) continue;
    for (int32_t arc = first_arc[node]; arc < first_arc[node + 1]; ++arc) {
      const int32_t near = head[arc];
      if (role[near] != NOT_REACHED) continue;
      role[near] = last || seed_of_node[near] != VISTA_NO_SEED ? SINK : FREE;
      steps[near] = step;
      subset[count++] = near;
    }
  }
  s->expanded_count = end;
  s->subset_count = count;
  s->step = step;
}

/* The members of the seed that are in no region yet, and what touches them. */
static void gather_seed(const view *w, vista_segmentation *s, int32_t seed) {
  const vista_seeds *const seeds = &s->seeds;
  s->subset_count = s->expanded_count = s->step = 0;
  for (int32_t m = seeds->first_member[seed]; m < seeds->first_member[seed + 1]; ++m) {
    const int32_t node = seeds->members[m];
    if (s->role[node] == CUT_OUT) continue;
    s->role[node] = seeds->shell[node] ? FREE : SOURCE;
    s->steps[node] = 0;
    s->subset[s->subset_count++] = node;
  }
  gather_step(w, s);
}

typedef struct cut {
  const view *view;
  vista_segmentation *segmentation;
  int32_t seed;
} cut;

/* The flow comes to a free cell: finds its links. An edge to a cell whose side is settled is a link to that side's
 * terminal, so that the flow runs over free cells only. */
static void link_free_cell(void *context, int32_t node) {
  const cut *const c = context;
  const view *const w = c->view;
  vista_segmentation *const s = c->segmentation;
  const int32_t *const first_arc = w->foveation->graph.first_arc, *const head = w->foveation->graph.head;
  const int32_t *const intensity_capacity = w->affinity->intensity_capacity, *const full = w->affinity->capacity;
  const uint8_t *const shell = s->seeds.shell;
  const uint16_t *const role = s->role;
  while (s->step <= s->steps[node]) gather_step(w, s);
  /* The forest compares single links: not their sum, the strongest counts. */
  const bool grown = w->params->solver == VISTA_SEGMENTATION_SOLVER_FOREST;
  const bool in_shell = shell[node];
  int32_t source = 0, sink = s->seeds.seed_of_node[node] == c->seed ? 0 : sink_link(w, &s->seeds, c->seed, node);
  for (int32_t arc = first_arc[node]; arc < first_arc[node + 1]; ++arc) {
    const int32_t other = head[arc], to = role[other];
    const int32_t capacity = in_shell || shell[other] ? intensity_capacity[arc] : full[arc];
    const int32_t to_source = to == SOURCE ? capacity : 0, to_sink = to == SINK ? capacity : 0;
    source = !grown ? source + to_source : to_source > source ? to_source : source;
    sink = !grown ? sink + to_sink : to_sink > sink ? to_sink : sink;
    s->capacity[arc] = to == FREE || to == LINKED ? capacity : 0;
  }
  s->role[node] = LINKED;
  s->source_capacity[node] = source;
  s->sink_capacity[node] = sink;
  s->cut_nodes++;
}

/* Free cells next to the source. */
static int32_t list_starts(const view *w, vista_segmentation *s) {
  const vista_graph *const graph = &w->foveation->graph;
  int32_t count = 0;
  for (int32_t k = 0; k < s->subset_count; ++k) {
    const int32_t node = s->subset[k];
    if (s->role[node] != FREE) continue;
    bool start = false;
    for (int32_t arc = graph->first_arc[node]; arc < graph->first_arc[node + 1]; ++arc)
      start |= s->role[graph->head[arc]] == SOURCE;
    if (start) s->starts[count++] = node;
  }
  return count;
}

/* The spanning forest of all free cells within reach. */
static void grow(const view *w, vista_segmentation *s, cut *c) {
  while (s->step < w->params->reach) gather_step(w, s);
  int32_t count = 0;
  for (int32_t k = 0; k < s->subset_count; ++k)
    if (s->role[s->subset[k]] == FREE) s->starts[count++] = s->subset[k];
  for (int32_t k = 0; k < count; ++k) link_free_cell(c, s->starts[k]);
  const vista_forest_problem problem = {s->capacity, s->source_capacity, s->sink_capacity, s->starts, count};
  vista_spanning_forest_grow(s->forest, &w->foveation->graph, &problem, s->source_side);
}

/* The minimum cut, over as much of the free cells as its flow comes to. */
static vista_status solve(const view *w, vista_segmentation *s, cut *c) {
  const vista_maxflow_problem problem = {.arc_capacity = s->capacity,
                                         .source_capacity = s->source_capacity,
                                         .sink_capacity = s->sink_capacity,
                                         .subset = s->starts,
                                         .subset_count = list_starts(w, s),
                                         .open = link_free_cell,
                                         .context = c};
  int64_t value;
  return vista_maxflow_solve(&s->maxflow, &problem, s->source_side, NULL, &value);
}

/* One isolating cut; the source side becomes region `label`. */
static vista_status cut_out(const view *w, vista_segmentation *s, int32_t seed, int32_t label) {
  gather_seed(w, s, seed);
  cut c = {w, s, seed};
  if (w->params->solver == VISTA_SEGMENTATION_SOLVER_FOREST)
    grow(w, s, &c);
  else {
    const vista_status status = solve(w, s, &c);
    if (status != VISTA_OK) return status;
  }
  for (int32_t k = 0; k < s->subset_count; ++k) {
    const int32_t node = s->subset[k];
    const bool on_source_side = s->role[node] == SOURCE || (s->role[node] == LINKED && s->source_side[node]);
    if (on_source_side) s->label[node] = label;
    s->role[node] = on_source_side ? CUT_OUT : NOT_REACHED;
  }
  s->cut_count++;
  return VISTA_OK;
}

static vista_status cut_all(const view *w, vista_segmentation *s) {
  for (int32_t i = 0; i < w->foveation->node_count; ++i) s->role[i] = s->label[i] >= 0 ? CUT_OUT : NOT_REACHED;
  for (int32_t seed = 0; seed < s->seeds.count; ++seed) {
    const vista_status status = cut_out(w, s, seed, s->region_count);
    if (status != VISTA_OK) return status;
    s->region_count++;
  }
  return VISTA_OK;
}

/* Whether a cell touches one of its region that stands: the foot of a thing, which its ground hides in the words. */
static bool at_foot(const view *w, const int32_t *label, int32_t node) {
  const vista_graph *const graph = &w->foveation->graph;
  for (int32_t arc = graph->first_arc[node]; arc < graph->first_arc[node + 1]; ++arc)
    if (label[graph->head[arc]] == label[node] && vista_standing(w->cells, w->surfaces, graph->head[arc])) return true;
  return false;
}

/* What a region has of the ground leaves it: cells that lie on it, but for its foot, and cells without a disparity
 * that are seen below where a thing as far as the nearest known cell of the region meets the ground, or that no longer
 * hang together with a known one. */
static void split_off_ground(const view *w, const vista_camera *camera, vista_segmentation *s) {
  const vista_foveation *const f = w->foveation;
  float *const carried_px = s->carried_px;
  int32_t count = 0;
  for (int32_t i = 0; i < f->node_count; ++i) {
    if (s->label[i] >= 0 && w->surfaces->horizontal[i] && !at_foot(w, s->label, i)) s->label[i] = VISTA_NO_LABEL;
    carried_px[i] = s->label[i] >= 0 ? w->cells->disparity_px[i] : -1.0f;
    if (carried_px[i] >= 0.0f) s->subset[count++] = i;
  }
  if (!w->surfaces->ground_found) return;
  for (int32_t next = 0; next < count; ++next) {
    const int32_t i = s->subset[next];
    for (int32_t arc = f->graph.first_arc[i]; arc < f->graph.first_arc[i + 1]; ++arc) {
      const int32_t j = f->graph.head[arc];
      if (carried_px[j] >= 0.0f || s->label[j] != s->label[i]) continue;
      carried_px[j] = carried_px[i];
      s->subset[count++] = j;
    }
  }
  for (int32_t i = 0; i < f->node_count; ++i) {
    if (s->label[i] < 0 || w->cells->disparity_px[i] >= 0.0f) continue;
    const double ground =
        vista_plane_disparity_px(&w->surfaces->ground, camera, (double)f->center_u[i], (double)f->center_v[i]);
    const bool cut_off = carried_px[i] < 0.0f; /* by ground that has left */
    if (cut_off || ground > (double)carried_px[i] + fmax(VISTA_SURFACE_PX, VISTA_GROUND_SHARE * ground))
      s->label[i] = VISTA_NO_LABEL;
  }
}

vista_status vista_segment(const vista_frame_view *frame, const vista_cells *cells, const vista_surfaces *surfaces,
                           const vista_affinity *affinity, vista_segmentation *segmentation) {
  const vista_parameters *const params = frame->params;
  vista_segmentation *const s = segmentation;
  const view w = {frame->foveation, &params->segmentation, cells, surfaces, affinity};
  for (int32_t i = 0; i < frame->foveation->node_count; ++i) s->label[i] = VISTA_NO_LABEL;
  s->region_count = s->cut_count = s->cut_nodes = 0;

  vista_seeds_of_obstacles(frame, cells, surfaces, &s->seeds);
  const vista_status status = cut_all(&w, s);
  if (status != VISTA_OK) return status;
  s->region_count = vista_merge_regions(s->merge, frame, cells, s->label, s->region_count);
  s->obstacle_count = s->region_count;
  split_off_ground(&w, frame->camera, s);
  vista_seeds_of_rest(frame, affinity, surfaces, s->label, &s->seeds);
  return cut_all(&w, s);
}
