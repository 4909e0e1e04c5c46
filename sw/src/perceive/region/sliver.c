#include "perceive/region/sliver.h"

#include <math.h>
#include <stdint.h>

#include "perceive/region/region_pixels.h"

#define NEARER 1.5 /* times the disparity of the region, and */
#define NEARER_PX 2.0     /* more than it by this: what leans, or has depth, is not before itself */
#define CLEAR_SHARE 0.2   /* of the own pixels: fewer that are not beside something nearer do not make a thing */
#define WIDEST_BLOCKS 2 /* wider regions reach out of what a block widens */

static bool beside_nearer(const int16_t *row, int32_t width, int32_t u, int32_t reach, int16_t nearer) {
  const int32_t first = u > reach ? u - reach : 0, last = u + reach < width ? u + reach : width - 1;
  int16_t most = 0;
  for (int32_t i = first; i <= last; ++i) most = row[i] > most ? row[i] : most;
  return most > nearer;
}

bool vista_region_is_sliver(const vista_region_view *w, const vista_region *region) {
  const vista_foveation *const f = w->foveation;
  const int32_t block = 2 * (int32_t)w->params->boundary_px; /* half of it to either side of an edge */
  if (region->pixel_count == 0 || region->max_u_px - region->min_u_px >= WIDEST_BLOCKS * block) return false;
  const double nearer_px = fmax(region->disparity_px * NEARER, region->disparity_px + NEARER_PX);
  if (nearer_px * VISTA_DISPARITY_SCALE >= INT16_MAX) return false;
  const int16_t nearer = (int16_t)(nearer_px * VISTA_DISPARITY_SCALE);
  const int16_t *own = w->pixels;
  int32_t beside = 0;
  for (int32_t m = 0; m < w->member_count; ++m) {
    const int32_t node = w->members[m];
    for (int32_t r = f->first_run[node]; r < f->first_run[node + 1]; ++r) {
      const vista_run run = f->runs[r];
      const int16_t *const row = w->disparity->data + run.v_px * w->disparity->stride;
      for (int32_t i = 0; i < run.length_px; ++i)
        beside += (w->own[m] == VISTA_ALL_PIXELS || (w->own[m] == VISTA_SOME_PIXELS && own[i] != 0)) &&
                  beside_nearer(row, f->width_px, run.u_px + i, block, nearer);
      own += run.length_px;
    }
  }
  return region->pixel_count - beside < CLEAR_SHARE * region->pixel_count;
}
