#include "stages/parts/track_evidence.h"

#include <math.h>
#include <stddef.h>
#include <stdint.h>

#define SAMPLES 24          /* rows and columns looked at, at most */
#define BEHIND_MIN_PX 1.0   /* nearer to the track's disparity than this is its own surface */
#define BEHIND_SHARE 0.15   /* or than this share of it: a thing has depth */
#define MATCHED_SHARE 0.25  /* of the face, below which the words say nothing */

typedef struct span {
  int32_t first, last, step;
} span;

/* The pixels center +- half within [low, high]; empty: first > last. */
static span clip(double center, double half, double low, double high) {
  const int32_t first = (int32_t)ceil(fmax(center - half, low)), last = (int32_t)floor(fmin(center + half, high));
  const int32_t step = (last - first) / SAMPLES + 1;
  return (span){first, last, step};
}

bool vista_track_seen_through(const vista_camera *camera, const vista_matched_area *matched,
                              const vista_disparity_image *disparity, const vista_track_view *view) {
  if (disparity == NULL) return true;
  const double u = view->measurement_px[0], v = view->measurement_px[1], d = view->measurement_px[2];
  const vista_margins margins = vista_matched_margins(matched, d);
  const double margin = margins.other_px;
  const span columns = clip(u, fmax(view->half_px[0], 0.5), margins.left_px, camera->width_px - 1 - margin);
  const span rows = clip(v, fmax(view->half_px[1], 0.5), margin, camera->height_px - 1 - margin);
  const double behind_word = VISTA_DISPARITY_SCALE * (d - fmax(BEHIND_MIN_PX, BEHIND_SHARE * d));
  int32_t pixels = 0, valid = 0, behind = 0;
  for (int32_t y = rows.first; y <= rows.last; y += rows.step) {
    const int16_t *const row = disparity->data + y * disparity->stride;
    for (int32_t x = columns.first; x <= columns.last; x += columns.step) {
      pixels += 1;
      valid += row[x] >= 0;
      behind += (row[x] >= 0) & (row[x] < behind_word);
    }
  }
  return valid > 0 && valid >= MATCHED_SHARE * pixels && 2 * behind > valid;
}
