/* What flows between the stages. Frames of reference, in the name of everything that carries a coordinate:
 *   px     left rectified image: u right, v down, origin at the centre of the top-left pixel
 *   camera left rectified camera: x right, y down, z forward, metres
 *   world  the inertial frame of the pose source, metres */
#ifndef VISTA_TYPES_H
#define VISTA_TYPES_H

#include <stddef.h>
#include <stdint.h>

/* Disparities travel as the engine's words: signed 16 bit, 1/16 px, negative = invalid (contract, step 7). */
#define VISTA_DISPARITY_SCALE 16
#define VISTA_DISPARITY_INVALID (-16)

typedef struct vista_image {
  const uint8_t *data; /* 8-bit grey, row-major */
  int32_t width_px, height_px;
  ptrdiff_t stride; /* items from one row to the next */
} vista_image;

typedef struct vista_disparity_image {
  const int16_t *data;
  int32_t width_px, height_px;
  ptrdiff_t stride;
} vista_disparity_image;

/* Rectified pinhole pair; the right camera sits baseline_m to the right of the left one. */
typedef struct vista_camera {
  int32_t width_px, height_px;
  double focal_px;
  double center_u_px, center_v_px; /* principal point */
  double baseline_m;
} vista_camera;

/* Where the engine can find a disparity, and how large a one (contract, step 2). */
typedef struct vista_matched_area {
  double disparity_max_px; /* num_disparities - 1: what is nearer is in the blind zone */
  double margin_left_px;   /* columns at the left without disparity: num_disparities - 1 + r */
  double margin_px;        /* rows and columns at the other sides: r = (block_size - 1) / 2 */
} vista_matched_area;

/* p_world = rotation * p_camera + translation_m; rotation row-major. */
typedef struct vista_pose {
  double rotation[9];
  double translation_m[3];
} vista_pose;

#endif
