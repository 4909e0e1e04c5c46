/* Log-polar foveation with receptive fields (paper, section II-B).
 *
 * Cell (ring r, sector s) covers rho in rho_0 * [g^r, g^(r+1)), theta in 2 pi / S * [s, s+1), with g = exp(2 pi / S):
 * the mapping is conformal, so cells are square, rho * 2 pi / S pixels wide. Rings go on to the farthest corner of
 * the image, the outer ones in part: every pixel belongs to exactly one cell. The hub, rho < rho_0, is node 0.
 * Nodes are numbered hub first, then ring by ring, sector by sector; cells outside the image have no node.
 *
 * The graph joins ring and sector neighbours, wraps around in theta, and closes over the hub. */
#ifndef VISTA_FOVEATION_H
#define VISTA_FOVEATION_H

#include <stdbool.h>
#include <stdint.h>

#include "common/arena.h"
#include "common/graph.h"
#include "common/median.h"
#include "common/team.h"
#include "vista/parameters.h"
#include "vista/status.h"
#include "vista/types.h"

#define VISTA_MOST_SECTORS 256 /* of foveation.sector_count: bounds arrays on the stack */

/* Consecutive pixels of one image row that belong to one cell. */
typedef struct vista_run {
  int32_t u_px, v_px, length_px;
} vista_run;

typedef struct vista_foveation {
  int32_t width_px, height_px;
  int32_t ring_count, sector_count;
  int32_t node_count;
  int32_t max_nodes;               /* bound of node_count that is known before the cells are numbered */
  int32_t max_footprint_px;        /* bound of the pixels of one cell */
  int32_t point_count;             /* nodes 1 .. point_count have cells of about a pixel: sampled, not averaged */
  double center_u_px, center_v_px; /* of the fovea */
  double rho_0_px;
  const int32_t *cell_of_pixel;    /* height * width: node */
  const int32_t *node_of_grid;     /* ring_count * sector_count: node or -1 */
  const int32_t *first_run;        /* node_count + 1: runs of node i are runs[first_run[i] .. first_run[i+1]) */
  const vista_run *runs;
  /* The runs row by row: where each ends in cell_of_pixel, its node, where its pixels begin when listed (below). */
  const int32_t *end_in_rows, *node_in_rows, *listed_in_rows;
  const int32_t *pixel_count; /* node_count: pixels owned; may be 0 for point cells */
  const int32_t *first_pixel; /* node_count + 1: where the pixels of node i begin when they are listed run by run */
  const int16_t *pixel_u, *pixel_v; /* of the pixels listed so, and VISTA_WORD_BLOCK more */
  const float *center_u, *center_v; /* node_count: centre of the cell, px */
  const float *size_px; /* node_count: width of the cell */
  const float *arc_distance_px; /* graph.arc_count: between the centres of the two cells */
  vista_graph graph;
} vista_foveation;

/* One value a node. */
typedef struct vista_cells {
  float *intensity; /* grey level 0 .. 255, mean over the cell (bilinear sample for point cells) */
  float *disparity_px; /* median of the valid pixels; negative: too few of them */
  float *valid_fraction; /* of the cell's pixels that have a disparity, 0 .. 1 */
  vista_word_range *range; /* of the words of the cell's own pixels */
  int16_t *words; /* the engine words as foveation->first_pixel lists pixels, and VISTA_WORD_BLOCK more */
  uint8_t *greys; /* the grey levels, listed the same way */
  int16_t *of_cell[VISTA_MOST_WORKERS]; /* scratch: the words of one cell */
  vista_team *team; /* null: the calling thread alone */
} vista_cells;

/* Whether images of this size are handled: 16 to 8192 pixels a side. */
bool vista_foveation_handles(int32_t width_px, int32_t height_px);

/* Lays the geometry out for images of this size, the fovea at (center_u_px, center_v_px), which must lie inside the
 * image. A counting arena only counts. VISTA_ERROR_SIZE: vista_foveation_handles; VISTA_ERROR_RANGE. */
vista_status vista_foveation_layout(vista_foveation *foveation, vista_arena *arena,
                                    const vista_foveation_params *params, int32_t width_px, int32_t height_px,
                                    double center_u_px, double center_v_px);

vista_status vista_cells_layout(vista_cells *cells, vista_arena *arena, const vista_foveation *foveation);

/* Averages the receptive field of every cell. VISTA_ERROR_SIZE if an image differs from the geometry. */
vista_status vista_foveate(const vista_foveation *foveation, const vista_foveation_params *params,
                           const vista_image *image, const vista_disparity_image *disparity, vista_cells *cells);

#endif
