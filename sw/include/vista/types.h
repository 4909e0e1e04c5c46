/* What flows between the stages. Frames of reference, in the name of everything that carries a coordinate:
 *   px     left rectified image: u right, v down, origin at the centre of the top-left pixel
 *   camera left rectified camera: x right, y down, z forward, metres
 *   world  the inertial frame of the pose source, metres */
#ifndef VISTA_TYPES_H
#define VISTA_TYPES_H

#include <stddef.h>
#include <stdint.h>

#include "vista/word.h" /* VISTA_DISPARITY_SCALE, VISTA_DISPARITY_INVALID */

typedef struct vista_image {
  const uint8_t *data; /* 8-bit grey, row-major */
  int32_t width_px, height_px;
  ptrdiff_t stride; /* items from one row to the next */
} vista_image;

typedef struct vista_disparity_image {
  const int16_t *data; /* words: 1/16 px, negative without a disparity */
  int32_t width_px, height_px;
  ptrdiff_t stride;
} vista_disparity_image;

/* Rectified pinhole pair; the right camera sits baseline_m to the right of the left one. */
typedef struct vista_camera {
  int32_t width_px, height_px;
  double focal_px;
  double center_u_px, center_v_px; /* principal point; at most one image size outside the image */
  double baseline_m;
} vista_camera;

/* p_world = rotation * p_camera + translation_m; rotation row-major. */
typedef struct vista_pose {
  double rotation[9];
  double translation_m[3];
} vista_pose;

#endif
