#include "common/frame.h"

#include <math.h>
#include <stdbool.h>
#include <stddef.h>

#include "common/numbers.h"

#define MAX_SIDE_PX 1e6
#define LARGEST 1e6 /* focal length in pixels, baseline in metres: products of these fit a float */

const vista_pose vista_frame_still = {.rotation = {1, 0, 0, 0, 1, 0, 0, 0, 1}};

static bool within(double value, double low, double high) { return value >= low && value <= high; }

vista_status vista_frame_check_camera(const vista_camera *camera) {
  if (!isfinite(camera->focal_px) || !isfinite(camera->center_u_px) || !isfinite(camera->center_v_px) ||
      !isfinite(camera->baseline_m))
    return VISTA_ERROR_NUMBER;
  const double width_px = camera->width_px, height_px = camera->height_px;
  const bool good = within(width_px, 1.0, MAX_SIDE_PX) && within(height_px, 1.0, MAX_SIDE_PX) &&
                    within(camera->focal_px, 1.0 / LARGEST, LARGEST) &&
                    within(camera->baseline_m, 1.0 / LARGEST, LARGEST) &&
                    within(camera->center_u_px, -width_px, 2.0 * width_px) &&
                    within(camera->center_v_px, -height_px, 2.0 * height_px);
  return good ? VISTA_OK : VISTA_ERROR_RANGE;
}

vista_status vista_frame_check_pose(const vista_pose *pose) {
  const double *r = pose->rotation;
  for (int i = 0; i < 9; ++i)
    if (!isfinite(r[i])) return VISTA_ERROR_NUMBER;
  for (int i = 0; i < 3; ++i)
    if (!isfinite(pose->translation_m[i])) return VISTA_ERROR_NUMBER;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j <= i; ++j) {
      const double dot = r[3 * i] * r[3 * j] + r[3 * i + 1] * r[3 * j + 1] + r[3 * i + 2] * r[3 * j + 2];
      if (fabs(dot - (i == j)) > 1e-3) return VISTA_ERROR_RANGE; /* pose files carry about six digits */
    }
  const double determinant =
      r[0] * (r[4] * r[8] - r[5] * r[7]) - r[1] * (r[3] * r[8] - r[5] * r[6]) + r[2] * (r[3] * r[7] - r[4] * r[6]);
  return determinant > 0.0 ? VISTA_OK : VISTA_ERROR_RANGE;
}

/* Rows may also run upwards. */
static vista_status check_rows(const void *data, int32_t width_px, int32_t height_px, ptrdiff_t stride,
                               int32_t expected_width_px, int32_t expected_height_px) {
  if (data == NULL) return VISTA_ERROR_ARGUMENT;
  const bool good = width_px == expected_width_px && height_px == expected_height_px &&
                    (stride >= width_px || stride <= -(ptrdiff_t)width_px);
  return good ? VISTA_OK : VISTA_ERROR_SIZE;
}

vista_status vista_frame_check_image(const vista_image *image, int32_t width_px, int32_t height_px) {
  return check_rows(image->data, image->width_px, image->height_px, image->stride, width_px, height_px);
}

vista_status vista_frame_check_disparity(const vista_disparity_image *disparity, int32_t width_px, int32_t height_px) {
  return check_rows(disparity->data, disparity->width_px, disparity->height_px, disparity->stride, width_px, height_px);
}

void vista_frame_direction_to_camera(const vista_pose *pose, const double world[3], double camera[3]) {
  for (int i = 0; i < 3; ++i)
    camera[i] = pose->rotation[i] * world[0] + pose->rotation[3 + i] * world[1] + pose->rotation[6 + i] * world[2];
}

void vista_frame_direction_to_world(const vista_pose *pose, const double camera[3], double world[3]) {
  for (int i = 0; i < 3; ++i) world[i] = vista_dot(pose->rotation + 3 * i, camera);
}

void vista_frame_level_axes(const double up_camera[3], double ahead[3], double right[3]) {
  const double steep = up_camera[2], level = sqrt(1.0 - steep * steep);
  for (int i = 0; i < 3; ++i) ahead[i] = ((i == 2) - steep * up_camera[i]) / level;
  vista_cross(ahead, up_camera, right);
}

void vista_frame_to_camera(const vista_pose *pose, const double world_m[3], double camera_m[3]) {
  const double offset_m[3] = {world_m[0] - pose->translation_m[0], world_m[1] - pose->translation_m[1],
                              world_m[2] - pose->translation_m[2]};
  vista_frame_direction_to_camera(pose, offset_m, camera_m);
}

void vista_frame_to_world(const vista_pose *pose, const double camera_m[3], double world_m[3]) {
  const double *r = pose->rotation;
  const double x = camera_m[0];
  const double y = camera_m[1];
  const double z = camera_m[2];
  for (int i = 0; i < 3; ++i) world_m[i] = r[3 * i] * x + r[3 * i + 1] * y + r[3 * i + 2] * z + pose->translation_m[i];
}

void vista_frame_propagate(const double jacobian[9], const double covariance[9], double propagated[9]) {
  double half[9];
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      double sum = 0.0;
      for (int k = 0; k < 3; ++k) sum += jacobian[3 * i + k] * covariance[3 * k + j];
      half[3 * i + j] = sum;
    }
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j <= i; ++j) {
      double sum = 0.0;
      for (int k = 0; k < 3; ++k) sum += half[3 * i + k] * jacobian[3 * j + k];
      propagated[3 * i + j] = sum;
      propagated[3 * j + i] = sum;
    }
}

void vista_frame_covariance_to_world(const vista_pose *pose, const double covariance_camera[9],
                                     double covariance_world[9]) {
  vista_frame_propagate(pose->rotation, covariance_camera, covariance_world);
}

void vista_frame_measure(const vista_camera *camera, const double camera_m[3], double measurement_px[3],
                         double jacobian[9]) {
  const double scale = camera->focal_px / camera_m[2];
  measurement_px[0] = camera->center_u_px + scale * camera_m[0];
  measurement_px[1] = camera->center_v_px + scale * camera_m[1];
  measurement_px[2] = scale * camera->baseline_m;
  if (jacobian == NULL) return;
  const double per_depth = scale / camera_m[2];
  const double rows[9] = {scale, 0.0, -per_depth * camera_m[0],       0.0, scale, -per_depth * camera_m[1],
                          0.0,   0.0, -per_depth * camera->baseline_m};
  for (int i = 0; i < 9; ++i) jacobian[i] = rows[i];
}

void vista_frame_point(const vista_camera *camera, const double measurement_px[3], double camera_m[3]) {
  const double depth_m = camera->focal_px * camera->baseline_m / measurement_px[2];
  camera_m[0] = (measurement_px[0] - camera->center_u_px) * depth_m / camera->focal_px;
  camera_m[1] = (measurement_px[1] - camera->center_v_px) * depth_m / camera->focal_px;
  camera_m[2] = depth_m;
}

void vista_frame_jacobian_to_world(const vista_pose *pose, const double jacobian_camera[9], double jacobian_world[9]) {
  const double *r = pose->rotation;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      double sum = 0.0;
      for (int k = 0; k < 3; ++k) sum += jacobian_camera[3 * i + k] * r[3 * j + k];
      jacobian_world[3 * i + j] = sum;
    }
}
