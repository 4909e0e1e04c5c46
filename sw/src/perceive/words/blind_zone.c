#include "perceive/words/blind_zone.h"

#include <math.h>
#include <stdlib.h>

#include "common/agreement.h"
#include "common/bits.h"
#include "common/wide_vectors.h"

#define TEXTURE_LEVELS 16 /* a pixel whose two neighbours along the row differ by this has texture */
#define TEXTURED_FRACTION 0.05 /* with less of the disc textured, nothing can be said */
/* Too near when this share of the texture is not matched; in ordinary views it is 0.03 to 0.6. */
#define UNMATCHED_FRACTION 0.9
/* The same in sigmas of the image's noise; the larger of the two holds: of pure noise, one pixel in 200 exceeds 4. */
#define TEXTURE_NOISE 4.0
#define ROW_STEP 2 /* neighbouring rows say the same */

typedef struct counts {
  int64_t pixels, textured, unmatched;
} counts;

/* The columns of one row of the disc whose neighbours, a block to both sides, can have words as well. */
typedef struct span {
  int32_t v, first, last; /* none: first > last */
} span;

VISTA_WIDE_VECTORS static void count_row(const uint8_t *grey, const int16_t *words, int32_t first, int32_t last,
                                         int32_t block, int32_t contrast, counts *sum) {
  int32_t textured = 0, unmatched = 0;
  for (int32_t u = first; u <= last; ++u) {
    const int32_t has_texture = abs(grey[u + 1] - grey[u - 1]) >= contrast;
    textured += has_texture;
    unmatched += has_texture & !vista_word_agrees(words, u, block);
  }
  sum->pixels += last - first + 1;
  sum->textured += textured;
  sum->unmatched += unmatched;
}

/* The disc around the principal point, within the matched part of the image. */
typedef struct disc_view {
  const vista_camera *camera;
  double radius_px, left, right;
  int32_t v_first, v_last, block;
} disc_view;

static disc_view view_of(const vista_camera *camera, const vista_matched_area *matched, double radius_px) {
  const int32_t block = vista_agreement_distance(matched);
  const double bottom = camera->height_px - 1 - matched->margin_px;
  return (disc_view){.camera = camera,
                     .radius_px = radius_px,
                     .left = matched->margin_left_px + block,
                     .right = camera->width_px - 1 - matched->margin_px - block,
                     .v_first = (int32_t)ceil(fmax(camera->center_v_px - radius_px, matched->margin_px)),
                     .v_last = (int32_t)floor(fmin(camera->center_v_px + radius_px, bottom)),
                     .block = block};
}

static span span_at(const disc_view *disc, int32_t v) {
  const double dv = v - disc->camera->center_v_px;
  const double half = sqrt(fmax(disc->radius_px * disc->radius_px - dv * dv, 0.0));
  return (span){.v = v,
                .first = (int32_t)ceil(fmax(disc->camera->center_u_px - half, disc->left)),
                .last = (int32_t)floor(fmin(disc->camera->center_u_px + half, disc->right))};
}

static counts count_disc(const disc_view *disc, int32_t contrast, const vista_image *image,
                         const vista_disparity_image *disparity) {
  counts sum = {0};
  for (int32_t v = disc->v_first; v <= disc->v_last; v += ROW_STEP) {
    const span row = span_at(disc, v);
    if (row.first > row.last) continue;
    count_row(image->data + v * image->stride, disparity->data + v * disparity->stride, row.first, row.last,
              disc->block, contrast, &sum);
  }
  return sum;
}

void vista_blind_zone_update(const vista_frame_view *frame, vista_blind_zone *blind_zone) {
  const vista_blind_zone_params *const params = &frame->params->blind_zone;
  const vista_camera *const camera = frame->camera;
  const vista_matched_area *const matched = &frame->matched;
  vista_blind_zone *const s = blind_zone;
  const double radius_px =
      frame->params->obstacle_map.collision_radius_m * matched->disparity_max_px / camera->baseline_m;
  const disc_view disc = view_of(camera, matched, radius_px);
  const int32_t contrast = (int32_t)ceil(vista_image_noise_threshold(&frame->noise, TEXTURE_LEVELS, TEXTURE_NOISE));
  const counts sum = count_disc(&disc, contrast, &frame->image, &frame->words);
  s->range_m = camera->focal_px * camera->baseline_m / matched->disparity_max_px;
  s->textured_fraction = sum.pixels > 0 ? (double)sum.textured / (double)sum.pixels : 0.0;
  s->unmatched_fraction = sum.textured > 0 ? (double)sum.unmatched / (double)sum.textured : 0.0;
  const bool now = s->textured_fraction >= TEXTURED_FRACTION && s->unmatched_fraction >= UNMATCHED_FRACTION;
  s->window = s->window << 1 | (uint32_t)now;
  s->occupied = vista_window_count(s->window, params->confirm_window) >= params->confirm_hits;
}
