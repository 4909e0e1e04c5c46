#include "perceive/words/row_edges.h"

#include <math.h>
#include <stdbool.h>
#include <stdint.h>

#include "common/numbers.h"

/* A region whose grey levels change at least this many times as much from row to row as along the rows is unknown. */
#define ROW_EDGE_RATIO 8.0
#define SAMPLES 1024 /* of a region, about: more tell no more */
#define FEWEST 10 /* that tell anything */
#define SOBEL_GAIN 12.0 /* variance of a Sobel response over that of a pixel: 2 (1 + 4 + 1) */
#define NOISE_ERROR 0.1 /* of its share: what is left of it when it is taken off */

typedef struct gradients {
  int32_t count;
  double along, across; /* sums of squared Sobel responses: along the row, and from row to row */
} gradients;

static inline void add_pixel(const vista_image *image, int32_t u, int32_t v, gradients *sum) {
  const uint8_t *const at = image->data + v * image->stride + u;
  const uint8_t *const above = at - image->stride, *const below = at + image->stride;
  const int32_t diagonal = below[1] - above[-1], other = below[-1] - above[1];
  const int32_t along = diagonal - other + 2 * (at[1] - at[-1]);
  const int32_t across = diagonal + other + 2 * (below[0] - above[0]);
  sum->along += (double)(along * along);
  sum->across += (double)(across * across);
  ++sum->count;
}

/* Every `step`-th of the region's pixels, where it has a word and the image has all its neighbours. */
static gradients gradients_of(const vista_foveation *f, const vista_image *image, const vista_cells *cells,
                              const int32_t *members, int32_t member_count) {
  const int32_t *const first_pixel = f->first_pixel;
  int32_t pixels = 0;
  for (int32_t m = 0; m < member_count; ++m) pixels += first_pixel[members[m] + 1] - first_pixel[members[m]];
  const int32_t step = pixels / SAMPLES + 1;
  gradients sum = {0};
  int32_t skip = 0;
  for (int32_t m = 0; m < member_count; ++m) {
    const int32_t end = first_pixel[members[m] + 1];
    int32_t p = first_pixel[members[m]] + skip;
    for (; p < end; p += step) {
      const int32_t u = f->pixel_u[p], v = f->pixel_v[p];
      const bool inner = u > 0 && v > 0 && u < f->width_px - 1 && v < f->height_px - 1;
      if (inner && cells->words[p] > 0) add_pixel(image, u, v, &sum);
    }
    skip = p - end;
  }
  return sum;
}

static bool lies_along_rows(const gradients *sum, double ratio, double noise) {
  const double own = SOBEL_GAIN * vista_square(noise) * sum->count;
  const double along = fmax(sum->along - own, NOISE_ERROR * own), across = sum->across - own;
  return sum->count >= FEWEST && across > 0.0 && across >= vista_square(ratio) * along;
}

void vista_row_edges_judge(const vista_frame_view *frame, const vista_cells *cells, vista_regions *regions) {
  for (int32_t k = 0; k < regions->count; ++k) {
    vista_region *const region = &regions->items[k];
    if (region->verdict != VISTA_REGION_ACCEPTED || region->plain) continue;
    const int32_t first = regions->first_member[k], count = regions->first_member[k + 1] - first;
    const gradients sum = gradients_of(frame->foveation, &frame->image, cells, regions->members + first, count);
    if (!lies_along_rows(&sum, ROW_EDGE_RATIO, frame->noise.sigma)) continue;
    region->verdict = VISTA_REGION_UNKNOWN;
    --regions->accepted_count;
  }
}
