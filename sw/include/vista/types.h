/* Images, camera and pose. The name of everything that carries a coordinate says its frame of reference:
 *
 * - px: the rectified left image; u to the right, v down, the origin in the centre of the top left pixel.
 * - camera: the rectified left camera; x to the right, y down, z forward, in metres.
 * - world: the inertial frame of the pose source, in metres. */
#ifndef VISTA_TYPES_H
#define VISTA_TYPES_H

#include <stddef.h>
#include <stdint.h>

#include "vista/word.h" /* VISTA_DISPARITY_SCALE, VISTA_DISPARITY_INVALID */

#define VISTA_RADIANS_PER_DEGREE 0.017453292519943295769
#define VISTA_DEGREES_PER_RADIAN 57.295779513082320877

/* The images that are handled, pixels a side. */
#define VISTA_LEAST_IMAGE_PX 16
#define VISTA_MOST_IMAGE_PX 8192

/* An 8-bit grey image. */
typedef struct vista_image {
  const uint8_t *data; /* row-major */
  int32_t width_px, height_px;
  ptrdiff_t stride; /* pixels from one row to the next, at least width_px */
} vista_image;

/* The disparity of every pixel of the left image, as words of the stereo engine. */
typedef struct vista_disparity_image {
  const int16_t *data; /* 1/16 px; negative where there is no disparity */
  int32_t width_px, height_px;
  ptrdiff_t stride;
} vista_disparity_image;

/* Levels of the image pyramid that may be matched beside the image itself. Level k has half the size of level k-1,
 * rounded up. Its pixel i lies at pixel 2^k i of the image, its words are in 1/16 of its own pixels. */
#define VISTA_COARSER_LEVELS 3

/* A rectified pair of pinhole cameras. The right one is baseline_m to the right of the left one. */
typedef struct vista_camera {
  int32_t width_px, height_px;
  double focal_px;
  double center_u_px, center_v_px; /* principal point; at most one image size outside the image */
  double baseline_m;
} vista_camera;

/* The pose of the camera in the world: p_world = rotation * p_camera + translation_m. The rotation is row-major. */
typedef struct vista_pose {
  double rotation[9];
  double translation_m[3];
} vista_pose;

#endif
