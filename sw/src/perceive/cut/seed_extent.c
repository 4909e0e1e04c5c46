#include "perceive/cut/seed_extent.h"

#include <math.h>
#include <stdbool.h>
#include <stdint.h>

#include "common/numbers.h"
#include "perceive/cut/seed_step.h"

#define BRIDGE_M 2.0 /* parts up to this far apart, with only cells without disparity between them, are one seed */
#define SHELL_PX 6.0 /* cells of a seed this near to an edge of depth stay free in the cut: half the matching block */
#define FARTHEST_STEP_PX 30.0f /* no slope is believed beyond this */

/* A length in baselines as seen at a disparity: f length / Z. */
static float seen_px(float baselines, float disparity_px) { return baselines * disparity_px; }

void vista_seeds_bridge(const vista_frame_view *frame, const vista_cells *cells, const vista_surfaces *surfaces,
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
        vista_seeds_join(seeds, a, b);
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

void vista_seeds_find_shell(const vista_frame_view *frame, const vista_cells *cells, vista_seeds *seeds) {
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
