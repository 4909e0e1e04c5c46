#include "space/path_view.h"

#include <math.h>
#include <stddef.h>
#include <stdint.h>

#include "common/frame.h"
#include "space/collision_volume.h"
#include "space/told.h"

#define STATIONS 20          /* along the path */
#define SAMPLES_A_RADIUS 8  /* rows, and columns, that are looked at */

typedef struct span {
  int32_t first, last;
} span;

/* From `middle - reach` to `middle + reach`, cut to first .. last; of numbers that may be beyond any int32_t. */
static span between(double middle, double reach, double first, double last) {
  const double low = ceil(fmax(middle - reach, first)), high = floor(fmin(middle + reach, last));
  return low <= high ? (span){(int32_t)low, (int32_t)high} : (span){0, -1};
}

/* Share of a disc's image that tells of it; 0 where nothing of it is matched. */
static double told_fraction(const vista_told *v, const vista_camera *camera, const vista_matched_area *matched,
                            const double center_m[3], double radius_m) {
  if (!(center_m[2] > 0.0)) return 0.0;
  const double scale = camera->focal_px / center_m[2], radius_px = scale * radius_m;
  const double u = camera->center_u_px + scale * center_m[0], w = camera->center_v_px + scale * center_m[1];
  const vista_margins margins = vista_matched_margins(matched, scale * camera->baseline_m);
  const double step = fmax(1.0, floor(radius_px / SAMPLES_A_RADIUS));
  const span rows = between(w, radius_px, margins.other_px, camera->height_px - 1 - margins.other_px);
  int32_t told = 0, all = 0;
  for (int32_t row = rows.first; row <= rows.last; row += (int32_t)step) {
    const double half_px = sqrt(fmax(0.0, radius_px * radius_px - (row - w) * (row - w)));
    const span columns = between(u, half_px, margins.left_px, camera->width_px - 1 - margins.other_px);
    for (int32_t column = columns.first; column <= columns.last; column += (int32_t)step) {
      told += vista_told_region(v, column, row) != NULL;
      ++all;
    }
  }
  return all > 0 ? (double)told / all : 0.0;
}

double vista_path_view(const vista_frame_view *frame, const vista_told *told) {
  const vista_obstacle_map_params *const params = &frame->params->obstacle_map;
  const vista_camera *const camera = frame->camera;
  const vista_matched_area *const matched = &frame->matched;
  const vista_flight_path *const path = &frame->path;
  const double nearest_m = camera->focal_px * camera->baseline_m / matched->disparity_max_px;
  double seen_m = 0.0;
  for (int k = 1; k <= STATIONS; ++k) {
    const double along_m = path->length_m * k / STATIONS;
    double point_m[3], center_m[3];
    vista_flight_path_point(path, along_m, point_m, NULL);
    vista_frame_to_camera(&frame->motion.pose, point_m, center_m);
    /* Nearer than anything is matched the view through the disc is as good as at the nearest range. */
    if (along_m < nearest_m && k < STATIONS) continue;
    if (told_fraction(told, camera, matched, center_m, params->collision_radius_m) < VISTA_SEEN_MIN_FRACTION) break;
    seen_m = along_m;
  }
  return seen_m;
}
