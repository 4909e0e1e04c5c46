#include "follow/track_evidence.h"

#include <math.h>
#include <stddef.h>
#include <stdint.h>

#define SAMPLES 24          /* rows and columns looked at, at most */
#define OWN_MIN_PX 1.0      /* within this of the track's disparity is its own surface */
#define OWN_SHARE 0.15      /* or within this share of it: a thing has depth */
#define MATCHED_SHARE 0.25  /* of the face, below which the words say nothing */
#define SIGMA_MIN_PX 0.25   /* of the mean: the words of a face share their errors */

typedef struct span {
  int32_t first, last, step;
} span;

/* The pixels center +- half within [low, high]; empty: first > last. */
static span clip(double center, double half, double low, double high) {
  const int32_t first = (int32_t)ceil(fmax(center - half, low)), last = (int32_t)floor(fmin(center + half, high));
  const int32_t step = (last - first) / SAMPLES + 1;
  return (span){first, last, step};
}

vista_track_evidence vista_track_look_for(const vista_camera *camera, const vista_matched_area *matched,
                                          const vista_disparity_image *disparity, const vista_track_view *view) {
  if (disparity == NULL) return (vista_track_evidence){.sight = VISTA_SIGHT_SOMETHING};
  const double u = view->measurement_px[0], v = view->measurement_px[1], d = view->measurement_px[2];
  const vista_margins margins = vista_matched_margins(matched, d);
  const double margin = margins.other_px;
  const span columns = clip(u, fmax(view->half_px[0], 0.5), margins.left_px, camera->width_px - 1 - margin);
  const span rows = clip(v, fmax(view->half_px[1], 0.5), margin, camera->height_px - 1 - margin);
  const double reach_px = fmax(OWN_MIN_PX, OWN_SHARE * d);
  const double low = VISTA_DISPARITY_SCALE * (d - reach_px), high = VISTA_DISPARITY_SCALE * (d + reach_px);
  int32_t pixels = 0, valid = 0, own = 0;
  double sum = 0.0, sum2 = 0.0;
  for (int32_t y = rows.first; y <= rows.last; y += rows.step) {
    const int16_t *const row = disparity->data + y * disparity->stride;
    for (int32_t x = columns.first; x <= columns.last; x += columns.step) {
      const double word = row[x];
      pixels += 1;
      if (row[x] < 0) continue;
      valid += 1;
      if (word < low || word > high) continue;
      own += 1;
      sum += word;
      sum2 += word * word;
    }
  }
  if (valid == 0 || valid < MATCHED_SHARE * pixels) return (vista_track_evidence){.sight = VISTA_SIGHT_NOTHING};
  if (2 * own < valid) return (vista_track_evidence){.sight = VISTA_SIGHT_SOMETHING};
  const double mean = sum / own, spread = sqrt(fmax(sum2 / own - mean * mean, 0.0));
  return (vista_track_evidence){VISTA_SIGHT_ITSELF, mean / VISTA_DISPARITY_SCALE,
                                fmax(spread / VISTA_DISPARITY_SCALE, SIGMA_MIN_PX)};
}
