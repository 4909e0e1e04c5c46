/* How far the right camera has turned against its calibration, from the rows of features that both images show.
 *
 *   vista_alignment_bytes(&parameters, &camera, &bytes);
 *   vista_alignment_create(malloc(bytes), bytes, &parameters, &camera, &alignment);
 *   vista_turn turn = {0};
 *   for each pair, its right image rectified for that turn:
 *     vista_alignment_update(alignment, &left, &right, t_ns, &turn, &result);
 *     turn = result.correction;
 *     vista_alignment_judge(&result, &health);   that of the frame, from the pipeline
 *   free the memory.
 *
 * A feature at the normalized place (x, y) of the right image, down and to the right from the principal point, whose
 * camera has pitched and rolled by small angles, lies pitch (1 + y^2) - roll x focal lengths below its row. Pitch and
 * roll are what is estimated. A vertical shift of the image looks like pitch. Yaw moves rows by x y alone, which says
 * little of it, and is not corrected.
 *
 * In each pair up to 128 features are looked for in all rows up to the largest turn away, without knowing their
 * disparities. Features that fit in two places count for nothing. A robust fit has to be agreed on by most of the others;
 * a Kalman filter averages the fits over time. A sudden turn is believed when 5 pairs in a row agree on it. Where there is
 * too little to see, nothing changes. */
#ifndef VISTA_ALIGNMENT_H
#define VISTA_ALIGNMENT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "vista/api.h"
#include "vista/obstacle.h"
#include "vista/parameters.h"
#include "vista/status.h"
#include "vista/types.h"

VISTA_BEGIN

/* A turn of the right camera against its calibration, small and right-handed about the axes of the rectified camera:
 * positive pitch looks up, positive roll lowers the right side. */
typedef struct vista_turn {
  double pitch_rad, roll_rad;
} vista_turn;

/* What is known of the turn after a pair. */
typedef enum vista_alignment_state {
  VISTA_ALIGNMENT_HELD = 0, /* this pair shows too little, or not yet enough: what was known holds */
  VISTA_ALIGNMENT_MEASURED, /* this pair agrees with what is known, and adds to it */
  VISTA_ALIGNMENT_BEYOND,   /* the camera has turned by more than is corrected */
  VISTA_ALIGNMENT_LOST,     /* there is texture, but for a second its rows have agreed on no turn */
  VISTA_ALIGNMENT_STATE_COUNT
} vista_alignment_state;

/* The outcome of one pair. */
typedef struct vista_alignment_result {
  vista_alignment_state state;
  vista_turn correction; /* what the right image of the next pair is to be rectified for */
  bool changed;          /* whether that is another turn than that of this pair */
  vista_turn estimate;   /* newest, mostly within 0.15 px of the correction */
  bool rows_known;       /* whether enough features agreed for the two figures that follow */
  double row_error_px;   /* median distance of features from their rows in this pair, without regard to the sign */
  double row_error_90_px; /* 90th percentile of the same */
  int32_t features;      /* places of the left image with enough texture that were looked for */
  int32_t matched;       /* those found in one place of the right image */
  int32_t agreeing;      /* those that agree on one turn; 0: there is none */
  bool unexplained;      /* there is texture in this pair and the one before, but their rows agree on no turn */
} vista_alignment_result;

/* An estimator for one pair of cameras. */
typedef struct vista_alignment vista_alignment;

/* The number of bytes that vista_alignment_create needs. VISTA_ERROR_RANGE: a parameter. VISTA_ERROR_SIZE: images of
 * less than 64 x 64 pixels. VISTA_ERROR_NUMBER: the camera. */
VISTA_API vista_status vista_alignment_bytes(const vista_parameters *parameters, const vista_camera *camera,
                                             size_t *bytes);

/* Makes an estimator in the memory given, which may have any alignment. Errors as vista_alignment_bytes;
 * VISTA_ERROR_MEMORY: too few bytes. */
VISTA_API vista_status vista_alignment_create(void *memory, size_t bytes, const vista_parameters *parameters,
                                              const vista_camera *camera, vista_alignment **alignment);

/* Forgets everything but the calibration: the next correction is none. */
VISTA_API void vista_alignment_reset(vista_alignment *alignment);

/* Takes one rectified pair. applied: the turn that its right image was rectified for.
 *
 * VISTA_ERROR_SIZE: images of another size than the camera's. VISTA_ERROR_ORDER: a time that is not later than the last.
 * VISTA_ERROR_NUMBER: a turn that is not finite. Nothing has changed then. */
VISTA_API vista_status vista_alignment_update(vista_alignment *alignment, const vista_image *left,
                                              const vista_image *right, int64_t t_ns, const vista_turn *applied,
                                              vista_alignment_result *result);

/* Adds what a pair says to the health of its frame: in the states BEYOND and LOST the reason
 * VISTA_HEALTH_ALIGNMENT_LOST, otherwise VISTA_HEALTH_ROWS_MISALIGNED where rows are known to be off by more than 1 px.
 * The frame is degraded where rows are known to be off by at most 2 px, else blind. */
VISTA_API void vista_alignment_judge(const vista_alignment_result *result, vista_health *health);

/* The row-major rotation from the rectified right camera as calibrated to the one that has turned: it is what has to be
 * taken into account before the calibrated rectification, ray_turned = rotation * ray_calibrated. */
VISTA_API void vista_turn_rotation(const vista_turn *turn, double rotation[9]);

/* The control grid of the right camera for a turn, from that of its calibration: pairs {dx, dy} in 1/32 px, a point
 * every 16 px from 0 on, row by row, as hardware that rectifies loads them. turned: as large as calibrated, and another
 * array. VISTA_ERROR_SIZE: fewer than 2 points along a side. VISTA_ERROR_RANGE: an offset that 16 bits do not hold. */
VISTA_API vista_status vista_turn_grid(const vista_turn *turn, const vista_camera *camera, const int16_t *calibrated,
                                       int32_t columns, int32_t rows, int16_t *turned);

VISTA_END

#endif
