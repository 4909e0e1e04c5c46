/* Undoing false cuts: a boundary without a jump in disparity is no object boundary. */
#include "perceive/cut/segmentation.h"

#include <math.h>
#include <stddef.h>

#include "common/disjoint_sets.h"
#include "common/grouping.h"
#include "common/numbers.h"
#include "perceive/cut/seed_step.h"

/* Two regions are one if more than half of the edges between them, and this of the shorter perimeter, are smooth. */
#define MERGE_SHARE 0.1

struct vista_merge {
  int32_t *perimeter, *parent, *new_label; /* a region each; parent: disjoint sets */
  int32_t *known, *smooth; /* a region each: edges between it and the one at hand, with a disparity at both ends; those
                              of them that are smooth; zero between regions */
  int32_t *others; /* the regions next to the one at hand */
  int32_t *first_member, *members;
};

vista_status vista_merge_layout(const vista_foveation *foveation, vista_arena *arena, vista_merge **merge) {
  *merge = NULL;
  const size_t nodes = (size_t)foveation->max_nodes;
  vista_merge *const made = vista_arena_take(arena, 1, sizeof *made);
  const vista_merge parts = {.perimeter = vista_arena_take(arena, nodes, sizeof(int32_t)),
                             .parent = vista_arena_take(arena, nodes, sizeof(int32_t)),
                             .new_label = vista_arena_take(arena, nodes, sizeof(int32_t)),
                             .known = vista_arena_take(arena, nodes, sizeof(int32_t)),
                             .smooth = vista_arena_take(arena, nodes, sizeof(int32_t)),
                             .others = vista_arena_take(arena, nodes, sizeof(int32_t)),
                             .first_member = vista_arena_take(arena, nodes + 1, sizeof(int32_t)),
                             .members = vista_arena_take(arena, nodes, sizeof(int32_t))};
  if (arena->base == NULL) return VISTA_OK;
  if (arena->used > arena->size) return VISTA_ERROR_MEMORY;
  *made = parts;
  *merge = made;
  return VISTA_OK;
}

static void measure_perimeters(vista_merge *m, const vista_graph *graph, const int32_t *label) {
  for (int32_t i = 0; i < graph->node_count; ++i)
    for (int32_t arc = graph->first_arc[i]; label[i] >= 0 && arc < graph->first_arc[i + 1]; ++arc)
      m->perimeter[label[i]] += label[graph->head[arc]] != label[i];
}

/* The edges between region a and those numbered after it; how many regions these are. */
static int32_t measure_borders(vista_merge *m, const vista_frame_view *frame, const vista_cells *cells,
                               const int32_t *label, int32_t a) {
  const vista_foveation *const foveation = frame->foveation;
  const vista_segmentation_params *const params = &frame->params->segmentation;
  const vista_graph *const graph = &foveation->graph;
  const float *const d = cells->disparity_px;
  int32_t count = 0;
  for (int32_t k = m->first_member[a]; k < m->first_member[a + 1]; ++k) {
    const int32_t i = m->members[k];
    for (int32_t arc = graph->first_arc[i]; arc < graph->first_arc[i + 1]; ++arc) {
      const int32_t j = graph->head[arc], b = label[j];
      if (b <= a || d[i] < 0.0f || d[j] < 0.0f) continue;
      if (m->known[b]++ == 0) m->others[count++] = b;
      m->smooth[b] += vista_seed_is_smooth(params, frame->camera, foveation->arc_distance_px[arc],
                                           vista_larger(d[i], d[j]), (float)params->merge_ratio, fabsf(d[i] - d[j]));
    }
  }
  return count;
}

int32_t vista_merge_regions(vista_merge *merge, const vista_frame_view *frame, const vista_cells *cells, int32_t *label,
                            int32_t region_count) {
  vista_merge *const m = merge;
  const int32_t node_count = frame->foveation->node_count;
  for (int32_t k = 0; k < region_count; ++k) {
    m->perimeter[k] = 0;
    m->parent[k] = k;
  }
  measure_perimeters(m, &frame->foveation->graph, label);
  vista_group(label, NULL, node_count, region_count, m->first_member, m->members);
  for (int32_t a = 0; a < region_count; ++a) { /* which sets come out does not depend on the order */
    for (int32_t k = measure_borders(m, frame, cells, label, a); k > 0; --k) {
      const int32_t b = m->others[k - 1];
      const int32_t shorter = m->perimeter[a] < m->perimeter[b] ? m->perimeter[a] : m->perimeter[b];
      if (2 * m->smooth[b] > m->known[b] && m->smooth[b] >= MERGE_SHARE * shorter)
        (void)vista_sets_join(m->parent, a, b);
      m->known[b] = m->smooth[b] = 0;
    }
  }
  int32_t count = 0;
  for (int32_t k = 0; k < region_count; ++k) { /* a set's root is its first label, so it is numbered before the rest */
    const int32_t root = vista_sets_find(m->parent, k);
    m->new_label[k] = root == k ? count++ : m->new_label[root];
  }
  for (int32_t i = 0; i < node_count; ++i)
    if (label[i] >= 0) label[i] = m->new_label[label[i]];
  return count;
}
