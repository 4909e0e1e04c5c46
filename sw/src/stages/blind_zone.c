#include "stages/blind_zone.h"

#include <math.h>
#include <stddef.h>
#include <stdlib.h>

#include "common/bits.h"
#include "common/frame.h"
#include "common/numbers.h"
#include "common/parameters_check.h"

#define ROW_STEP 2 /* neighbouring rows say the same */

typedef struct counts {
  int64_t pixels, textured, unmatched;
} counts;

/* Two words of one surface: both valid, a pixel apart at most. */
static int32_t alike(int32_t a, int32_t b) { return (b >= 0) & (abs(a - b) <= VISTA_DISPARITY_SCALE); }

/* block: what lies so far apart shares no matching block. */
static void count_row(const uint8_t *grey, const int16_t *words, int32_t first, int32_t last, int32_t block,
                      int32_t contrast, counts *sum) {
  int32_t textured = 0, unmatched = 0;
  for (int32_t u = first; u <= last; ++u) {
    const int32_t has_texture = abs(grey[u + 1] - grey[u - 1]) >= contrast;
    textured += has_texture;
    const int32_t is_matched =
        (words[u] >= 0) & (alike(words[u], words[u - block]) | alike(words[u], words[u + block]));
    unmatched += has_texture & !is_matched;
  }
  sum->pixels += last - first + 1;
  sum->textured += textured;
  sum->unmatched += unmatched;
}

static counts count_disc(const vista_blind_zone_params *params, const vista_camera *camera,
                         const vista_matched_area *matched, double radius_px, const vista_image *image,
                         const vista_disparity_image *disparity) {
  counts sum = {0};
  const int32_t block = 2 * (int32_t)matched->margin_px + 2;
  const double bottom = camera->height_px - 1 - matched->margin_px, right = camera->width_px - 1 - matched->margin_px;
  const int32_t v_first = (int32_t)ceil(fmax(camera->center_v_px - radius_px, matched->margin_px));
  const int32_t v_last = (int32_t)floor(fmin(camera->center_v_px + radius_px, bottom));
  for (int32_t v = v_first; v <= v_last; v += ROW_STEP) {
    const double dv = v - camera->center_v_px;
    const double half = sqrt(fmax(radius_px * radius_px - dv * dv, 0.0));
    const int32_t first = (int32_t)ceil(fmax(camera->center_u_px - half, matched->margin_left_px + block));
    const int32_t last = (int32_t)floor(fmin(camera->center_u_px + half, right - block));
    if (first > last) continue;
    count_row(image->data + v * image->stride, disparity->data + v * disparity->stride, first, last, block,
              params->contrast, &sum);
  }
  return sum;
}

vista_status vista_blind_zone_update(const vista_blind_zone_params *params, const vista_camera *camera,
                                     const vista_matched_area *matched, double radius_m, const vista_image *image,
                                     const vista_disparity_image *disparity, vista_blind_zone *blind_zone) {
  if (params == NULL || camera == NULL || matched == NULL || image == NULL || disparity == NULL || blind_zone == NULL)
    return VISTA_ERROR_ARGUMENT;
  vista_status status = VISTA_CHECK_SECTION(blind_zone, params);
  if (status == VISTA_OK) status = vista_frame_check_camera(camera);
  if (status == VISTA_OK) status = vista_matched_area_check(matched);
  if (status == VISTA_OK && !vista_positive(radius_m)) status = VISTA_ERROR_RANGE;
  if (status == VISTA_OK) status = vista_frame_check_image(image, camera->width_px, camera->height_px);
  if (status == VISTA_OK) status = vista_frame_check_disparity(disparity, camera->width_px, camera->height_px);
  if (status != VISTA_OK) return status;
  vista_blind_zone *const s = blind_zone;
  const double radius_px = radius_m * matched->disparity_max_px / camera->baseline_m;
  const counts sum = count_disc(params, camera, matched, radius_px, image, disparity);
  s->range_m = camera->focal_px * camera->baseline_m / matched->disparity_max_px;
  s->textured_fraction = sum.pixels > 0 ? (double)sum.textured / (double)sum.pixels : 0.0;
  s->unmatched_fraction = sum.textured > 0 ? (double)sum.unmatched / (double)sum.textured : 0.0;
  const bool now =
      s->textured_fraction >= params->textured_fraction && s->unmatched_fraction >= params->unmatched_fraction;
  s->window = s->window << 1 | (uint32_t)now;
  s->occupied = vista_window_count(s->window, params->confirm_window) >= params->confirm_hits;
  return VISTA_OK;
}
