#include "vista/cores.h"

#include <math.h>
#include <stdbool.h>
#include <stddef.h>

#include "core_extent.h"
#include "depth.h"
#include "disjoint_sets.h"
#include "vista/types.h"

#define WORD_BINS (256 * VISTA_DISPARITY_SCALE + 1)

vista_status vista_cores_layout(vista_cores *cores, vista_arena *arena, const vista_foveation *foveation) {
  if (cores == NULL || arena == NULL || foveation == NULL) return VISTA_ERROR_ARGUMENT;
  const size_t nodes = (size_t)foveation->max_nodes;
  cores->core_of_node = vista_arena_take(arena, nodes, sizeof(int32_t));
  cores->first_member = vista_arena_take(arena, nodes + 1, sizeof(int32_t));
  cores->members = vista_arena_take(arena, nodes, sizeof(int32_t));
  cores->min_disparity_px = vista_arena_take(arena, nodes, sizeof(float));
  cores->max_disparity_px = vista_arena_take(arena, nodes, sizeof(float));
  cores->parent = vista_arena_take(arena, nodes, sizeof(int32_t));
  cores->order = vista_arena_take(arena, nodes, sizeof(int32_t));
  cores->bins = vista_arena_take(arena, nodes > WORD_BINS ? nodes : WORD_BINS, sizeof(int32_t));
  cores->area_px2 = vista_arena_take(arena, nodes, sizeof(float));
  cores->shell = vista_arena_take(arena, nodes, sizeof(uint8_t));
  cores->length_px = vista_arena_take(arena, nodes, sizeof(float));
  return arena->base != NULL && arena->used > arena->size ? VISTA_ERROR_MEMORY : VISTA_OK;
}

void vista_cores_join(vista_cores *cores, int32_t a, int32_t b) {
  const int32_t gone = vista_sets_join(cores->parent, a, b);
  if (gone >= 0) cores->area_px2[cores->parent[gone]] += cores->area_px2[gone];
}

float vista_core_step_px(const vista_segmentation_params *params, const vista_camera *camera, float distance_px,
                         float disparity_px) {
  return fmaxf(vista_depth_step_px(camera, disparity_px, (float)params->core_step_m),
               (float)params->core_step_px + (float)params->core_step_slope * distance_px);
}

/* Each node in `order` that is the first of a large enough set opens a core; the others follow their root. */
static void number_cores(vista_cores *cores, int32_t node_count, const int32_t *order, int32_t order_count,
                         double min_area_px2) {
  int32_t *const core_of_root = cores->bins; /* of sets: no longer needed for sorting */
  for (int32_t i = 0; i < node_count; ++i) {
    cores->core_of_node[i] = VISTA_NO_CORE;
    core_of_root[i] = VISTA_NO_CORE;
  }
  cores->count = 0;
  for (int32_t k = 0; k < order_count; ++k) {
    const int32_t root = vista_sets_find(cores->parent, order[k]);
    if (cores->area_px2[root] < (float)min_area_px2) continue;
    if (core_of_root[root] == VISTA_NO_CORE) core_of_root[root] = cores->count++;
    cores->core_of_node[order[k]] = core_of_root[root];
  }
  for (int32_t k = 0; k <= cores->count; ++k) cores->first_member[k] = 0;
  for (int32_t k = 0; k < order_count; ++k) {
    const int32_t core = cores->core_of_node[order[k]];
    if (core != VISTA_NO_CORE) cores->first_member[core + 1]++;
  }
  for (int32_t k = 0; k < cores->count; ++k) cores->first_member[k + 1] += cores->first_member[k];
  for (int32_t k = 0; k < order_count; ++k) { /* members keep the order; first_member is put back below */
    const int32_t core = cores->core_of_node[order[k]];
    if (core != VISTA_NO_CORE) cores->members[cores->first_member[core]++] = order[k];
  }
  for (int32_t k = cores->count; k > 0; --k) cores->first_member[k] = cores->first_member[k - 1];
  cores->first_member[0] = 0;
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

vista_status vista_cores_of_obstacles(const vista_foveation *foveation, const vista_segmentation_params *params,
                                      const vista_camera *camera, const vista_cells *cells,
                                      const vista_surfaces *surfaces, vista_cores *cores) {
  if (foveation == NULL || params == NULL || camera == NULL || cells == NULL || surfaces == NULL || cores == NULL)
    return VISTA_ERROR_ARGUMENT;
  const vista_graph *const graph = &foveation->graph;
  for (int32_t i = 0; i < graph->node_count; ++i) {
    cores->parent[i] = i;
    cores->area_px2[i] = foveation->size_px[i] * foveation->size_px[i];
  }
  for (int32_t i = 0; i < graph->node_count; ++i) {
    if (!vista_standing(cells, surfaces, i)) continue;
    for (int32_t arc = graph->first_arc[i]; arc < graph->first_arc[i + 1]; ++arc) {
      const int32_t j = graph->head[arc];
      if (j < i || !vista_standing(cells, surfaces, j)) continue;
      const float step = vista_core_step_px(params, camera, foveation->arc_distance_px[arc],
                                            fmaxf(cells->disparity_px[i], cells->disparity_px[j]));
      if (fabsf(cells->disparity_px[i] - cells->disparity_px[j]) <= step) vista_cores_join(cores, i, j);
    }
  }
  vista_cores_bridge(foveation, params, camera, cells, surfaces, cores);
  const int32_t count = sort_nearest_first(cells, surfaces, graph->node_count, cores->bins, cores->order);
  number_cores(cores, graph->node_count, cores->order, count, params->core_area_px2);
  for (int32_t k = 0; k < cores->count; ++k) {
    const int32_t first = cores->first_member[k], last = cores->first_member[k + 1] - 1;
    const int32_t trim = (last - first) / 20; /* members run from near to far */
    cores->max_disparity_px[k] = cells->disparity_px[cores->members[first + trim]];
    cores->min_disparity_px[k] = cells->disparity_px[cores->members[last - trim]];
  }
  vista_cores_find_shell(foveation, params, camera, cells, cores);
  return VISTA_OK;
}

vista_status vista_cores_of_rest(const vista_foveation *foveation, const vista_segmentation_params *params,
                                 const vista_affinity *affinity, const vista_surfaces *surfaces, const int32_t *label,
                                 vista_cores *cores) {
  if (foveation == NULL || params == NULL || affinity == NULL || surfaces == NULL || label == NULL || cores == NULL)
    return VISTA_ERROR_ARGUMENT;
  const vista_graph *const graph = &foveation->graph;
  int32_t count = 0;
  for (int32_t i = 0; i < graph->node_count; ++i) {
    cores->parent[i] = i;
    cores->shell[i] = 0;
    cores->area_px2[i] = foveation->size_px[i] * foveation->size_px[i];
    if (label[i] < 0) cores->order[count++] = i;
  }
  for (int32_t i = 0; i < graph->node_count; ++i) {
    if (label[i] >= 0) continue;
    for (int32_t arc = graph->first_arc[i]; arc < graph->first_arc[i + 1]; ++arc) {
      const int32_t j = graph->head[arc];
      if (j < i || label[j] >= 0 || surfaces->horizontal[i] != surfaces->horizontal[j]) continue;
      if (affinity->weight[arc] >= (float)params->rest_affinity) vista_cores_join(cores, i, j);
    }
  }
  number_cores(cores, graph->node_count, cores->order, count, params->rest_area_px2);
  for (int32_t k = 0; k < cores->count; ++k) cores->min_disparity_px[k] = cores->max_disparity_px[k] = -1.0f;
  return VISTA_OK;
}
