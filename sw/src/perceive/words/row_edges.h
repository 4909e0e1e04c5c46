/* Regions whose words tell of nothing but edges along the rows of the image. This step is not in the paper.
 *
 * Along an edge that lies along a row the image does not change, so its disparity cannot be seen: matching two side by
 * side cameras compares an edge at an angle a from the row with itself, and rows that are misaligned by e px shift its
 * disparity by e / tan(a). The rail of a fence, a kerb or a gutter gets words all the same, of noise and of whatever
 * else the block holds, and they agree with each other along its length: a surface that is metres off, or a thing of
 * its own beside the fence.
 *
 * How far the words can be trusted is what the structure tensor of the grey levels says. Its terms are the sums of
 * the squared gradients along the row and across it, over the region's pixels that have a word; the share of the
 * image's noise is taken off. Where the second is row_edge_ratio squared times the first, or more, the region is
 * unknown. */
#ifndef VISTA_ROW_EDGES_H
#define VISTA_ROW_EDGES_H

#include "perceive/cells/cells.h"
#include "perceive/frame_view.h"
#include "perceive/region/region.h"

/* Changes the verdict of accepted regions to VISTA_REGION_UNKNOWN; plain ones, which have no words, stay. */
void vista_row_edges_judge(const vista_frame_view *frame, const vista_cells *cells, vista_regions *regions);

#endif
