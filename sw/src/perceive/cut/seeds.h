/* Seeds of the recursion: seeds, connected sets of cells that surely belong together.
 *
 * Block matching places an edge of depth no better than half a block. Members of a seed that near to one - to a cell
 * that is farther, or without disparity - are its shell: they seed nothing, so that the cut can follow the contrast of
 * the image. A seed too thin to have an inside has no shell there. */
#ifndef VISTA_SEEDS_H
#define VISTA_SEEDS_H

#include <stdint.h>

#include "common/arena.h"
#include "perceive/cells/affinity.h"
#include "perceive/cells/cells.h"
#include "perceive/cells/foveation.h"
#include "perceive/cells/surface.h"
#include "perceive/frame_view.h"
#include "vista/status.h"

#define VISTA_NO_SEED (-1)

typedef struct vista_seeds {
  int32_t count;
  int32_t *seed_of_node;   /* node_count: seed or VISTA_NO_SEED */
  int32_t *first_member;   /* count + 1: members of seed k are members[first_member[k] .. first_member[k+1]) */
  int32_t *members;        /* node_count */
  uint8_t *shell;          /* node_count: 1 for members that are no seeds */
  float *min_disparity_px; /* per seed; 5th and 95th percentile of its cells, negative: cells without disparity */
  float *max_disparity_px;
  int32_t *parent;  /* scratch, node_count: disjoint sets */
  int32_t *order;   /* scratch, node_count: nodes, nearest or innermost first */
  int32_t *queue;   /* scratch, node_count: breadth first */
  int32_t *reached_from; /* scratch, node_count: the standing cell whose bridge a node belongs to */
  int32_t *seed_of_root; /* scratch, node_count: of a set */
  int32_t *bins;    /* scratch: counting sort of engine words */
  float *area_px2;  /* scratch, node_count */
  float *length_px; /* scratch, node_count */
} vista_seeds;

vista_status vista_seeds_layout(vista_seeds *seeds, vista_arena *arena, const vista_foveation *foveation);

/* Seeds of standing things, nearest first: cells with disparity on no horizontal surface, joined where the disparity
 * step between neighbours is small, or between cells up to bridge_m apart with only cells without disparity between
 * them; at least seed_area_px2 together. */
void vista_seeds_of_obstacles(const vista_frame_view *frame, const vista_cells *cells, const vista_surfaces *surfaces,
                              vista_seeds *seeds);

/* Seeds of the rest, from the centre outwards: cells with label < 0 joined along edges of high affinity. */
void vista_seeds_of_rest(const vista_frame_view *frame, const vista_affinity *affinity, const vista_surfaces *surfaces,
                         const int32_t *label, vista_seeds *seeds);

#endif
