#include "health/ground_view.h"

#include <math.h>
#include <stddef.h>
#include <stdint.h>

#include "common/agreement.h"
#include "common/frame.h"

#define LOOK_M 30.0    /* along the path: there the columns are as wide as the collision volume */
#define SIDEWAYS_M 3.0 /* nearer along the optical axis the path leaves the view to the side */
#define STEP_PX 4
#define SAMPLES_MIN 50

double vista_ground_view(const vista_frame_view *frame, bool agreeing) {
  const vista_camera *const camera = frame->camera;
  const vista_matched_area *const matched = &frame->matched;
  const vista_disparity_image *const disparity = &frame->words;
  const double *const up = frame->up_camera, radius_m = frame->params->obstacle_map.collision_radius_m;
  if (!frame->up_known) return 1.0;
  double point_m[3], at_m[3];
  vista_flight_path_point(&frame->path, fmin(LOOK_M, frame->path.length_m), point_m, NULL);
  vista_frame_to_camera(&frame->motion.pose, point_m, at_m);
  if (!(at_m[2] > SIDEWAYS_M)) return 1.0;
  const double scale = camera->focal_px / at_m[2], middle = camera->center_u_px + scale * at_m[0];
  const int32_t distance = agreeing ? vista_agreement_distance(matched) : 0, margin = (int32_t)matched->margin_px;
  const int32_t left = (int32_t)matched->margin_left_px + distance, right = disparity->width_px - margin - distance;
  const int32_t first = (int32_t)fmin(fmax(middle - scale * radius_m, left), right);
  const int32_t end = (int32_t)fmin(fmax(middle + scale * radius_m, left), right);
  int32_t seen = 0, asked = 0;
  for (int32_t v = margin; v < disparity->height_px - margin; v += STEP_PX) {
    const int16_t *const row = disparity->data + v * disparity->stride;
    const double y = (v - camera->center_v_px) / camera->focal_px;
    for (int32_t u = first; u < end; u += STEP_PX) {
      const double x = (u - camera->center_u_px) / camera->focal_px;
      if (x * up[0] + y * up[1] + up[2] >= 0.0) continue;
      ++asked;
      seen += agreeing ? vista_word_agrees(row, u, distance) : row[u] >= 0;
    }
  }
  return asked >= SAMPLES_MIN ? (double)seen / asked : 1.0;
}
