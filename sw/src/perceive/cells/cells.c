#include "perceive/cells/cells.h"

#include <stdbool.h>
#include <stddef.h>
#include <string.h>

#include "common/numbers.h"
#include "common/wide_vectors.h"
#include "common/word_blocks.h"
#include "vista/parameters.h"
#include "vista/types.h"
#include "vista/word.h"

#define VALID_MIN_FRACTION 0.3 /* of its pixels with a disparity: fewer, and a cell has none */

vista_status vista_cells_layout(vista_cells *cells, vista_arena *arena, const vista_foveation *foveation) {
  const size_t node_count = (size_t)foveation->max_nodes;
  cells->intensity = vista_arena_take(arena, node_count, sizeof(float));
  cells->disparity_px = vista_arena_take(arena, node_count, sizeof(float));
  cells->valid_fraction = vista_arena_take(arena, node_count, sizeof(float));
  cells->range = vista_arena_take(arena, node_count, sizeof(vista_word_range));
  const size_t pixels = (size_t)foveation->width_px * (size_t)foveation->height_px;
  cells->words = vista_arena_take(arena, pixels + VISTA_WORD_BLOCK, sizeof(int16_t));
  cells->greys = vista_arena_take(arena, pixels + VISTA_WORD_BLOCK, sizeof(uint8_t));
  for (int k = 0; k < VISTA_MOST_WORKERS; ++k)
    cells->of_cell[k] =
        vista_arena_take(arena, (size_t)foveation->max_footprint_px + VISTA_MEDIAN_LANES, sizeof(int16_t));
  return arena->base != NULL && arena->used > arena->size ? VISTA_ERROR_MEMORY : VISTA_OK;
}

/* A block of words and grey levels, or as much of it as there is to the right edge of the image. */
static inline void copy_block(const int16_t *word, const uint8_t *grey, int32_t room_px, int16_t *words,
                              uint8_t *greys) {
  if (room_px >= VISTA_WORD_BLOCK) {
    memcpy(words, word, VISTA_WORD_BLOCK * sizeof *words);
    memcpy(greys, grey, VISTA_WORD_BLOCK * sizeof *greys);
  } else {
    memcpy(words, word, (size_t)room_px * sizeof *words);
    memcpy(greys, grey, (size_t)room_px * sizeof *greys);
  }
}

/* Some cells, one after the other. */
typedef struct span {
  int32_t first, end;
} span;

/* Words and grey levels, cell by cell. Runs are copied in whole blocks, mostly one: the next run overwrites what is too
 * much, and the last ones of the span are copied as they are. */
VISTA_WIDE_VECTORS static void list_pixels_of(const vista_foveation *f, const vista_image *image,
                                              const vista_disparity_image *disparity, span nodes, vista_cells *cells) {
  const ptrdiff_t image_stride = image->stride, disparity_stride = disparity->stride;
  const int32_t width = f->width_px;
  int16_t *words = cells->words + f->first_pixel[nodes.first];
  uint8_t *greys = cells->greys + f->first_pixel[nodes.first];
  int32_t left = f->first_pixel[nodes.end] - f->first_pixel[nodes.first]; /* pixels of the span */
  const vista_run *const end = f->runs + f->first_run[nodes.end];
  for (const vista_run *run = f->runs + f->first_run[nodes.first]; run < end; ++run) {
    const int32_t length = run->length_px;
    const int16_t *const word = disparity->data + run->v_px * disparity_stride + run->u_px;
    const uint8_t *const grey = image->data + run->v_px * image_stride + run->u_px;
    int32_t room = left >= VISTA_WORD_BLOCK ? width - run->u_px : length;
    copy_block(word, grey, room, words, greys);
    for (int32_t i = VISTA_WORD_BLOCK; i < length; i += VISTA_WORD_BLOCK) {
      room = left - i >= VISTA_WORD_BLOCK ? width - run->u_px - i : length - i;
      copy_block(word + i, grey + i, room, words + i, greys + i);
    }
    words += length;
    greys += length;
    left -= length;
  }
}

static float limited(float x, float most) { return vista_smaller(vista_larger(x, 0.0f), most); }

/* Cells under a pixel: intensity by bilinear interpolation, disparity from the 2x2 pixels around the centre. At the
 * image's edge a cell that holds a pixel may have its centre beyond it: there the edge is sampled. */
static void sample_point(const vista_foveation *f, const vista_image *image, const vista_disparity_image *disparity,
                         int32_t node, vista_cells *cells, int16_t words[4]) {
  const float center_u = limited(f->center_u[node], (float)(f->width_px - 1));
  const float center_v = limited(f->center_v[node], (float)(f->height_px - 1));
  int32_t u = (int32_t)center_u, v = (int32_t)center_v;
  if (u > f->width_px - 2) u = f->width_px - 2;
  if (v > f->height_px - 2) v = f->height_px - 2;
  const float s = center_u - (float)u, t = center_v - (float)v;
  const uint8_t *const p = image->data + v * image->stride + u;
  const uint8_t *const q = p + image->stride;
  cells->intensity[node] = (1 - t) * ((1 - s) * p[0] + s * p[1]) + t * ((1 - s) * q[0] + s * q[1]);
  const int16_t *const d = disparity->data + v * disparity->stride + u;
  words[0] = d[0];
  words[1] = d[1];
  words[2] = d[disparity->stride];
  words[3] = d[disparity->stride + 1];
}

VISTA_WIDE_VECTORS static float mean_of(const uint8_t *greys, int32_t count) {
  uint32_t sum = 0;
  for (int32_t i = 0; i < count; ++i) sum += greys[i];
  return (float)sum / (float)count;
}

static void set_disparity(const vista_words_median *median, int32_t count, int32_t node, vista_cells *cells) {
  cells->valid_fraction[node] = (float)median->range.valid / (float)count;
  const bool enough = median->range.valid > 0 && cells->valid_fraction[node] >= (float)VALID_MIN_FRACTION;
  cells->disparity_px[node] = enough ? (float)median->word / VISTA_DISPARITY_SCALE : -1.0f;
}

typedef struct job {
  const vista_foveation *foveation;
  const vista_image *image;
  const vista_disparity_image *disparity;
  vista_cells *cells;
} job;

static void foveate_cell(const job *j, int32_t node, int16_t *of_cell) {
  const vista_foveation *const f = j->foveation;
  vista_cells *const cells = j->cells;
  const bool point = node >= 1 && node <= f->point_count;
  const int32_t first = f->first_pixel[node], count = f->pixel_count[node];
  if (point) {
    int16_t words[4];
    sample_point(f, j->image, j->disparity, node, cells, words);
    const vista_words_median median = vista_median_of_four(words);
    set_disparity(&median, 4, node, cells);
    cells->range[node] = vista_range_of_words(cells->words + first, count);
  } else {
    cells->intensity[node] = mean_of(cells->greys + first, count);
    const vista_words_median median = vista_median_word(cells->words + first, count, of_cell);
    set_disparity(&median, count, node, cells);
    cells->range[node] = median.range;
  }
}

#define PARTS 16

/* The last cells are the largest, so they come first. */
static void foveate_part(void *context, int32_t part, int32_t worker) {
  const job *const j = context;
  const int32_t count = j->foveation->node_count, k = PARTS - 1 - part;
  const span nodes = {count * k / PARTS, count * (k + 1) / PARTS};
  list_pixels_of(j->foveation, j->image, j->disparity, nodes, j->cells);
  for (int32_t node = nodes.first; node < nodes.end; ++node) foveate_cell(j, node, j->cells->of_cell[worker]);
}

void vista_foveate(const vista_frame_view *frame, vista_cells *cells) {
  job j = {frame->foveation, &frame->image, &frame->words, cells};
  vista_team_share(cells->team, foveate_part, &j, PARTS);
}
