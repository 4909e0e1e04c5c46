/* Undoing false cuts, internal to libvista: a boundary without a jump in disparity is no object boundary. */
#ifndef VISTA_SRC_MERGE_H
#define VISTA_SRC_MERGE_H

#include <stdint.h>

#include "common/arena.h"
#include "perceive/cells/cells.h"
#include "perceive/cells/foveation.h"
#include "perceive/frame_view.h"
#include "vista/status.h"

typedef struct vista_merge vista_merge; /* working memory, nothing kept from call to call */

/* *merge is NULL while the arena counts. */
vista_status vista_merge_layout(const vista_foveation *foveation, vista_arena *arena, vista_merge **merge);

/* Joins regions whose common boundary is smooth: most of the edges across it, and a share of the shorter perimeter,
 * step by less than merge_ratio times a seed's step. label: of each node, 0 .. region_count - 1 or negative; changed in
 * place. Returns the new number of regions; labels stay dense and in order. */
int32_t vista_merge_regions(vista_merge *merge, const vista_frame_view *frame, const vista_cells *cells, int32_t *label,
                            int32_t region_count);

#endif
