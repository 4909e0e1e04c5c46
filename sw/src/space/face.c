#include "space/face.h"

#include <math.h>

#include "common/frame.h"
#include "common/numbers.h"

#define LEVEL_MIN 1e-3 /* sine of optical axis and vertical, below which the rows of the image count as level */

/* Half the extent of an ellipse along a unit direction of the image. */
static double half_px(const vista_ellipse *ellipse, double right, double down) {
  const double angle = ellipse->angle_deg * VISTA_RADIANS_PER_DEGREE;
  const double along_a = right * cos(angle) + down * sin(angle), along_b = down * cos(angle) - right * sin(angle);
  return hypot(ellipse->axis_a_px * along_a, ellipse->axis_b_px * along_b);
}

vista_face vista_face_of(const vista_frame_view *frame, const vista_obstacle *obstacle) {
  const vista_pose *const pose = &frame->motion.pose;
  const vista_camera *const camera = frame->camera;
  const vista_ellipse *const ellipse = &obstacle->ellipse;
  double middle_m[3], ahead[3], level[3] = {1.0, 0.0, 0.0}, aside[3], sight[3], up[3];
  if (hypot(frame->up_camera[0], frame->up_camera[1]) >= LEVEL_MIN)
    vista_frame_level_axes(frame->up_camera, ahead, level);
  const double upright[3] = {level[1], -level[0], 0.0}; /* across that in the image */
  vista_frame_to_camera(pose, obstacle->position_m, middle_m);
  const double pixel_m = fmax(middle_m[2], VISTA_DEPTH_MIN_M) / camera->focal_px;
  const double seen_px[3] = {ellipse->center_u_px, ellipse->center_v_px, camera->baseline_m / pixel_m};
  vista_frame_point(camera, seen_px, middle_m);
  vista_face face = {.range_m = vista_norm(middle_m)};
  for (int i = 0; i < 3; ++i) sight[i] = middle_m[i] / face.range_m;
  vista_cross(sight, upright, aside);
  const double length = vista_norm(aside); /* the sight has a part along the optical axis: this is not zero */
  for (int i = 0; i < 3; ++i) aside[i] /= length;
  vista_cross(aside, sight, up);
  face.half_m[0] = pixel_m * half_px(ellipse, level[0], level[1]) * vista_dot(level, aside);
  face.half_m[1] = pixel_m * half_px(ellipse, upright[0], upright[1]) * vista_dot(upright, up);
  vista_frame_to_world(pose, middle_m, face.middle_m);
  vista_frame_direction_to_world(pose, sight, face.sight);
  vista_frame_direction_to_world(pose, aside, face.aside);
  vista_frame_direction_to_world(pose, up, face.up);
  return face;
}
