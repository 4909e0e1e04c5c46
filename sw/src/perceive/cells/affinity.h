/* Affinity of neighbouring cells (paper, equations 3 and 4) and its encoding as flow (equation 5).
 *
 *   d_ij = exp(-(max(|m(i) - m(j)|, mu) - mu)^2 / (2 sigma^2))     one term a feature: intensity, disparity
 *   w_ij = alpha_I d_I + (1 - alpha_I) d_D        form "sum", equation 3
 *   w_ij = d_I d_D                                form "product"
 *   F(w) = scale (w + 1) / 2                      encoding "linear", equation 5 as printed
 *   F(w) = scale C^((w - 1) / 2)                  encoding "exponential": spans sqrt(C), so that a long true contour
 *                                                 is cheaper than the trivial cut around a few cells
 *
 * Where either cell has no disparity its term says nothing: w_ij is then the intensity term alone. */
#ifndef VISTA_AFFINITY_H
#define VISTA_AFFINITY_H

#include <stdint.h>

#include "common/arena.h"
#include "perceive/cells/cells.h"
#include "perceive/cells/foveation.h"
#include "perceive/frame_view.h"
#include "vista/parameters.h"
#include "vista/status.h"

#define VISTA_FLOW_SCALE 10000.0 /* capacity of an edge of affinity 1 */

typedef struct vista_affinity {
  float *weight;     /* graph.arc_count: w_ij, 0 .. 1; both arcs of an edge are equal */
  int32_t *capacity; /* graph.arc_count: F(w_ij) */
  int32_t *intensity_capacity; /* graph.arc_count: F(d_I), as if no disparity were known */
} vista_affinity;

vista_status vista_affinity_layout(vista_affinity *affinity, vista_arena *arena, const vista_foveation *foveation);

void vista_affinity_compute(const vista_frame_view *frame, const vista_cells *cells, vista_affinity *affinity);

/* F(w) for an affinity of 0 .. 1: at least VISTA_FLOW_SCALE / 100, so that the graph stays connected. */
int32_t vista_flow_encode(const vista_affinity_params *params, double affinity);

#endif
