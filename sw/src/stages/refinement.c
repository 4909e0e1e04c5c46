#include "stages/refinement.h"

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <string.h>

#include "common/frame.h"
#include "common/parameters_check.h"
#include "common/wide_vectors.h"

#define MAX_CANDIDATES 8 /* a cell and its neighbours; the hub has more of these, and stays as it is */
#define BATCH 256        /* pixels treated at once */
#define LANES 8          /* counts are rounded up to a multiple, so that loops need no remainder */
#define COST_ONE 65536.0f /* of the costs as whole numbers; parameters and neighbours keep a cost below 4096 */

vista_status vista_refinement_layout(vista_refinement *refinement, vista_arena *arena,
                                     const vista_foveation *foveation) {
  if (refinement == NULL || arena == NULL || foveation == NULL) return VISTA_ERROR_ARGUMENT;
  const size_t pixels = (size_t)foveation->width_px * (size_t)foveation->height_px;
  refinement->label = vista_arena_take(arena, pixels, sizeof(int32_t));
  refinement->border = vista_arena_take(arena, (size_t)foveation->max_nodes, sizeof(uint8_t));
  return arena->base != NULL && arena->used > arena->size ? VISTA_ERROR_MEMORY : VISTA_OK;
}

static void mark_borders(const vista_graph *graph, const int32_t *label, uint8_t *border) {
  for (int32_t i = 0; i < graph->node_count; ++i) {
    bool differs = false;
    for (int32_t arc = graph->first_arc[i]; arc < graph->first_arc[i + 1]; ++arc)
      differs |= label[graph->head[arc]] != label[i];
    border[i] = differs;
  }
}

/* Cost of a pixel at (u, v) from the cell's own centre, but for contrast: at_center + per_u u + per_v v +
 * per_px2 (u^2 + v^2), the square of the distance from the candidate's centre multiplied out. */
typedef struct candidate {
  float intensity, at_center, per_u, per_v, per_px2;
  int32_t label;
} candidate;

/* The cell itself first, so that it keeps what is as near to another one. */
static int32_t list_candidates(const vista_foveation *f, const vista_refinement_params *params,
                               const vista_cells *cells, const int32_t *label, const uint8_t *border, int32_t node,
                               candidate out[MAX_CANDIDATES]) {
  const int32_t first = f->graph.first_arc[node], end = f->graph.first_arc[node + 1];
  int32_t count = 0;
  for (int32_t arc = first - 1; arc < end && count < MAX_CANDIDATES; ++arc) {
    const int32_t i = arc < first ? node : f->graph.head[arc];
    if (i == 0) continue; /* the hub's size says nothing of how far it reaches */
    const float u = f->center_u[i] - f->center_u[node], v = f->center_v[i] - f->center_v[node];
    const float per_px2 = (float)params->compactness / (f->size_px[i] * f->size_px[i]);
    const float penalty = border[i] ? (float)params->mixed_penalty : 0.0f;
    out[count++] = (candidate){.intensity = cells->intensity[i],
                               .at_center = penalty + per_px2 * (u * u + v * v),
                               .per_u = -2.0f * per_px2 * u,
                               .per_v = -2.0f * per_px2 * v,
                               .per_px2 = per_px2,
                               .label = label[i]};
  }
  return count;
}

/* Some pixels of one cell, side by side: its runs are too short for vectors. A run is appended in whole vectors; what
 * they hold beyond its end is overwritten or ignored. */
typedef struct batch {
  float u[BATCH + LANES], v[BATCH + LANES], square[BATCH + LANES], grey[BATCH + LANES];
  int32_t place[BATCH + LANES];
  int32_t best[BATCH]; /* cost and, in the lowest bits, candidate: of equal costs the first one's is smaller */
  int32_t count;
  uint8_t edge[BATCH]; /* a run at the right edge of the image, beyond which nothing may be read */
} batch;

static int32_t whole_vectors(int32_t count) { return (count + LANES - 1) & -LANES; }

/* Without a comparison of floats, which compilers do not turn into vectors: 2 min(a, b) = a + b - |a - b|. */
VISTA_WIDE_VECTORS static void solve(const vista_refinement_params *params, const candidate *candidates, int32_t count,
                                     batch *b, int32_t *out) {
  const float per_level = (float)(1.0 / params->sigma_intensity), limit = (float)params->contrast_limit;
  const int32_t padded = whole_vectors(b->count);
  for (int32_t k = b->count; k < padded; ++k) b->u[k] = b->v[k] = b->square[k] = b->grey[k] = 0.0f;
  for (int32_t k = 0; k < padded; ++k) b->best[k] = INT32_MAX;
  for (int32_t c = 0; c < count; ++c) {
    const candidate one = candidates[c];
    for (int32_t k = 0; k < padded; ++k) {
      const float levels = fabsf(b->grey[k] - one.intensity) * per_level;
      const float contrast = 0.5f * (levels + limit - fabsf(levels - limit));
      const float distance = one.at_center + one.per_u * b->u[k] + one.per_v * b->v[k] + one.per_px2 * b->square[k];
      const int32_t key = (int32_t)((contrast + distance) * COST_ONE) * MAX_CANDIDATES + c;
      b->best[k] = key < b->best[k] ? key : b->best[k];
    }
  }
  for (int32_t k = 0; k < b->count; ++k) out[b->place[k]] = candidates[b->best[k] & (MAX_CANDIDATES - 1)].label;
  b->count = 0;
}

/* grey may be read in whole vectors. */
VISTA_WIDE_VECTORS static void append(batch *b, int32_t u, float center_u, float v, const uint8_t *grey, int32_t place,
                                      int32_t length) {
  for (int32_t i = 0; i < length; i += LANES) {
    const int32_t k = b->count + i;
    uint8_t levels[LANES];
    float lane_u[LANES];
    memcpy(levels, grey + i, sizeof levels);
    for (int32_t lane = 0; lane < LANES; ++lane) lane_u[lane] = (float)(u + i + lane) - center_u;
    memcpy(b->u + k, lane_u, sizeof lane_u);
    for (int32_t lane = 0; lane < LANES; ++lane) b->v[k + lane] = v;
    for (int32_t lane = 0; lane < LANES; ++lane) b->square[k + lane] = lane_u[lane] * lane_u[lane] + v * v;
    for (int32_t lane = 0; lane < LANES; ++lane) b->grey[k + lane] = (float)levels[lane];
    for (int32_t lane = 0; lane < LANES; ++lane) b->place[k + lane] = place + i + lane;
  }
  b->count += length;
}

static void refine_cell(const vista_foveation *f, const vista_refinement_params *params, const vista_image *image,
                        const candidate *candidates, int32_t count, int32_t node, batch *b, int32_t *out) {
  for (int32_t r = f->first_run[node]; r < f->first_run[node + 1]; ++r) {
    const vista_run run = f->runs[r];
    const float v = (float)run.v_px - f->center_v[node];
    for (int32_t u = run.u_px, end = run.u_px + run.length_px; u < end;) {
      const int32_t room = BATCH - b->count, length = end - u < room ? end - u : room;
      const uint8_t *grey = image->data + run.v_px * image->stride + u;
      if (u + whole_vectors(length) > f->width_px) grey = memcpy(b->edge, grey, (size_t)length);
      append(b, u, f->center_u[node], v, grey, run.v_px * f->width_px + u, length);
      u += length;
      if (b->count == BATCH) solve(params, candidates, count, b, out);
    }
  }
  solve(params, candidates, count, b, out);
}

vista_status vista_refine(const vista_foveation *foveation, const vista_refinement_params *params,
                          const vista_image *image, const vista_cells *cells, const int32_t *label,
                          vista_refinement *refinement) {
  if (foveation == NULL || params == NULL || image == NULL || cells == NULL || label == NULL || refinement == NULL)
    return VISTA_ERROR_ARGUMENT;
  const vista_foveation *const f = foveation;
  vista_status status = VISTA_CHECK_SECTION(refinement, params);
  if (status == VISTA_OK) status = vista_frame_check_image(image, f->width_px, f->height_px);
  if (status != VISTA_OK) return status;
  mark_borders(&f->graph, label, refinement->border);
  for (ptrdiff_t p = 0; p < (ptrdiff_t)f->width_px * f->height_px; ++p)
    refinement->label[p] = label[f->cell_of_pixel[p]];
  batch b = {0};
  for (int32_t node = f->point_count + 1; node < f->node_count; ++node) {
    if (!refinement->border[node]) continue;
    candidate candidates[MAX_CANDIDATES];
    const int32_t count = list_candidates(f, params, cells, label, refinement->border, node, candidates);
    refine_cell(f, params, image, candidates, count, node, &b, refinement->label);
  }
  return VISTA_OK;
}
