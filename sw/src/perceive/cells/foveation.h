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
#include "vista/parameters.h"
#include "vista/status.h"

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
  int32_t *cell_of_pixel;    /* height * width: node */
  int32_t *node_of_grid;     /* ring_count * sector_count: node or -1 */
  int32_t *first_run;        /* node_count + 1: runs of node i are runs[first_run[i] .. first_run[i+1]) */
  vista_run *runs;
  /* The runs row by row: where each ends in cell_of_pixel, its node, where its pixels begin when listed (below). */
  int32_t *end_in_rows, *node_in_rows, *listed_in_rows;
  int32_t *pixel_count; /* node_count: pixels owned; may be 0 for point cells */
  int32_t *first_pixel; /* node_count + 1: where the pixels of node i begin when they are listed run by run */
  int16_t *pixel_u, *pixel_v; /* of the pixels listed so, and VISTA_WORD_BLOCK more */
  float *center_u, *center_v; /* node_count: centre of the cell, px */
  float *size_px; /* node_count: width of the cell */
  float *arc_distance_px; /* graph.arc_count: between the centres of the two cells */
  vista_graph graph;
} vista_foveation;

/* Whether images of this size are handled: 16 to 8192 pixels a side. */
bool vista_foveation_handles(int32_t width_px, int32_t height_px);

/* What the grid of cells is laid out for: the size of the images, and the place of the fovea in them. */
typedef struct vista_fovea {
  int32_t width_px, height_px;
  double center_u_px, center_v_px;
} vista_fovea;

/* Lays the geometry out. A counting arena only counts. VISTA_ERROR_SIZE: vista_foveation_handles; VISTA_ERROR_RANGE: a
 * parameter, or a fovea outside of the image. */
vista_status vista_foveation_layout(vista_foveation *foveation, vista_arena *arena,
                                    const vista_foveation_params *params, const vista_fovea *fovea);

#endif
