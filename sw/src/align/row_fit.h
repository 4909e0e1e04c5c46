/* The turn that the row errors of a pair agree on. Internal to libvista. */
#ifndef VISTA_SRC_ALIGNMENT_ROW_FIT_H
#define VISTA_SRC_ALIGNMENT_ROW_FIT_H

#include <stdbool.h>
#include <stdint.h>

#include "align/row_matches.h"
#include "vista/alignment.h"

/* A symmetric 2 x 2 matrix of pitch and roll. */
typedef struct vista_turn_matrix {
  double pp, pr, rr;
} vista_turn_matrix;

typedef struct vista_row_fit {
  bool agreed;               /* whether enough features agree; the rest says nothing otherwise */
  int32_t agreeing;
  vista_turn turn;           /* of the right camera against what its image was rectified for */
  vista_turn_matrix covariance; /* rad^2 */
  double row_error_px, row_error_90_px; /* median and 90th percentile of the agreeing features, without the sign */
} vista_row_fit;

/* How far below its row a feature at this pixel of the right image lies, by radian of pitch and of roll, px. */
void vista_row_fit_slopes(const vista_camera *camera, double u_px, double v_px, double *of_pitch_px,
                          double *of_roll_px);

vista_turn_matrix vista_turn_matrix_add(vista_turn_matrix a, vista_turn_matrix b);
vista_turn_matrix vista_turn_matrix_inverse(vista_turn_matrix m);
/* turn^T m turn. */
double vista_turn_matrix_square(vista_turn_matrix m, vista_turn turn);

/* Proposals through two features each (RANSAC, always the same ones), then iterated least squares with weights that
 * fall to 0 (Tukey). */
vista_row_fit vista_row_fit_make(const vista_camera *camera, const vista_row_match *matches, int32_t count);

#endif
