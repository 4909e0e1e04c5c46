#include "perceive/region/reconstruction.h"

#include <math.h>

#include "common/ellipse.h"
#include "common/frame.h"
#include "perceive/scales.h"

/* Uncertainty of a region's centre along each axis: in pixels, and over half its width or height, for the segmentation
 * moves that of a large one more. */
#define CENTER_SIGMA_PX 1.0
#define CENTER_SIGMA_RATIO 0.1

/* Standard deviation of the centre along one axis. A region cut by the border hides an unknown part of
 * itself: its centre may lie anywhere up to about its own half size further out. */
static double center_sigma(double half_size_px, bool cut) {
  const double sigma = hypot(CENTER_SIGMA_PX, CENTER_SIGMA_RATIO * half_size_px);
  return cut ? hypot(sigma, half_size_px) : sigma;
}

/* The mean of the boundary inliers, of which only every correlated_pixels-th is independent. */
static double disparity_sigma(const vista_reconstruction_params *params, const vista_region *region) {
  const double independent = fmax(1.0, region->boundary_inliers / VISTA_HALF_BLOCK_PX2);
  return hypot(params->disparity_sigma_px, region->disparity_sigma_px / sqrt(independent));
}

/* P = J diag(sigma^2) J^T, J = d(X, Y, Z) / d(u, v, d) */
void vista_triangulate(const vista_camera *camera, vista_detection *detection) {
  const double d = detection->disparity_px;
  const double per_px = camera->baseline_m / d;
  const double x = (detection->u_px - camera->center_u_px) * per_px;
  const double y = (detection->v_px - camera->center_v_px) * per_px;
  const double z = camera->focal_px * per_px;
  const double jacobian[9] = {per_px, 0.0, -x / d, 0.0, per_px, -y / d, 0.0, 0.0, -z / d};
  const double variance[9] = {[0] = detection->sigma_u_px * detection->sigma_u_px,
                              [4] = detection->sigma_v_px * detection->sigma_v_px,
                              [8] = detection->sigma_disparity_px * detection->sigma_disparity_px};
  detection->position_camera_m[0] = x;
  detection->position_camera_m[1] = y;
  detection->position_camera_m[2] = z;
  vista_frame_propagate(jacobian, variance, detection->covariance_camera_m2);
}

vista_status vista_reconstruct_region(const vista_frame_view *frame, const vista_region *region,
                                      vista_detection *detection) {
  const vista_camera *const camera = frame->camera;
  const vista_reconstruction_params *const params = &frame->params->reconstruction;
  if (!isfinite(region->disparity_px) || !isfinite(region->disparity_sigma_px)) return VISTA_ERROR_NUMBER;
  if (region->disparity_px < VISTA_FARTHEST_PX || region->disparity_sigma_px < 0.0) return VISTA_ERROR_RANGE;
  const vista_margins margins = vista_matched_margins(&frame->matched, region->disparity_px);
  vista_detection result = {
      .label = region->label,
      .plain = region->plain,
      .lasting_sigma_px = region->foot_sigma_px,
      .volume_pixels = region->volume_pixels,
      .foot_seen = region->foot_seen,
      .foot_share = region->foot_share,
      .met = region->met,
      .met_camera_m = {region->met_camera_m[0], region->met_camera_m[1], region->met_camera_m[2]},
      .met_sigma_m = region->met_sigma_m,
      .u_px = region->mean_u_px,
      .v_px = region->mean_v_px,
      .disparity_px = region->disparity_px,
      .sigma_disparity_px = disparity_sigma(params, region),
      .cut_u = region->min_u_px <= margins.left_px || region->max_u_px >= camera->width_px - 1 - margins.other_px,
      .cut_v = region->min_v_px <= margins.other_px || region->max_v_px >= camera->height_px - 1 - margins.other_px};
  const vista_status status = vista_ellipse_from_region(region, &result.ellipse);
  if (status != VISTA_OK) return status;
  double half_width_px, half_height_px;
  vista_ellipse_half_box(&result.ellipse, &half_width_px, &half_height_px);
  result.sigma_u_px = center_sigma(half_width_px, result.cut_u);
  result.sigma_v_px = center_sigma(half_height_px, result.cut_v);
  vista_triangulate(camera, &result);
  result.extent_m[0] = 2.0 * half_width_px * camera->baseline_m / region->disparity_px;
  result.extent_m[1] = 2.0 * half_height_px * camera->baseline_m / region->disparity_px;
  *detection = result;
  return VISTA_OK;
}

/* Room for a region: behind the others, else in the place of the farthest, if that is farther; null: none. */
static vista_detection *room_for(const vista_region *region, vista_detections *detections) {
  if (detections->count < detections->capacity) return &detections->items[detections->count++];
  vista_detection *farthest = NULL;
  for (int32_t i = 0; i < detections->count; ++i)
    if (farthest == NULL || detections->items[i].disparity_px < farthest->disparity_px)
      farthest = &detections->items[i];
  return farthest != NULL && farthest->disparity_px < region->disparity_px ? farthest : NULL;
}

vista_status vista_reconstruct_regions(const vista_frame_view *frame, const vista_region *regions, int32_t region_count,
                                       vista_detections *detections) {
  int32_t accepted = 0;
  detections->count = 0;
  for (int32_t i = 0; i < region_count; ++i) {
    if (regions[i].verdict != VISTA_REGION_ACCEPTED || regions[i].disparity_px < VISTA_FARTHEST_PX) continue;
    vista_detection found;
    const vista_status status = vista_reconstruct_region(frame, &regions[i], &found);
    if (status != VISTA_OK) return status;
    vista_detection *const room = room_for(&regions[i], detections);
    if (room != NULL) *room = found;
    ++accepted;
  }
  return accepted > detections->capacity ? VISTA_ERROR_CAPACITY : VISTA_OK;
}
