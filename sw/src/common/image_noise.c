#include "common/image_noise.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "common/wide_vectors.h"

#define REACH 2          /* px from the centre of the mask to its outer taps */
#define BLOCK 16         /* side in px */
#define STRIP 32         /* blocks that are treated at once */
#define WIDTH (STRIP * BLOCK)
#define ROW_STEP 2       /* between the rows of a block that are looked at */
#define SAMPLES (BLOCK * BLOCK / ROW_STEP)
#define BINS 1024        /* of the mean absolute response */
#define BINS_PER_LEVEL 4
#define QUANTILE 5       /* the quietest one in so many */
#define CLIPPED_SHARE 8  /* a block with more than one clipped pixel in so many is clipped */
#define FEWEST_SHARE 16  /* fewer blocks that are not: all count */
/* sigma over that quantile of the mean absolute response: sqrt(pi / 2) / 6 for one normal response (the mask's gain is
 * 6), and 1.12 for pure noise, whose quietest fifth of blocks is so much too quiet. Texture makes up for half of that
 * in most images: the middle of both. */
#define SIGMA_PER_RESPONSE (1.2533 / 6.0 * 1.06)

/* A row of blocks; sums over its columns, which compilers turn into vectors. */
typedef struct strip {
  int16_t difference[WIDTH + 2 * REACH]; /* of a row, along its columns */
  uint16_t response[WIDTH], clipped[WIDTH];
} strip;

VISTA_WIDE_VECTORS static void add_row(const uint8_t *above, ptrdiff_t stride, int32_t width, strip *s) {
  const uint8_t *const middle = above + REACH * stride, *const below = middle + REACH * stride;
  for (int32_t x = 0; x < width + 2 * REACH; ++x) s->difference[x] = (int16_t)(above[x] - 2 * middle[x] + below[x]);
  for (int32_t x = 0; x < width; ++x) {
    const int16_t r = (int16_t)(s->difference[x] - 2 * s->difference[x + REACH] + s->difference[x + 2 * REACH]);
    const uint8_t grey = middle[x + REACH];
    s->response[x] = (uint16_t)(s->response[x] + (r < 0 ? -r : r));
    s->clipped[x] = (uint16_t)(s->clipped[x] + ((grey == 0) | (grey == 255)));
  }
}

/* Histograms of the mean absolute response of blocks: all of them, and those that are not clipped. */
typedef struct histograms {
  uint32_t all[BINS], clear[BINS];
  int64_t all_count, clear_count;
} histograms;

VISTA_WIDE_VECTORS static void add_blocks(const strip *s, int32_t blocks, histograms *h) {
  for (int32_t k = 0; k < blocks; ++k) {
    int32_t response = 0, clipped = 0;
    for (int32_t x = k * BLOCK; x < (k + 1) * BLOCK; ++x) {
      response += s->response[x];
      clipped += s->clipped[x];
    }
    const int32_t bin = response * BINS_PER_LEVEL / SAMPLES;
    const int32_t bounded = bin < BINS ? bin : BINS - 1;
    ++h->all[bounded];
    ++h->all_count;
    if (clipped * CLIPPED_SHARE > SAMPLES) continue;
    ++h->clear[bounded];
    ++h->clear_count;
  }
}

/* The bin of a quantile of what the histogram counts. */
static int32_t quantile_of(const uint32_t histogram[BINS], int64_t count) {
  int64_t below = 0;
  for (int32_t bin = 0; bin < BINS; ++bin) {
    below += histogram[bin];
    if (below * QUANTILE >= count) return bin;
  }
  return BINS - 1;
}

vista_status vista_image_noise_measure(const vista_image *image, vista_image_noise *noise) {
  if (image == NULL || noise == NULL || image->data == NULL) return VISTA_ERROR_ARGUMENT;
  histograms h = {0};
  const int32_t across = (image->width_px - 2 * REACH) / BLOCK;
  for (int32_t v = 0; v + BLOCK + 2 * REACH <= image->height_px; v += BLOCK) {
    for (int32_t first = 0; first < across; first += STRIP) {
      const int32_t blocks = across - first < STRIP ? across - first : STRIP;
      strip s = {0};
      for (int32_t y = v; y < v + BLOCK; y += ROW_STEP)
        add_row(image->data + y * image->stride + first * BLOCK, image->stride, blocks * BLOCK, &s);
      add_blocks(&s, blocks, &h);
    }
  }
  const bool enough = h.clear_count * FEWEST_SHARE >= h.all_count;
  const int32_t bin = enough ? quantile_of(h.clear, h.clear_count) : quantile_of(h.all, h.all_count);
  noise->sigma = bin == 0 || h.all_count == 0 ? 0.0 : SIGMA_PER_RESPONSE * (bin + 0.5) / BINS_PER_LEVEL;
  return VISTA_OK;
}
