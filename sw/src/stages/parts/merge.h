/* Undoing false cuts, internal to libvista: a boundary without a jump in disparity is no object boundary. */
#ifndef VISTA_SRC_MERGE_H
#define VISTA_SRC_MERGE_H

#include <stdint.h>

#include "common/arena.h"
#include "stages/foveation.h"
#include "stages/segmentation.h"
#include "vista/parameters.h"
#include "vista/status.h"
#include "vista/types.h"

/* Room for the merging's own tables, within vista_segmentation_layout. */
vista_status vista_merge_layout(vista_segmentation *segmentation, vista_arena *arena, const vista_foveation *foveation);

/* Joins regions among 0 .. region_count - 1 whose common boundary is smooth: most of the edges across it, and a share
 * of the shorter perimeter, step by less than merge_ratio times a seed's step. Labels stay dense and in order. */
void vista_merge_regions(const vista_foveation *foveation, const vista_segmentation_params *params,
                         const vista_camera *camera, const vista_cells *cells, vista_segmentation *segmentation);

#endif
