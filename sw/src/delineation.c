#include "vista/delineation.h"

#include <math.h>
#include <stdbool.h>
#include <stddef.h>

#define MAX_CANDIDATES 8 /* a cell and its neighbours; the hub has more of these, and stays as it is */
#define STRETCH_PX 64    /* of a run, treated at once */

vista_status vista_delineation_layout(vista_delineation *delineation, vista_arena *arena,
                                      const vista_foveation *foveation) {
  if (delineation == NULL || arena == NULL || foveation == NULL) return VISTA_ERROR_ARGUMENT;
  const size_t pixels = (size_t)foveation->width_px * (size_t)foveation->height_px;
  delineation->label = vista_arena_take(arena, pixels, sizeof(int32_t));
  delineation->border = vista_arena_take(arena, (size_t)foveation->max_nodes, sizeof(uint8_t));
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

typedef struct candidate {
  float intensity, center_u, center_v, per_px2, penalty;
  int32_t label;
} candidate;

/* The cell itself first, so that it keeps what is as near to another one. */
static int32_t list_candidates(const vista_foveation *f, const vista_delineation_params *params,
                               const vista_cells *cells, const int32_t *label, const uint8_t *border, int32_t node,
                               candidate out[MAX_CANDIDATES]) {
  int32_t count = 0;
  const int32_t first = f->graph.first_arc[node], end = f->graph.first_arc[node + 1];
  for (int32_t arc = first - 1; arc < end && count < MAX_CANDIDATES; ++arc) {
    const int32_t i = arc < first ? node : f->graph.head[arc];
    if (i == 0) continue; /* the hub's size says nothing of how far it reaches */
    out[count++] = (candidate){.intensity = cells->intensity[i],
                               .center_u = f->center_u[i],
                               .center_v = f->center_v[i],
                               .per_px2 = (float)params->compactness / (f->size_px[i] * f->size_px[i]),
                               .penalty = border[i] ? (float)params->mixed_penalty : 0.0f,
                               .label = label[i]};
  }
  return count;
}

static void delineate_stretch(const vista_delineation_params *params, const candidate *candidates, int32_t count,
                              const uint8_t *pixels, int32_t u_px, int32_t v_px, int32_t length, int32_t *out) {
  const float per_level = (float)(1.0 / params->sigma_intensity), limit = (float)params->contrast_limit;
  float best[STRETCH_PX];
  for (int32_t k = 0; k < length; ++k) best[k] = INFINITY;
  for (int32_t c = 0; c < count; ++c) {
    const candidate one = candidates[c];
    const float dv = (float)v_px - one.center_v;
    const float fixed = one.penalty + one.per_px2 * dv * dv;
    for (int32_t k = 0; k < length; ++k) {
      const float du = (float)(u_px + k) - one.center_u;
      const float contrast = fabsf((float)pixels[k] - one.intensity) * per_level;
      const float cost = (contrast < limit ? contrast : limit) + fixed + one.per_px2 * du * du;
      const bool better = cost < best[k];
      best[k] = better ? cost : best[k];
      out[k] = better ? one.label : out[k];
    }
  }
}

vista_status vista_delineate(const vista_foveation *foveation, const vista_delineation_params *params,
                             const vista_image *image, const vista_cells *cells, const int32_t *label,
                             vista_delineation *delineation) {
  if (foveation == NULL || params == NULL || image == NULL || cells == NULL || label == NULL || delineation == NULL)
    return VISTA_ERROR_ARGUMENT;
  const vista_foveation *const f = foveation;
  if (image->width_px != f->width_px || image->height_px != f->height_px) return VISTA_ERROR_SIZE;
  mark_borders(&f->graph, label, delineation->border);
  for (int32_t node = 0; node < f->node_count; ++node) {
    candidate candidates[MAX_CANDIDATES];
    const bool follows = delineation->border[node] && node > f->point_count;
    const int32_t count =
        follows ? list_candidates(f, params, cells, label, delineation->border, node, candidates) : 0;
    for (int32_t r = f->first_run[node]; r < f->first_run[node + 1]; ++r) {
      const vista_run run = f->runs[r];
      int32_t *const out = delineation->label + (ptrdiff_t)run.v_px * f->width_px + run.u_px;
      for (int32_t k = 0; k < run.length_px; ++k) out[k] = label[node];
      if (!follows) continue;
      const uint8_t *const pixels = image->data + run.v_px * image->stride + run.u_px;
      for (int32_t start = 0; start < run.length_px; start += STRETCH_PX) {
        const int32_t rest = run.length_px - start, length = rest < STRETCH_PX ? rest : STRETCH_PX;
        delineate_stretch(params, candidates, count, pixels + start, run.u_px + start, run.v_px, length, out + start);
      }
    }
  }
  return VISTA_OK;
}
