/* Corrects the calibration in flight: from what the rows of a pair say to how the right images of the next are rectified.
 *
 *   vista_right_rectification right = {.raw = ...};
 *   vista_correction_bytes(&parameters, &camera, &right, &bytes);
 *   vista_correction_create(malloc(bytes), bytes, &parameters, &camera, &right, &correction);
 *   for each pair, its right image rectified by vista_correction_table(correction), or as calibrated:
 *     vista_correction_update(correction, &left, &right, t_ns, &result);
 *     vista_alignment_judge(&result, &health);
 *   free the memory.
 *
 * What one pair costs is bounded: a map is made in VISTA_CORRECTION_PARTS pairs, the same number of rows in each, and
 * takes effect when it is whole. A control grid, which has a 256th of the numbers, is made at once. */
#ifndef VISTA_CORRECTION_H
#define VISTA_CORRECTION_H

#include <stddef.h>
#include <stdint.h>

#include "vista/alignment.h"
#include "vista/api.h"
#include "vista/parameters.h"
#include "vista/status.h"
#include "vista/types.h"

VISTA_BEGIN

#define VISTA_CORRECTION_PARTS 4
#define VISTA_DISTORTION_MOST 8

/* The model of a lens, by what its coefficients mean. */
typedef enum vista_lens {
  VISTA_LENS_PINHOLE = 0, /* OpenCV's k1, k2, p1, p2, k3, k4, k5, k6 */
  VISTA_LENS_FISHEYE, /* k1 to k4 of cv2.fisheye: theta (1 + k1 theta^2 + ... + k4 theta^8) */
  VISTA_LENS_COUNT
} vista_lens;

/* A camera as calibrated, before rectification. */
typedef struct vista_raw_camera {
  vista_lens lens;
  double focal_u_px, focal_v_px, center_u_px, center_v_px;
  double distortion[VISTA_DISTORTION_MOST];
  double rectified_from_raw[9]; /* row-major rotation */
} vista_raw_camera;

/* How right images are rectified as calibrated. */
typedef struct vista_right_rectification {
  vista_raw_camera raw;
  const int16_t *grid; /* of a control grid, as vista_turn_grid has it, and still there in flight; null: by a map */
  int32_t columns, rows; /* of the grid */
} vista_right_rectification;

/* How they are rectified now: by a map, by a control grid, or, where all are null, as calibrated. */
typedef struct vista_right_table {
  const int16_t *whole; /* height * width pairs (u, v) of whole pixels of the raw image, and of these ... */
  const uint16_t *fraction; /* ... 32 * v + u in 1/32 px beyond them */
  const int16_t *grid;
} vista_right_table;

typedef struct vista_correction vista_correction;

/* Rows first_row to end_row - 1 of the map that rectifies the images of a raw camera which has turned. camera: the
 * rectified one. whole, fraction: as vista_right_table, of the whole image. Places that 16 bits do not hold are moved to
 * where they do. VISTA_ERROR_NUMBER: the turn or a camera. VISTA_ERROR_RANGE: the rows. */
VISTA_API vista_status vista_turn_map(const vista_turn *turn, const vista_camera *camera, const vista_raw_camera *raw,
                                      int32_t first_row, int32_t end_row, int16_t *whole, uint16_t *fraction);

/* The number of bytes that vista_correction_create needs. Errors as vista_alignment_bytes, and VISTA_ERROR_NUMBER: the
 * raw camera; VISTA_ERROR_SIZE: a grid of fewer than 2 points along a side. */
VISTA_API vista_status vista_correction_bytes(const vista_parameters *parameters, const vista_camera *camera,
                                              const vista_right_rectification *right, size_t *bytes);

/* Makes a correction in the memory given, which may have any alignment. Errors as vista_correction_bytes;
 * VISTA_ERROR_MEMORY: too few bytes. */
VISTA_API vista_status vista_correction_create(void *memory, size_t bytes, const vista_parameters *parameters,
                                               const vista_camera *camera, const vista_right_rectification *right,
                                               vista_correction **correction);

/* What comes next does not continue what came before: the calibration holds again. */
VISTA_API void vista_correction_reset(vista_correction *correction);

/* Takes one pair, rectified as vista_correction_table said before. result->correction and result->changed tell of what
 * the table is now. A turn that no control grid holds is VISTA_ALIGNMENT_BEYOND. Errors as vista_alignment_update. */
VISTA_API vista_status vista_correction_update(vista_correction *correction, const vista_image *left,
                                               const vista_image *right, int64_t t_ns, vista_alignment_result *result);

/* Takes back the table that an update has changed, because what rectifies cannot follow it, such as a line buffer that
 * has too few rows. The table is that of before, and the state VISTA_ALIGNMENT_BEYOND. */
VISTA_API void vista_correction_refuse(vista_correction *correction, vista_alignment_result *result);

/* How the right image of the next pair is to be rectified; valid until the update after the next. */
VISTA_API vista_right_table vista_correction_table(const vista_correction *correction);

VISTA_END

#endif
