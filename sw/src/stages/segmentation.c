#include "stages/segmentation.h"

#include <math.h>
#include <stdbool.h>
#include <stddef.h>

#include "common/frame.h"
#include "common/parameters_check.h"
#include "stages/parts/merge.h"

vista_status vista_segmentation_layout(vista_segmentation *segmentation, vista_arena *arena,
                                       const vista_foveation *foveation) {
  if (segmentation == NULL || arena == NULL || foveation == NULL) return VISTA_ERROR_ARGUMENT;
  vista_segmentation *const s = segmentation;
  const size_t nodes = (size_t)foveation->max_nodes;
  s->label = vista_arena_take(arena, nodes, sizeof(int32_t));
  s->source_capacity = vista_arena_take(arena, nodes, sizeof(int32_t));
  s->sink_capacity = vista_arena_take(arena, nodes, sizeof(int32_t));
  s->subset = vista_arena_take(arena, nodes, sizeof(int32_t));
  s->free = vista_arena_take(arena, nodes, sizeof(int32_t));
  s->role = vista_arena_take(arena, nodes, sizeof(uint8_t));
  s->source_side = vista_arena_take(arena, nodes, sizeof(uint8_t));
  s->capacity = vista_arena_take(arena, (size_t)foveation->graph.arc_count, sizeof(int32_t));
  const vista_status merging = vista_merge_layout(foveation, arena, &s->merge);
  if (merging != VISTA_OK) return merging;
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
  double flow_scale;
} view;

/* Data term of a free cell: pull towards T while an obstacle seed is cut out. */
static int32_t sink_link(const view *w, const vista_seeds *seeds, int32_t seed, int32_t node) {
  if (seeds->max_disparity_px[seed] < 0.0f) return 0; /* the rest has no disparity to disagree with */
  if (w->surfaces->horizontal[node]) return (int32_t)(w->params->horizontal_link * w->flow_scale);
  const float d = w->cells->disparity_px[node];
  if (d < 0.0f) return (int32_t)(w->params->unknown_link * w->flow_scale);
  const float beyond = fmaxf(d - seeds->max_disparity_px[seed], seeds->min_disparity_px[seed] - d);
  return (int32_t)(w->params->mismatch_link * w->flow_scale * (double)fminf(fmaxf(beyond, 0.0f), 4.0f));
}

/* What a node is to the cut at hand. */
enum { NOT_REACHED, SOURCE, SINK, FREE, CUT_OUT };

/* Takes a cell into the cut, unless it is in it already or in none any more. Cells of other seeds and those after the
 * last step can only be on T's side. */
static void reach(vista_segmentation *s, int32_t node, bool last) {
  if (s->role[node] != NOT_REACHED) return;
  s->role[node] = last || s->seeds.seed_of_node[node] != VISTA_NO_SEED ? SINK : FREE;
  s->subset[s->subset_count++] = node;
}

/* Takes the neighbours of a free cell into the cut that are not in it yet, and finds the cell's links: an edge to a cell
 * whose side is settled is a link to that side's terminal, so that the flow runs over free cells only. */
static void link_free_cell(const view *w, vista_segmentation *s, int32_t seed, int32_t node, bool last) {
  const vista_graph *const graph = &w->foveation->graph;
  int32_t source = 0, sink = s->seeds.seed_of_node[node] == seed ? 0 : sink_link(w, &s->seeds, seed, node);
  for (int32_t arc = graph->first_arc[node]; arc < graph->first_arc[node + 1]; ++arc) {
    const int32_t other = graph->head[arc];
    if (s->role[other] == CUT_OUT) continue;
    reach(s, other, last);
    const bool uncertain = s->seeds.shell[node] || s->seeds.shell[other];
    const int32_t capacity = uncertain ? w->affinity->intensity_capacity[arc] : w->affinity->capacity[arc];
    s->capacity[arc] = capacity;
    source += s->role[other] == SOURCE ? capacity : 0;
    sink += s->role[other] == SINK ? capacity : 0;
  }
  s->source_capacity[node] = source;
  s->sink_capacity[node] = sink;
  s->free[s->free_count++] = node;
}

static void reach_from_source(const view *w, vista_segmentation *s, int32_t node, bool last) {
  const vista_graph *const graph = &w->foveation->graph;
  for (int32_t arc = graph->first_arc[node]; arc < graph->first_arc[node + 1]; ++arc) reach(s, graph->head[arc], last);
}

/* Breadth first from the seed: its members, the free cells within reach, and what touches them. */
static void gather(const view *w, vista_segmentation *s, int32_t seed) {
  const vista_seeds *const seeds = &s->seeds;
  s->subset_count = s->free_count = 0;
  for (int32_t m = seeds->first_member[seed]; m < seeds->first_member[seed + 1]; ++m) {
    const int32_t node = seeds->members[m];
    if (s->label[node] >= 0) continue;
    s->role[node] = seeds->shell[node] ? FREE : SOURCE;
    s->subset[s->subset_count++] = node;
  }
  for (int32_t step = 1, next = 0; next < s->subset_count; ++step) {
    const bool last = step >= w->params->reach;
    for (const int32_t end = s->subset_count; next < end; ++next) {
      const int32_t node = s->subset[next];
      if (s->role[node] == FREE)
        link_free_cell(w, s, seed, node, last);
      else if (s->role[node] == SOURCE)
        reach_from_source(w, s, node, last);
    }
  }
}

/* One isolating cut; the source side becomes region `label`. */
static vista_status cut_out(const view *w, vista_segmentation *s, int32_t seed, int32_t label) {
  gather(w, s, seed);
  const vista_maxflow_problem problem = {s->capacity, s->source_capacity, s->sink_capacity, s->free, s->free_count};
  int64_t value;
  const vista_status status = vista_maxflow_solve(&s->maxflow, &problem, s->source_side, NULL, &value);
  if (status != VISTA_OK) return status;
  for (int32_t k = 0; k < s->subset_count; ++k) {
    const int32_t node = s->subset[k];
    const bool on_source_side = s->role[node] == SOURCE || (s->role[node] == FREE && s->source_side[node]);
    if (on_source_side) s->label[node] = label;
    s->role[node] = on_source_side ? CUT_OUT : NOT_REACHED;
  }
  s->cut_count++;
  s->cut_nodes += s->free_count;
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

vista_status vista_segment(const vista_foveation *foveation, const vista_parameters *params, const vista_camera *camera,
                           const vista_cells *cells, const vista_surfaces *surfaces, const vista_affinity *affinity,
                           vista_segmentation *segmentation) {
  if (foveation == NULL || params == NULL || camera == NULL || cells == NULL || surfaces == NULL || affinity == NULL ||
      segmentation == NULL)
    return VISTA_ERROR_ARGUMENT;
  vista_status status = VISTA_CHECK_SECTION(segmentation, &params->segmentation);
  if (status == VISTA_OK) status = VISTA_CHECK_SECTION(affinity, &params->affinity);
  if (status == VISTA_OK) status = vista_frame_check_camera(camera);
  if (status != VISTA_OK) return status;
  vista_segmentation *const s = segmentation;
  const view w = {foveation, &params->segmentation, cells, surfaces, affinity, params->affinity.flow_scale};
  for (int32_t i = 0; i < foveation->node_count; ++i) s->label[i] = VISTA_NO_LABEL;
  s->region_count = s->cut_count = s->cut_nodes = 0;

  status = vista_seeds_of_obstacles(foveation, w.params, camera, cells, surfaces, &s->seeds);
  if (status == VISTA_OK) status = cut_all(&w, s);
  if (status == VISTA_OK)
    s->region_count = vista_merge_regions(s->merge, foveation, w.params, camera, cells, s->label, s->region_count);
  s->obstacle_count = s->region_count;
  if (status == VISTA_OK) status = vista_seeds_of_rest(foveation, w.params, affinity, surfaces, s->label, &s->seeds);
  if (status == VISTA_OK) status = cut_all(&w, s);
  return status;
}
