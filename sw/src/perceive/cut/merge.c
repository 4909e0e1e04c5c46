#include "perceive/cut/merge.h"

#include <math.h>
#include <stddef.h>

#include "common/disjoint_sets.h"
#include "common/numbers.h"
#include "perceive/cut/seed_step.h"

/* Two regions are one if more than half of the edges between them, and this of the shorter perimeter, are smooth. */
#define MERGE_SHARE 0.1

/* Edges across the boundary of one pair of regions. */
typedef struct border {
  int64_t key; /* 1 + low label * region_count + high label; 0: an empty slot */
  int32_t known; /* edges with a disparity at both ends */
  int32_t smooth;
} border;

struct vista_merge {
  int32_t *perimeter, *parent, *new_label; /* a region each; parent: disjoint sets */
  border *table; /* hash table, empty between calls */
  int32_t slot_bits;
  int32_t *used; /* slots of the table, used_count of them */
  int32_t used_count;
};

vista_status vista_merge_layout(const vista_foveation *foveation, vista_arena *arena, vista_merge **merge) {
  *merge = NULL;
  const size_t nodes = (size_t)foveation->max_nodes;
  vista_merge *const made = vista_arena_take(arena, 1, sizeof *made);
  vista_merge parts = {.perimeter = vista_arena_take(arena, nodes, sizeof(int32_t)),
                       .parent = vista_arena_take(arena, nodes, sizeof(int32_t)),
                       .new_label = vista_arena_take(arena, nodes, sizeof(int32_t))};
  const size_t edges = 2 * nodes; /* no more pairs than that, and a slot stays free */
  while ((size_t)1 << parts.slot_bits <= edges) ++parts.slot_bits;
  parts.table = vista_arena_take(arena, (size_t)1 << parts.slot_bits, sizeof(border));
  parts.used = vista_arena_take(arena, edges, sizeof(int32_t));
  if (arena->base == NULL) return VISTA_OK;
  if (arena->used > arena->size) return VISTA_ERROR_MEMORY;
  *made = parts;
  *merge = made;
  return VISTA_OK;
}

/* Multiplicative hashing: the high bits of the product depend on all of the key's. */
static border *find_border(vista_merge *m, int64_t key) {
  const uint32_t mask = (UINT32_C(1) << m->slot_bits) - 1;
  uint32_t slot = (uint32_t)(((uint64_t)key * UINT64_C(0x9E3779B97F4A7C15)) >> (64 - m->slot_bits));
  while (m->table[slot].key != 0 && m->table[slot].key != key) slot = (slot + 1) & mask;
  if (m->table[slot].key == 0) m->used[m->used_count++] = (int32_t)slot;
  m->table[slot].key = key;
  return &m->table[slot];
}

static void measure_borders(vista_merge *m, const vista_frame_view *frame, const vista_cells *cells,
                            const int32_t *label, int32_t region_count) {
  const vista_foveation *const foveation = frame->foveation;
  const vista_segmentation_params *const params = &frame->params->segmentation;
  const vista_graph *const graph = &foveation->graph;
  for (int32_t i = 0; i < graph->node_count; ++i) {
    const int32_t a = label[i];
    if (a < 0) continue;
    for (int32_t arc = graph->first_arc[i]; arc < graph->first_arc[i + 1]; ++arc) {
      const int32_t j = graph->head[arc], b = label[j];
      if (b == a) continue;
      m->perimeter[a]++;
      if (b < a || cells->disparity_px[i] < 0.0f || cells->disparity_px[j] < 0.0f) continue;
      border *const across = find_border(m, 1 + (int64_t)a * region_count + b);
      across->known++;
      across->smooth +=
          vista_seed_is_smooth(params, frame->camera, foveation->arc_distance_px[arc],
                               vista_larger(cells->disparity_px[i], cells->disparity_px[j]), (float)params->merge_ratio,
                               fabsf(cells->disparity_px[i] - cells->disparity_px[j]));
    }
  }
}

int32_t vista_merge_regions(vista_merge *merge, const vista_frame_view *frame, const vista_cells *cells, int32_t *label,
                            int32_t region_count) {
  vista_merge *const m = merge;
  m->used_count = 0;
  for (int32_t k = 0; k < region_count; ++k) {
    m->perimeter[k] = 0;
    m->parent[k] = k;
  }
  measure_borders(m, frame, cells, label, region_count);
  for (int32_t k = 0; k < m->used_count; ++k) { /* which sets come out does not depend on the order */
    border *const across = &m->table[m->used[k]];
    const int32_t a = (int32_t)((across->key - 1) / region_count), b = (int32_t)((across->key - 1) % region_count);
    const int32_t shorter = m->perimeter[a] < m->perimeter[b] ? m->perimeter[a] : m->perimeter[b];
    if (2 * across->smooth > across->known && across->smooth >= MERGE_SHARE * shorter)
      (void)vista_sets_join(m->parent, a, b);
    *across = (border){0};
  }
  int32_t count = 0;
  for (int32_t k = 0; k < region_count; ++k) { /* a set's root is its first label, so it is numbered before the rest */
    const int32_t root = vista_sets_find(m->parent, k);
    m->new_label[k] = root == k ? count++ : m->new_label[root];
  }
  for (int32_t i = 0; i < frame->foveation->node_count; ++i)
    if (label[i] >= 0) label[i] = m->new_label[label[i]];
  return count;
}
