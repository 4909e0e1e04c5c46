/* Recursive bipartition by minimum cuts (paper, section II-C).
 *
 * Every seed (seeds.h) is cut out of what is left of the graph, nearest first: S is tied to the seed, T to the
 * other seeds; free cells carry the data term D_p of equation 1 as terminal links (no disparity, another disparity,
 * a horizontal surface all pull towards T). A seed's shell is free and pulled nowhere, and its edges do without
 * disparities: there the contrast of the image decides. The source side becomes a region and leaves the graph. When
 * no obstacle seed is left, regions are joined where their common boundary has no jump in disparity; then the same is
 * done with seeds of the rest. The recursion stops when S would be empty.
 *
 * For comparison the same links may be divided by a maximum spanning forest instead (segmentation.solver). */
#ifndef VISTA_SEGMENTATION_H
#define VISTA_SEGMENTATION_H

#include <stdint.h>

#include "common/arena.h"
#include "perceive/cells/affinity.h"
#include "perceive/cells/cells.h"
#include "perceive/cells/foveation.h"
#include "perceive/cells/surface.h"
#include "perceive/cut/maxflow.h"
#include "perceive/cut/seeds.h"
#include "perceive/frame_view.h"
#include "vista/status.h"

#define VISTA_NO_LABEL (-1)

typedef struct vista_merge vista_merge; /* working memory of merge.c, nothing kept from call to call */
struct vista_spanning_forest; /* spanning_forest.h */

typedef struct vista_segmentation {
  int32_t *label;          /* node_count: region 0 .. region_count - 1 or VISTA_NO_LABEL */
  int32_t region_count;
  int32_t obstacle_count;  /* regions 0 .. obstacle_count - 1 grew from obstacle seeds */
  int32_t cut_count;       /* minimum cuts computed */
  int32_t cut_nodes;       /* nodes that the flow of all of them came to */
  vista_seeds seeds;
  vista_maxflow maxflow;
  int32_t *source_capacity, *sink_capacity; /* scratch, node_count each */
  int32_t *subset, *steps, *starts; /* nodes of the cut at hand, steps from its seed, where its flow begins */
  int32_t subset_count, expanded_count, step;
  uint16_t *role; /* in the cut at hand; not uint8_t: a store through a character type may alias anything */
  uint8_t *source_side;
  float *carried_px; /* scratch, node_count */
  int32_t *capacity;         /* scratch, graph.arc_count: of the free nodes' arcs */
  vista_merge *merge; /* scratch */
  struct vista_spanning_forest *forest; /* scratch */
} vista_segmentation;

vista_status vista_segmentation_layout(vista_segmentation *segmentation, vista_arena *arena,
                                       const vista_foveation *foveation);

vista_status vista_segment(const vista_frame_view *frame, const vista_cells *cells, const vista_surfaces *surfaces,
                           const vista_affinity *affinity, vista_segmentation *segmentation);

/* *merge is NULL while the arena counts. */
vista_status vista_merge_layout(const vista_foveation *foveation, vista_arena *arena, vista_merge **merge);

/* Joins regions whose common boundary is smooth: most of the edges across it, and a share of the shorter perimeter,
 * step by less than merge_ratio times a seed's step. label: of each node, 0 .. region_count - 1 or negative; changed in
 * place. Returns the new number of regions; labels stay dense and in order. */
int32_t vista_merge_regions(vista_merge *merge, const vista_frame_view *frame, const vista_cells *cells, int32_t *label,
                            int32_t region_count);

#endif
