#include "stages/collision_volume.h"

#include <math.h>
#include <stddef.h>

#include "common/frame.h"
#include "common/parameters_check.h"
#include "stages/parts/region_boundary.h"

#define SMALLEST_M 1e-3 /* of the volume: what is asked in words fits a float */

/* What the pixels of one run are asked, in engine words w = 16 d; squared, so that nothing is divided. */
typedef struct limits {
  float across2; /* (16 B / radius)^2: inside when w^2 >= across2 |q x a|^2 */
  float along;   /* 16 B / length: inside when w >= along q . a */
  float a[3];
  float focal_px;
} limits;

static inline int32_t inside(const limits *limit, float u, float v, float word) {
  const float along = u * limit->a[0] + v * limit->a[1] + limit->focal_px * limit->a[2];
  const float across2 = u * u + v * v + limit->focal_px * limit->focal_px - along * along;
  return (along > 0.0f) & (word >= limit->along * along) & (word * word >= limit->across2 * across2);
}

/* The pixels of a plain region lie on its surface, whatever chance matched there. */
static int32_t count_plain_run(const limits *limit, float x, float y, int32_t length, float word) {
  int32_t count = 0;
  for (int32_t i = 0; i < length; ++i) count += inside(limit, x + (float)i, y, word);
  return count;
}

static int32_t count_run(const limits *limit, const int16_t *words, float x, float y, int32_t length,
                         float surface_word, float slope_words, float tolerance_words) {
  int32_t count = 0;
  for (int32_t i = 0; i < length; ++i) {
    const float w = (float)words[i];
    const int32_t own = (w > 0.0f) & (fabsf(w - surface_word - slope_words * (float)i) <= tolerance_words);
    count += own & inside(limit, x + (float)i, y, w);
  }
  return count;
}

static int32_t count_region(const vista_foveation *foveation, const vista_camera *camera, const limits *limit,
                            const vista_disparity_image *disparity, double tolerance_px, const int32_t *members,
                            int32_t member_count, const vista_region *region) {
  int32_t count = 0;
  for (int32_t m = 0; m < member_count; ++m)
    for (int32_t r = foveation->first_run[members[m]]; r < foveation->first_run[members[m] + 1]; ++r) {
      const vista_run run = foveation->runs[r];
      const float x = (float)(run.u_px - camera->center_u_px), y = (float)(run.v_px - camera->center_v_px);
      if (region->plain) {
        count += count_plain_run(limit, x, y, run.length_px, (float)(region->disparity_px * VISTA_DISPARITY_SCALE));
        continue;
      }
      const double surface_px = region->disparity_px + region->slope_u * (run.u_px - region->mean_u_px) +
                                region->slope_v * (run.v_px - region->mean_v_px);
      count += count_run(limit, disparity->data + run.v_px * disparity->stride + run.u_px, x, y, run.length_px,
                         (float)(surface_px * VISTA_DISPARITY_SCALE), (float)(region->slope_u * VISTA_DISPARITY_SCALE),
                         (float)(tolerance_px * VISTA_DISPARITY_SCALE));
    }
  return count;
}

vista_status vista_collision_volume_count(const vista_foveation *foveation, const vista_region_params *params,
                                          const vista_camera *camera, const vista_collision_volume *volume,
                                          const vista_disparity_image *disparity, vista_regions *regions) {
  if (foveation == NULL || params == NULL || camera == NULL || volume == NULL || disparity == NULL || regions == NULL)
    return VISTA_ERROR_ARGUMENT;
  vista_status status = VISTA_CHECK_SECTION(region, params);
  if (status == VISTA_OK) status = vista_frame_check_camera(camera);
  if (status == VISTA_OK) status = vista_frame_check_disparity(disparity, foveation->width_px, foveation->height_px);
  if (status == VISTA_OK && !(volume->radius_m >= SMALLEST_M && volume->length_m >= SMALLEST_M &&
                              isfinite(volume->radius_m + volume->length_m)))
    status = VISTA_ERROR_RANGE;
  if (status != VISTA_OK) return status;
  const double words = VISTA_DISPARITY_SCALE * camera->baseline_m;
  const double *const a = volume->direction_camera;
  const limits limit = {.across2 = (float)((words / volume->radius_m) * (words / volume->radius_m)),
                        .along = (float)(words / volume->length_m),
                        .a = {(float)a[0], (float)a[1], (float)a[2]},
                        .focal_px = (float)camera->focal_px};
  for (int32_t k = 0; k < regions->count; ++k) {
    vista_region *const region = &regions->items[k];
    if (region->verdict != VISTA_REGION_ACCEPTED) continue;
    const int32_t first = regions->first_member[k];
    const double tolerance_px = vista_region_tolerance_px(params, camera, region->disparity_px);
    region->volume_pixels = count_region(foveation, camera, &limit, disparity, tolerance_px, regions->members + first,
                                         regions->first_member[k + 1] - first, region);
  }
  return VISTA_OK;
}
