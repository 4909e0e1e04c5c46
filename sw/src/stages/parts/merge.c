#include "stages/parts/merge.h"

#include <math.h>

#include "common/depth.h"
#include "common/disjoint_sets.h"

#define NO_PAIR (-1)

/* Edges across the boundary of one pair of regions. */
struct vista_border {
  int64_t pair;  /* low label * region_count + high label */
  int32_t known; /* edges with a disparity at both ends */
  int32_t smooth;
};

vista_status vista_merge_layout(vista_segmentation *segmentation, vista_arena *arena,
                                const vista_foveation *foveation) {
  vista_segmentation *const s = segmentation;
  const size_t nodes = (size_t)foveation->max_nodes;
  s->perimeter = vista_arena_take(arena, nodes, sizeof(int32_t));
  s->merged = vista_arena_take(arena, nodes, sizeof(int32_t));
  s->border_slots = 1;
  while (s->border_slots < 2 * foveation->max_nodes) s->border_slots *= 2; /* a planar graph: fewer than 3 a region */
  s->borders = vista_arena_take(arena, (size_t)s->border_slots, sizeof(vista_border));
  return arena->base != NULL && arena->used > arena->size ? VISTA_ERROR_MEMORY : VISTA_OK;
}

static vista_border *find_border(vista_segmentation *s, int64_t pair) {
  int32_t slot = (int32_t)(((uint32_t)pair * UINT32_C(2654435761)) & (uint32_t)(s->border_slots - 1));
  while (s->borders[slot].pair != NO_PAIR && s->borders[slot].pair != pair) slot = (slot + 1) & (s->border_slots - 1);
  s->borders[slot].pair = pair;
  return &s->borders[slot];
}

static void measure_borders(const vista_foveation *foveation, const vista_segmentation_params *params,
                            const vista_camera *camera, const vista_cells *cells, vista_segmentation *s) {
  const vista_graph *const graph = &foveation->graph;
  for (int32_t i = 0; i < graph->node_count; ++i) {
    const int32_t a = s->label[i];
    if (a < 0) continue;
    for (int32_t arc = graph->first_arc[i]; arc < graph->first_arc[i + 1]; ++arc) {
      const int32_t j = graph->head[arc], b = s->label[j];
      if (b == a) continue;
      s->perimeter[a]++;
      if (b < a || cells->disparity_px[i] < 0.0f || cells->disparity_px[j] < 0.0f) continue;
      vista_border *const border = find_border(s, (int64_t)a * s->region_count + b);
      border->known++;
      const float step = vista_seed_step_px(params, camera, foveation->arc_distance_px[arc],
                                            fmaxf(cells->disparity_px[i], cells->disparity_px[j]));
      border->smooth += fabsf(cells->disparity_px[i] - cells->disparity_px[j]) <= (float)params->merge_ratio * step;
    }
  }
}

void vista_merge_regions(const vista_foveation *foveation, const vista_segmentation_params *params,
                         const vista_camera *camera, const vista_cells *cells, vista_segmentation *segmentation) {
  vista_segmentation *const s = segmentation;
  for (int32_t k = 0; k < s->border_slots; ++k) s->borders[k] = (vista_border){.pair = NO_PAIR};
  for (int32_t k = 0; k < s->region_count; ++k) {
    s->perimeter[k] = 0;
    s->merged[k] = k;
  }
  measure_borders(foveation, params, camera, cells, s);
  for (int32_t k = 0; k < s->border_slots; ++k) {
    const vista_border *const border = &s->borders[k];
    if (border->pair == NO_PAIR) continue;
    const int32_t a = (int32_t)(border->pair / s->region_count), b = (int32_t)(border->pair % s->region_count);
    const int32_t shorter = s->perimeter[a] < s->perimeter[b] ? s->perimeter[a] : s->perimeter[b];
    if (2 * border->smooth > border->known && border->smooth >= params->merge_share * shorter)
      (void)vista_sets_join(s->merged, a, b);
  }
  int32_t *const new_label = s->perimeter; /* the perimeters have served */
  int32_t count = 0;
  for (int32_t k = 0; k < s->region_count;
       ++k) { /* a set's root is its first label, so it is numbered before the rest */
    const int32_t root = vista_sets_find(s->merged, k);
    new_label[k] = root == k ? count++ : new_label[root];
  }
  for (int32_t i = 0; i < foveation->node_count; ++i)
    if (s->label[i] >= 0) s->label[i] = new_label[s->label[i]];
  s->region_count = count;
}
