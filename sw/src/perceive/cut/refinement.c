#include "perceive/cut/refinement.h"

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <string.h>

#include "common/wide_vectors.h"
#include "common/word_blocks.h"

/* A difference of a pixel from a cell that weighs as much as one cell of distance at compactness 1. */
#define SIGMA_LEVELS 10.0
#define SIGMA_NOISE 1.5 /* SIGMA_LEVELS is at least this many sigmas of the noise of the image */
#define CONTRAST_LIMIT 3.0 /* in sigma_intensity: a larger difference weighs no more */
#define MIXED_PENALTY 0.75 /* cost of a cell at a border: it may show parts of both regions */
#define COMPACTNESS 0.5 /* cost of a pixel one cell's size away from the centre of a cell */
/* So much farther than a cell a pixel weighs as much as one sigma_intensity; a nearer one costs nothing. */
#define SIGMA_DISPARITY_PX 0.5
#define DISPARITY_LIMIT 2.0 /* in SIGMA_DISPARITY_PX: a larger difference weighs no more */
#define MAX_CANDIDATES 8 /* a cell and its neighbours; the hub has more of these, and stays as it is */
#define BATCH 256 /* pixels treated at once */
#define COST_ONE 65536.0f /* of the costs as whole numbers; parameters and neighbours keep a cost below 4096 */
#define COST_OF_WORD ((int32_t)(65536.0 / (SIGMA_DISPARITY_PX * VISTA_DISPARITY_SCALE)))
#define MOST_OF_WORDS ((int32_t)(65536.0 * DISPARITY_LIMIT))
#define LANES 8 /* of the widest vectors */

vista_status vista_refinement_layout(vista_refinement *refinement, vista_arena *arena,
                                     const vista_foveation *foveation) {
  const size_t pixels = (size_t)foveation->width_px * (size_t)foveation->height_px;
  refinement->label = vista_arena_take(arena, pixels, sizeof(int32_t));
  refinement->listed = vista_arena_take(arena, pixels + VISTA_WORD_BLOCK, sizeof(int32_t));
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
  float intensity, word, at_center, per_u, per_v, per_px2;
  int32_t label;
} candidate;

/* The cell itself first, so that it keeps what is as near to another one. */
static int32_t list_candidates(const vista_foveation *f, const vista_cells *cells, const int32_t *label,
                               const uint8_t *border, int32_t node, candidate out[MAX_CANDIDATES]) {
  const int32_t first = f->graph.first_arc[node], end = f->graph.first_arc[node + 1];
  int32_t count = 0;
  for (int32_t arc = first - 1; arc < end && count < MAX_CANDIDATES; ++arc) {
    const int32_t i = arc < first ? node : f->graph.head[arc];
    if (i == 0) continue; /* the hub's size says nothing of how far it reaches */
    const float u = f->center_u[i] - f->center_u[node], v = f->center_v[i] - f->center_v[node];
    const float per_px2 = (float)COMPACTNESS / (f->size_px[i] * f->size_px[i]);
    const float penalty = border[i] ? (float)MIXED_PENALTY : 0.0f;
    out[count++] = (candidate){.intensity = cells->intensity[i],
                               .word = cells->disparity_px[i] * VISTA_DISPARITY_SCALE,
                               .at_center = penalty + per_px2 * (u * u + v * v),
                               .per_u = -2.0f * per_px2 * u,
                               .per_v = -2.0f * per_px2 * v,
                               .per_px2 = per_px2,
                               .label = label[i]};
  }
  return count;
}

/* Some pixels of one cell, side by side, and blank ones up to whole vectors. */
typedef struct batch {
  float u[BATCH], v[BATCH], r2[BATCH], grey[BATCH];
  int32_t word_cost[BATCH];
  int32_t cost[BATCH], label[BATCH]; /* the least so far, and whose it is */
} batch;

static inline int32_t whole_vectors(int32_t count) { return (count + LANES - 1) & -LANES; }

/* Gives pixels to a candidate where it costs less than those before; equal costs leave a pixel where it is. Floats are
 * not compared, which would take longer: min(a, b) = a / 2 + b / 2 - |a / 2 - b / 2|. Words of cells are whole. */
static inline void try_candidate(double sigma_levels, const candidate *one, int32_t count, batch *b) {
  const float half_per_level = 0.5f * COST_ONE * (float)(1.0 / sigma_levels);
  const float half_limit = 0.5f * COST_ONE * (float)CONTRAST_LIMIT;
  const float intensity = one->intensity, at_center = COST_ONE * one->at_center;
  const float per_u = COST_ONE * one->per_u, per_v = COST_ONE * one->per_v, per_px2 = COST_ONE * one->per_px2;
  const int32_t word_cost = one->word < 0.0f ? 0 : COST_OF_WORD * (int32_t)one->word, own = one->label;
  for (int32_t k = 0; k < whole_vectors(count); ++k) {
    const float levels = fabsf(b->grey[k] - intensity) * half_per_level;
    const float contrast = levels + half_limit - fabsf(levels - half_limit);
    const int32_t beyond = word_cost - b->word_cost[k]; /* positive: the pixel is farther than the cell */
    const int32_t counted = beyond > 0 ? beyond : 0, step = counted < MOST_OF_WORDS ? counted : MOST_OF_WORDS;
    const float distance = at_center + per_u * b->u[k] + per_v * b->v[k] + per_px2 * b->r2[k];
    const int32_t cost = (int32_t)(contrast + (float)step + distance), best = b->cost[k], old = b->label[k];
    b->label[k] = cost < best ? own : old;
    b->cost[k] = cost < best ? cost : best;
  }
}

/* The pixels of a cell, as the foveation lists them: at (us, vs), with these grey levels and words. */
typedef struct cell_pixels {
  const int16_t *us, *vs;
  const uint8_t *greys;
  const int16_t *words;
} cell_pixels;

/* Fills a block of a batch, k on, with the `count` pixels from `first` on. */
static inline void fill_block(const cell_pixels *pixels, int32_t first, int32_t count, float center_u, float center_v,
                              int32_t k, batch *b) {
  const int16_t *const us = pixels->us + first, *const vs = pixels->vs + first, *const words = pixels->words + first;
  const uint8_t *const greys = pixels->greys + first;
  VISTA_BLOCK_LOOP
  for (int32_t i = 0; i < VISTA_WORD_BLOCK; ++i) {
    const float du = (float)us[i] - center_u, dv = (float)vs[i] - center_v;
    const float u = i < count ? du : 0.0f, v = i < count ? dv : 0.0f;
    const int32_t word = words[i];
    b->u[k + i] = u;
    b->v[k + i] = v;
    b->r2[k + i] = u * u + v * v;
    b->grey[k + i] = (float)greys[i];
    b->word_cost[k + i] = COST_OF_WORD * (word < 0 ? INT16_MAX : word); /* unknown: farther than nothing */
    b->cost[k + i] = INT32_MAX;
    b->label[k + i] = 0;
  }
}

VISTA_WIDE_VECTORS static void solve(double sigma_levels, const candidate *candidates, int32_t candidate_count,
                                     const cell_pixels *pixels, float center_u, float center_v, int32_t pixel_count,
                                     int32_t *label) {
  batch b;
  for (int32_t first = 0; first < pixel_count; first += BATCH) {
    const int32_t count = pixel_count - first < BATCH ? pixel_count - first : BATCH;
    for (int32_t k = 0; k < count; k += VISTA_WORD_BLOCK)
      fill_block(pixels, first + k, count - k, center_u, center_v, k, &b);
    for (int32_t c = 0; c < candidate_count; ++c) try_candidate(sigma_levels, &candidates[c], count, &b);
    int32_t k = 0;
    for (; k + LANES <= count; k += LANES) memcpy(label + first + k, b.label + k, LANES * sizeof *label);
    for (; k < count; ++k) label[first + k] = b.label[k];
  }
}

/* The run that pixel `p` belongs to, of the runs row by row. */
static int32_t run_at(const vista_foveation *f, int32_t p) {
  int32_t low = 0, high = f->first_run[f->node_count];
  while (low < high) {
    const int32_t middle = low + (high - low) / 2;
    if (f->end_in_rows[middle] > p)
      high = middle;
    else
      low = middle + 1;
  }
  return low;
}

/* Every pixel of some rows: as its cell, or as it is listed where the cell has a border. Runs are drawn in whole
 * vectors: the next one overwrites what is too much. */
VISTA_WIDE_VECTORS static void draw(const vista_foveation *f, int32_t first_row, int32_t end_row,
                                    const int32_t *restrict label, const uint8_t *restrict border,
                                    const int32_t *restrict listed, int32_t *restrict out) {
  const int32_t pixels = end_row * f->width_px;
  int32_t p = first_row * f->width_px;
  for (int32_t r = run_at(f, p); p < pixels; ++r) {
    const int32_t end = f->end_in_rows[r], node = f->node_in_rows[r], drawn = label[node];
    if (border[node]) {
      const int32_t *from = listed + f->listed_in_rows[r];
      for (; p < end && p + VISTA_WORD_BLOCK <= pixels; p += VISTA_WORD_BLOCK, from += VISTA_WORD_BLOCK)
        memcpy(out + p, from, VISTA_WORD_BLOCK * sizeof *out);
      for (; p < end; ++p) out[p] = *from++;
    } else {
      for (; p < end && p + VISTA_WORD_BLOCK <= pixels; p += VISTA_WORD_BLOCK)
        for (int32_t k = 0; k < VISTA_WORD_BLOCK; ++k) out[p + k] = drawn;
      for (; p < end; ++p) out[p] = drawn;
    }
    p = end;
  }
}

typedef struct job {
  const vista_foveation *foveation;
  double sigma_levels;
  const vista_cells *cells;
  const int32_t *label;
  vista_refinement *refinement;
} job;

#define PARTS 16

static void solve_part(void *context, int32_t part, int32_t worker) {
  (void)worker;
  const job *const j = context;
  const vista_foveation *const f = j->foveation;
  const uint8_t *const border = j->refinement->border;
  int32_t *const listed = j->refinement->listed;
  const int32_t k = PARTS - 1 - part; /* the last cells are the largest, so they come first */
  const int32_t first_node = f->node_count * k / PARTS, end_node = f->node_count * (k + 1) / PARTS;
  for (int32_t node = first_node; node < end_node; ++node) {
    if (!border[node]) continue;
    const int32_t first = f->first_pixel[node];
    if (node <= f->point_count) {
      for (int32_t p = first; p < f->first_pixel[node + 1]; ++p) listed[p] = j->label[node];
      continue;
    }
    candidate candidates[MAX_CANDIDATES];
    const int32_t count = list_candidates(f, j->cells, j->label, border, node, candidates);
    const cell_pixels all = {f->pixel_u + first, f->pixel_v + first, j->cells->greys + first, j->cells->words + first};
    solve(j->sigma_levels, candidates, count, &all, f->center_u[node], f->center_v[node], f->pixel_count[node],
          listed + first);
  }
}

static void draw_part(void *context, int32_t part, int32_t worker) {
  (void)worker;
  const job *const j = context;
  const int32_t height = j->foveation->height_px;
  draw(j->foveation, height * part / PARTS, height * (part + 1) / PARTS, j->label, j->refinement->border,
       j->refinement->listed, j->refinement->label);
}

void vista_refine(const vista_frame_view *frame, const vista_cells *cells, const int32_t *region_of_cell,
                  vista_refinement *refinement) {
  mark_borders(&frame->foveation->graph, region_of_cell, refinement->border);
  job j = {frame->foveation, vista_image_noise_threshold(&frame->noise, SIGMA_LEVELS, SIGMA_NOISE), cells,
           region_of_cell, refinement};
  vista_team_share(refinement->team, solve_part, &j, PARTS);
  vista_team_share(refinement->team, draw_part, &j, PARTS);
}
