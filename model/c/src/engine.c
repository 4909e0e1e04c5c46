/* The band driver: rows of both images enter once, in order, and one row of words leaves for each. */
#include "vista/engine.h"

#include <string.h>

#include "rows.h"

enum { ALIGNMENT = 64, RING_ROWS = VISTA_ENGINE_MAX_BLOCK_SIZE + 1 };

/* What a band keeps. The last block_size + 1 rows lie in rings: the one that leaves is one more than a block above
 * the one that enters. */
typedef struct band {
  uint8_t *left, *right; /* pixels that are matched; right mirrored */
  uint8_t *sobel;        /* x-Sobel of the left image, for the texture; the same as left unless prefilter is none */
  uint8_t *blank;        /* a row equal in both images and without texture, in place of one that is not there */
  uint8_t *filtered;     /* right row before it is mirrored */
  uint16_t *columns, *texture_columns, *texture;
  uint32_t *work;
  uint8_t *valid;
  vista_winner_row winner; /* with room for rivals, wanted or not */
} band;

typedef struct layout {
  unsigned char *base; /* NULL: only count */
  size_t used;
} layout;

static void *take(layout *at, size_t bytes) {
  void *place = at->base ? at->base + at->used : NULL;
  at->used += (bytes + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT;
  return place;
}

static size_t padded(int32_t width) { return (size_t)width + 2 * VISTA_ROWS_PAD; }

/* A row of items with VISTA_ROWS_PAD spare ones at both ends. */
static void *take_row(layout *at, int32_t width, size_t item_bytes) {
  unsigned char *place = take(at, padded(width) * item_bytes);
  return place ? place + VISTA_ROWS_PAD * item_bytes : NULL;
}

static int32_t lanes_of(const vista_engine_params *params) {
  if (params->num_disparities <= VISTA_ROWS_LANES / 2) return VISTA_ROWS_LANES / 2;
  return (params->num_disparities + VISTA_ROWS_LANES - 1) / VISTA_ROWS_LANES * VISTA_ROWS_LANES;
}

static size_t lay_out(band *b, void *memory, const vista_engine_params *params, int32_t width) {
  layout at = {memory, 0};
  const size_t rows = (size_t)params->block_size + 1;
  b->left = take(&at, rows * padded(width));
  b->right = take(&at, rows * padded(width));
  b->sobel = params->prefilter == VISTA_ENGINE_PREFILTER_NONE ? take(&at, rows * padded(width)) : b->left;
  b->blank = take(&at, padded(width));
  b->filtered = take(&at, padded(width));
  b->columns = take(&at, padded(width) * (size_t)lanes_of(params) * sizeof *b->columns);
  b->texture_columns = take_row(&at, width, sizeof *b->texture_columns);
  b->texture = take_row(&at, width, sizeof *b->texture);
  b->work = take(&at, 4 * padded(width) * sizeof *b->work);
  b->valid = take_row(&at, width, sizeof *b->valid);
  b->winner.cost = take_row(&at, width, sizeof *b->winner.cost);
  b->winner.around = take_row(&at, width, 2 * sizeof *b->winner.around);
  b->winner.unique = take_row(&at, width, sizeof *b->winner.unique);
  b->winner.best = take_row(&at, width, sizeof *b->winner.best);
  b->winner.right_best = take_row(&at, width, sizeof *b->winner.right_best);
  b->winner.rival = take_row(&at, width, sizeof *b->winner.rival);
  b->winner.rival_cost = take_row(&at, width, sizeof *b->winner.rival_cost);
  return at.used;
}

/* Step 1 for one row of one image; rows are mirrored without repeating the edge row, and the last row of an image
 * of odd height has no gradient (both as OpenCV does it). */
static void filter_row(const vista_row_code *code, int32_t cap, const uint8_t *image, ptrdiff_t stride, int32_t width,
                       int32_t height, int32_t y, uint8_t *out) {
  if (y == height - 1 && height % 2 == 1) {
    memset(out, cap, (size_t)width);
    return;
  }
  const int32_t above = y == 0 ? 1 : y - 1, below = y == height - 1 ? height - 2 : y + 1;
  code->xsobel(image + above * stride, image + y * stride, image + below * stride, width, cap, out);
}

static uint8_t *ring_row(uint8_t *ring, const vista_engine_params *params, int32_t width, int32_t y) {
  return ring + (size_t)(y % (params->block_size + 1)) * padded(width);
}

static void enter_row(const band *b, const vista_row_code *code, const vista_engine_params *params,
                      const vista_engine_images *images, int32_t textured, int32_t y) {
  const int32_t width = images->width, height = images->height, cap = params->prefilter_cap;
  const uint8_t *right = images->right + y * images->right_stride;
  if (params->prefilter == VISTA_ENGINE_PREFILTER_XSOBEL) {
    filter_row(code, cap, images->right, images->right_stride, width, height, y, b->filtered);
    right = b->filtered;
  } else {
    memcpy(ring_row(b->left, params, width, y), images->left + y * images->left_stride, (size_t)width);
  }
  if (params->prefilter == VISTA_ENGINE_PREFILTER_XSOBEL || textured)
    filter_row(code, cap, images->left, images->left_stride, width, height, y, ring_row(b->sobel, params, width, y));
  code->mirror(right, width, ring_row(b->right, params, width, y));
}

static void fill_row(const vista_engine_output *output, int32_t y, int32_t first, int32_t end) {
  int16_t *disparity = output->disparity + y * output->disparity_stride;
  for (int32_t x = first; x < end; ++x) disparity[x] = VISTA_DISPARITY_INVALID;
  if (output->smin) {
    uint32_t *smin = output->smin + y * output->smin_stride;
    for (int32_t x = first; x < end; ++x) smin[x] = VISTA_ENGINE_NO_COST;
  }
  if (output->confidence) {
    uint16_t *confidence = output->confidence + y * output->confidence_stride;
    for (int32_t x = first; x < end; ++x) confidence[x] = VISTA_ENGINE_NO_CONFIDENCE;
  }
}

static void run_band(band *b, const vista_engine_params *params, const vista_engine_images *images,
                     const vista_engine_output *output, int32_t first_row, int32_t end_row) {
  const vista_row_code *code = vista_row_code_of((vista_engine_isa)params->isa);
  const int32_t width = images->width, radius = params->block_size / 2;
  const int32_t first_x = params->num_disparities - 1 + radius, end_x = width - radius;
  const int32_t first_y = first_row > radius ? first_row : radius;
  const int32_t end_y = end_row < images->height - radius ? end_row : images->height - radius;
  if (first_x >= end_x || first_y >= end_y) {
    for (int32_t y = first_row; y < end_row; ++y) fill_row(output, y, 0, width);
    return;
  }

  const int32_t full_range = params->prefilter == VISTA_ENGINE_PREFILTER_NONE;
  const int32_t textured = params->texture_threshold > 0 || output->confidence;
  vista_winner_row winner = b->winner;
  if (!output->confidence) winner.rival = NULL;
  vista_match_job match = {
      .width = width,
      .num_disparities = params->num_disparities,
      .lanes = lanes_of(params),
      .block_size = params->block_size,
      .uniqueness_ratio = params->uniqueness_ratio,
      .check = params->lr_max_diff >= 0,
      .full_range = full_range,
      .wide = full_range && params->block_size > VISTA_ROWS_MAX_NARROW_BLOCK,
      .columns = b->columns,
      .work = b->work,
      .winner = winner,
  };
  vista_finish_job finish = {
      .first = first_x,
      .end = end_x,
      .num_disparities = params->num_disparities,
      .texture_threshold = params->texture_threshold,
      .lr_max_diff = params->lr_max_diff,
      .winner = winner,
      .texture = b->texture,
      .valid = b->valid,
  };
  memset(b->blank, params->prefilter_cap, padded(width));
  memset(b->columns, 0, (size_t)width * (size_t)match.lanes * sizeof *b->columns);
  memset(b->texture_columns, 0, (size_t)width * sizeof *b->texture_columns);

  for (int32_t y = first_row; y < first_y; ++y) fill_row(output, y, 0, width);
  for (int32_t in = first_y - radius; in < end_y + radius; ++in) {
    const int32_t y = in - radius, out = in - params->block_size;
    const int32_t leaves = out >= first_y - radius;
    enter_row(b, code, params, images, textured, in);
    match.left_in = ring_row(b->left, params, width, in);
    match.right_in = ring_row(b->right, params, width, in);
    match.left_out = leaves ? ring_row(b->left, params, width, out) : b->blank;
    match.right_out = leaves ? ring_row(b->right, params, width, out) : b->blank;
    if (textured)
      code->texture_columns(ring_row(b->sobel, params, width, in),
                            leaves ? ring_row(b->sobel, params, width, out) : b->blank, width, params->prefilter_cap,
                            b->texture_columns);
    if (y < first_y) {
      code->add_row(&match);
      continue;
    }
    if (textured) code->texture_sums(b->texture_columns, width, params->block_size, b->texture);
    code->match(&match);
    finish.disparity = output->disparity + y * output->disparity_stride;
    if (output->confidence) finish.confidence = output->confidence + y * output->confidence_stride;
    code->finish(&finish);
    fill_row(output, y, 0, first_x);
    fill_row(output, y, end_x, width);
    if (output->smin)
      memcpy(output->smin + y * output->smin_stride + first_x, b->winner.cost + first_x,
             (size_t)(end_x - first_x) * sizeof *output->smin);
  }
  for (int32_t y = end_y > first_row ? end_y : first_row; y < end_row; ++y) fill_row(output, y, 0, width);
}

static int in_range(int32_t value, int32_t low, int32_t high) { return value >= low && value <= high; }

size_t vista_engine_scratch_bytes(const vista_engine_params *params, int32_t width, int32_t height, int32_t threads) {
  band counted;
  if (vista_engine_validate(params) != VISTA_ENGINE_OK || !in_range(width, 1, VISTA_ENGINE_MAX_SIDE_PX) ||
      !in_range(height, 1, VISTA_ENGINE_MAX_SIDE_PX) || !in_range(threads, 1, VISTA_ENGINE_MAX_THREADS))
    return 0;
  return lay_out(&counted, NULL, params, width) * (size_t)threads;
}

vista_engine_status vista_engine_compute_rows(const vista_engine_params *params, const vista_engine_images *images,
                                              const vista_engine_output *output, int32_t first_row, int32_t end_row,
                                              void *scratch, size_t scratch_bytes) {
  const vista_engine_status status = vista_engine_validate(params);
  if (status != VISTA_ENGINE_OK) return status;
  if (!images || !images->left || !images->right || !output || !output->disparity || !scratch)
    return VISTA_ENGINE_ERROR_ARGUMENT;
  const int32_t width = images->width, height = images->height;
  if (!in_range(width, 1, VISTA_ENGINE_MAX_SIDE_PX) || !in_range(height, 1, VISTA_ENGINE_MAX_SIDE_PX))
    return VISTA_ENGINE_ERROR_SIZE;
  if (images->left_stride < width || images->right_stride < width || output->disparity_stride < width ||
      (output->smin && output->smin_stride < width) || (output->confidence && output->confidence_stride < width))
    return VISTA_ENGINE_ERROR_STRIDE;
  if (first_row < 0 || first_row > end_row || end_row > height) return VISTA_ENGINE_ERROR_ROWS;
  if ((uintptr_t)scratch % ALIGNMENT != 0 || scratch_bytes < vista_engine_scratch_bytes(params, width, height, 1))
    return VISTA_ENGINE_ERROR_SCRATCH;
  band b;
  lay_out(&b, scratch, params, width);
  run_band(&b, params, images, output, first_row, end_row);
  return VISTA_ENGINE_OK;
}

vista_engine_status vista_engine_compute(const vista_engine_params *params, const vista_engine_images *images,
                                         const vista_engine_output *output, void *scratch, size_t scratch_bytes) {
  const int32_t height = images ? images->height : 0;
  return vista_engine_compute_rows(params, images, output, 0, height, scratch, scratch_bytes);
}
