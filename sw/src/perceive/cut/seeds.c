#include "perceive/cut/seeds.h"

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "common/disjoint_sets.h"
#include "common/grouping.h"
#include "common/numbers.h"
#include "perceive/cut/seed_step.h"
#include "perceive/scales.h"

/* Cells that no obstacle claims form seeds of the rest along edges of at least this affinity. */
#define REST_AFFINITY 0.7
#define BRIDGE_M 2.0 /* parts up to this far apart, with only cells without disparity between them, are one seed */
#define SHELL_PX 6.0 /* cells of a seed this near to an edge of depth stay free in the cut: half the matching block */
#define FARTHEST_STEP_PX 30.0f /* no slope is believed beyond this */
#define WORD_BINS (INT16_MAX + 1) /* one a word */

vista_status vista_seeds_layout(vista_seeds *seeds, vista_arena *arena, const vista_foveation *foveation) {
  const size_t nodes = (size_t)foveation->max_nodes;
  seeds->seed_of_node = vista_arena_take(arena, nodes, sizeof(int32_t));
  seeds->first_member = vista_arena_take(arena, nodes + 1, sizeof(int32_t));
  seeds->members = vista_arena_take(arena, nodes, sizeof(int32_t));
  seeds->min_disparity_px = vista_arena_take(arena, nodes, sizeof(float));
  seeds->max_disparity_px = vista_arena_take(arena, nodes, sizeof(float));
  seeds->parent = vista_arena_take(arena, nodes, sizeof(int32_t));
  seeds->order = vista_arena_take(arena, nodes, sizeof(int32_t));
  seeds->queue = vista_arena_take(arena, nodes, sizeof(int32_t));
  seeds->reached_from = vista_arena_take(arena, nodes, sizeof(int32_t));
  seeds->seed_of_root = vista_arena_take(arena, nodes, sizeof(int32_t));
  seeds->bins = vista_arena_take(arena, WORD_BINS, sizeof(int32_t));
  seeds->area_px2 = vista_arena_take(arena, nodes, sizeof(float));
  seeds->shell = vista_arena_take(arena, nodes, sizeof(uint8_t));
  seeds->length_px = vista_arena_take(arena, nodes, sizeof(float));
  return arena->base != NULL && arena->used > arena->size ? VISTA_ERROR_MEMORY : VISTA_OK;
}

/* Makes one set of those of nodes a and b. */
static void join(vista_seeds *seeds, int32_t a, int32_t b) {
  const int32_t gone = vista_sets_join(seeds->parent, a, b);
  if (gone >= 0) seeds->area_px2[seeds->parent[gone]] += seeds->area_px2[gone];
}

/* Each node in `order` that is the first of a large enough set opens a seed; the others follow their root. */
static void number_seeds(vista_seeds *seeds, int32_t node_count, const int32_t *order, int32_t order_count,
                         double min_area_px2) {
  int32_t *const seed_of_root = seeds->seed_of_root;
  for (int32_t i = 0; i < node_count; ++i) {
    seeds->seed_of_node[i] = VISTA_NO_SEED;
    seed_of_root[i] = VISTA_NO_SEED;
  }
  seeds->count = 0;
  for (int32_t k = 0; k < order_count; ++k) {
    const int32_t root = vista_sets_find(seeds->parent, order[k]);
    if (seeds->area_px2[root] < (float)min_area_px2) continue;
    if (seed_of_root[root] == VISTA_NO_SEED) seed_of_root[root] = seeds->count++;
    seeds->seed_of_node[order[k]] = seed_of_root[root];
  }
  vista_group(seeds->seed_of_node, order, order_count, seeds->count, seeds->first_member, seeds->members);
}

/* Files may hold words that no engine writes: those count as the largest. */
static int32_t word_bin(const vista_cells *cells, int32_t node) {
  const int32_t word = (int32_t)(cells->disparity_px[node] * VISTA_DISPARITY_SCALE);
  return word < WORD_BINS ? word : WORD_BINS - 1;
}

/* Standing cells by falling disparity: a counting sort, stable in the node number. */
static int32_t sort_nearest_first(const vista_cells *cells, const vista_surfaces *surfaces, int32_t node_count,
                                  int32_t *bins, int32_t *order) {
  for (int32_t b = 0; b < WORD_BINS; ++b) bins[b] = 0;
  for (int32_t i = 0; i < node_count; ++i)
    if (vista_standing(cells, surfaces, i)) bins[word_bin(cells, i)]++;
  int32_t count = 0;
  for (int32_t b = WORD_BINS - 1; b >= 0; --b) {
    const int32_t in_bin = bins[b];
    bins[b] = count;
    count += in_bin;
  }
  for (int32_t i = 0; i < node_count; ++i)
    if (vista_standing(cells, surfaces, i)) order[bins[word_bin(cells, i)]++] = i;
  return count;
}

/* A length in baselines as seen at a disparity: f length / Z. */
static float seen_px(float baselines, float disparity_px) { return baselines * disparity_px; }

/* Joins the sets of standing cells of about the same disparity where a way between them leads over cells without
 * disparity: plain faces are matched only at their edges. Before the seeds are numbered. */
static void bridge_gaps(const vista_frame_view *frame, const vista_cells *cells, const vista_surfaces *surfaces,
                        vista_seeds *seeds) {
  const vista_foveation *const foveation = frame->foveation;
  const vista_segmentation_params *const params = &frame->params->segmentation;
  const vista_camera *const camera = frame->camera;
  const vista_graph *const graph = &foveation->graph;
  const float *const d = cells->disparity_px;
  int32_t *const owner = seeds->reached_from;
  int32_t *const queue = seeds->queue;
  float *const length_px = seeds->length_px;
  const float bridge = (float)(BRIDGE_M / camera->baseline_m);
  int32_t count = 0;
  for (int32_t i = 0; i < graph->node_count; ++i) {
    const bool stands = vista_standing(cells, surfaces, i);
    owner[i] = stands ? i : VISTA_NO_SEED;
    length_px[i] = 0.0f;
    if (stands) queue[count++] = i;
  }
  for (int32_t next = 0; next < count; ++next) {
    const int32_t i = queue[next];
    for (int32_t arc = graph->first_arc[i]; arc < graph->first_arc[i + 1]; ++arc) {
      const int32_t j = graph->head[arc];
      if (d[j] >= 0.0f || owner[j] >= 0) continue;
      const float length = length_px[i] + foveation->arc_distance_px[arc];
      if (length > seen_px(bridge, d[owner[i]])) continue;
      owner[j] = owner[i];
      length_px[j] = length;
      queue[count++] = j;
    }
  }
  for (int32_t i = 0; i < graph->node_count; ++i) {
    const int32_t a = owner[i];
    if (a < 0) continue;
    const bool known = d[i] >= 0.0f;
    for (int32_t arc = graph->first_arc[i]; arc < graph->first_arc[i + 1]; ++arc) {
      const int32_t j = graph->head[arc];
      if (j < i || (known && d[j] >= 0.0f)) continue;
      const int32_t b = owner[j];
      if (b < 0 || a == b) continue;
      const float gap_px = length_px[i] + length_px[j] + foveation->arc_distance_px[arc];
      if (gap_px > seen_px(bridge, vista_smaller(d[a], d[b]))) continue;
      if (vista_seed_is_smooth(params, camera, vista_smaller(gap_px, FARTHEST_STEP_PX), vista_larger(d[a], d[b]), 1.0f,
                               fabsf(d[a] - d[b])))
        join(seeds, a, b);
    }
  }
}

/* Breadth first from the first `count` nodes of the queue, whose length_px is known, over nodes at INFINITY up to
 * reach_px, but never out of a seed. Half of its arcs belongs to a node at 0. */
static void spread(const vista_foveation *foveation, float reach_px, vista_seeds *seeds, int32_t count) {
  const vista_graph *const graph = &foveation->graph;
  int32_t *const queue = seeds->queue;
  float *const length_px = seeds->length_px;
  for (int32_t next = 0; next < count; ++next) {
    const int32_t i = queue[next];
    for (int32_t arc = graph->first_arc[i]; arc < graph->first_arc[i + 1]; ++arc) {
      const int32_t j = graph->head[arc];
      if (length_px[j] != INFINITY) continue;
      const float length = length_px[i] + foveation->arc_distance_px[arc] * (length_px[i] == 0.0f ? 0.5f : 1.0f);
      if (length > reach_px) continue;
      if (seeds->seed_of_node[i] != VISTA_NO_SEED && seeds->seed_of_node[j] != seeds->seed_of_node[i]) continue;
      length_px[j] = length;
      queue[count++] = j;
    }
  }
}

/* The distance from a member to the nearest edge across which it gets clearly farther; INFINITY: it has none. */
static float to_farther_side_px(const vista_frame_view *frame, const vista_cells *cells, int32_t node) {
  const vista_foveation *const foveation = frame->foveation;
  const float d = cells->disparity_px[node];
  float nearest_px = INFINITY;
  for (int32_t arc = foveation->graph.first_arc[node]; arc < foveation->graph.first_arc[node + 1]; ++arc) {
    const float other = cells->disparity_px[foveation->graph.head[arc]], distance = foveation->arc_distance_px[arc];
    if (other >= 0.0f &&
        !vista_seed_is_smooth(&frame->params->segmentation, frame->camera, distance, d, 1.0f, d - other))
      nearest_px = vista_smaller(nearest_px, 0.5f * distance);
  }
  return nearest_px;
}

/* The members near an edge of depth and an inner member. */
static void find_shell(const vista_frame_view *frame, const vista_cells *cells, vista_seeds *seeds) {
  const vista_foveation *const foveation = frame->foveation;
  const float reach_px = (float)SHELL_PX;
  float *const length_px = seeds->length_px;
  int32_t count = 0;
  for (int32_t i = 0; i < foveation->node_count; ++i) {
    length_px[i] = INFINITY;
    if (cells->disparity_px[i] < 0.0f)
      length_px[i] = 0.0f;
    else if (seeds->seed_of_node[i] != VISTA_NO_SEED)
      length_px[i] = to_farther_side_px(frame, cells, i);
    if (length_px[i] > reach_px)
      length_px[i] = INFINITY;
    else
      seeds->queue[count++] = i;
  }
  spread(foveation, reach_px, seeds, count);
  count = 0;
  for (int32_t i = 0; i < foveation->node_count; ++i) {
    const bool member = seeds->seed_of_node[i] != VISTA_NO_SEED, near_edge = length_px[i] != INFINITY;
    seeds->shell[i] = member && near_edge;
    length_px[i] = member && !near_edge ? 0.0f : INFINITY;
    if (member && !near_edge) seeds->queue[count++] = i;
  }
  spread(foveation, reach_px, seeds, count);
  for (int32_t i = 0; i < foveation->node_count; ++i) seeds->shell[i] = seeds->shell[i] && length_px[i] != INFINITY;
}

void vista_seeds_of_obstacles(const vista_frame_view *frame, const vista_cells *cells, const vista_surfaces *surfaces,
                              vista_seeds *seeds) {
  const vista_foveation *const foveation = frame->foveation;
  const vista_segmentation_params *const params = &frame->params->segmentation;
  const vista_graph *const graph = &foveation->graph;
  for (int32_t i = 0; i < graph->node_count; ++i) {
    seeds->parent[i] = i;
    seeds->area_px2[i] = foveation->size_px[i] * foveation->size_px[i];
  }
  const float *const d = cells->disparity_px;
  for (int32_t i = 0; i < graph->node_count; ++i) {
    if (!vista_standing(cells, surfaces, i)) continue;
    for (int32_t arc = graph->first_arc[i]; arc < graph->first_arc[i + 1]; ++arc) {
      const int32_t j = graph->head[arc];
      if (j < i || !vista_standing(cells, surfaces, j)) continue;
      if (vista_seed_is_smooth(params, frame->camera, foveation->arc_distance_px[arc], vista_larger(d[i], d[j]), 1.0f,
                               fabsf(d[i] - d[j])))
        join(seeds, i, j);
    }
  }
  bridge_gaps(frame, cells, surfaces, seeds);
  const int32_t count = sort_nearest_first(cells, surfaces, graph->node_count, seeds->bins, seeds->order);
  number_seeds(seeds, graph->node_count, seeds->order, count, params->seed_area_px2);
  for (int32_t k = 0; k < seeds->count; ++k) {
    const int32_t first = seeds->first_member[k], last = seeds->first_member[k + 1] - 1;
    const int32_t trim = (last - first) / 20; /* members run from near to far */
    seeds->max_disparity_px[k] = cells->disparity_px[seeds->members[first + trim]];
    seeds->min_disparity_px[k] = cells->disparity_px[seeds->members[last - trim]];
  }
  find_shell(frame, cells, seeds);
}

void vista_seeds_of_rest(const vista_frame_view *frame, const vista_affinity *affinity, const vista_surfaces *surfaces,
                         const int32_t *label, vista_seeds *seeds) {
  const vista_foveation *const foveation = frame->foveation;
  const vista_graph *const graph = &foveation->graph;
  int32_t count = 0;
  for (int32_t i = 0; i < graph->node_count; ++i) {
    seeds->parent[i] = i;
    seeds->shell[i] = 0;
    seeds->area_px2[i] = foveation->size_px[i] * foveation->size_px[i];
    if (label[i] < 0) seeds->order[count++] = i;
  }
  for (int32_t i = 0; i < graph->node_count; ++i) {
    if (label[i] >= 0) continue;
    for (int32_t arc = graph->first_arc[i]; arc < graph->first_arc[i + 1]; ++arc) {
      const int32_t j = graph->head[arc];
      if (j < i || label[j] >= 0 || surfaces->horizontal[i] != surfaces->horizontal[j]) continue;
      if (affinity->weight[arc] >= (float)REST_AFFINITY) join(seeds, i, j);
    }
  }
  number_seeds(seeds, graph->node_count, seeds->order, count, VISTA_HALF_BLOCK_PX2);
  for (int32_t k = 0; k < seeds->count; ++k) seeds->min_disparity_px[k] = seeds->max_disparity_px[k] = -1.0f;
}
