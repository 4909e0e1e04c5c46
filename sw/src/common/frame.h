/* Changes of frame and the stereo measurement, shared by reconstruction, tracker and obstacle map. */
#ifndef VISTA_FRAME_H
#define VISTA_FRAME_H

#include "vista/status.h"
#include "vista/types.h"

#define VISTA_DEPTH_MIN_M 0.05 /* what is nearer along the optical axis counts as behind the camera */

extern const vista_pose vista_frame_still; /* world = camera */

/* VISTA_ERROR_NUMBER: not finite; VISTA_ERROR_RANGE: a size, focal length or baseline that is not positive or not
 * within a factor of 1e6 of 1, a principal point more than one image size outside the image. */
vista_status vista_frame_check_camera(const vista_camera *camera);

/* VISTA_ERROR_NUMBER: not finite; VISTA_ERROR_RANGE: R R^T differs from I by more than 1e-3, or det R < 0. */
vista_status vista_frame_check_pose(const vista_pose *pose);

/* Images of this size. VISTA_ERROR_ARGUMENT: no pixels; VISTA_ERROR_SIZE: another size, or rows closer
 * than the width. */
vista_status vista_frame_check_image(const vista_image *image, int32_t width_px, int32_t height_px);
vista_status vista_frame_check_disparity(const vista_disparity_image *disparity, int32_t width_px, int32_t height_px);

void vista_frame_to_camera(const vista_pose *pose, const double world_m[3], double camera_m[3]);
/* A direction: rotated only. */
void vista_frame_direction_to_camera(const vista_pose *pose, const double world[3], double camera[3]);
void vista_frame_direction_to_world(const vista_pose *pose, const double camera[3], double world[3]);
void vista_frame_to_world(const vista_pose *pose, const double camera_m[3], double world_m[3]);

/* Horizontal axes of a camera that does not look straight up or down, in the camera: ahead along the optical axis, and
 * to the right. Up: unit length, in the camera. */
void vista_frame_level_axes(const double up_camera[3], double ahead[3], double right[3]);

/* R C R^T, 3x3 row-major, exactly symmetric. */
void vista_frame_covariance_to_world(const vista_pose *pose, const double covariance_camera[9],
                                     double covariance_world[9]);

/* (u, v, d) of a point with z > 0 and, unless null, its 3x3 Jacobian by (X, Y, Z). */
void vista_frame_measure(const vista_camera *camera, const double camera_m[3], double measurement_px[3],
                         double jacobian[9]);

/* The point in the camera that a measurement with d > 0 is of. */
void vista_frame_point(const vista_camera *camera, const double measurement_px[3], double camera_m[3]);

/* The Jacobian of a measurement by the world position: J R^T. */
void vista_frame_jacobian_to_world(const vista_pose *pose, const double jacobian_camera[9], double jacobian_world[9]);

/* J C J^T for 3x3 J and symmetric C, exactly symmetric. */
void vista_frame_propagate(const double jacobian[9], const double covariance[9], double propagated[9]);

#endif
