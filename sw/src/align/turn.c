#include <math.h>

#include "common/frame.h"
#include "common/numbers.h"
#include "vista/alignment.h"

#define GRID_STEP_PX 16
#define GRID_SCALE 32.0

void vista_turn_rotation(const vista_turn *turn, double rotation[9]) {
  /* Rodrigues' formula of the inverse: the camera turns one way, what it sees the other. */
  const double axis[3] = {-turn->pitch_rad, 0.0, -turn->roll_rad}, angle = vista_norm(axis);
  const double sine = angle > 1e-9 ? sin(angle) / angle : 1.0;
  const double rest = angle > 1e-9 ? (1.0 - cos(angle)) / (angle * angle) : 0.5;
  const double cross[9] = {0.0, -axis[2], axis[1], axis[2], 0.0, -axis[0], -axis[1], axis[0], 0.0};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      double square = 0.0;
      for (int k = 0; k < 3; ++k) square += cross[3 * i + k] * cross[3 * k + j];
      rotation[3 * i + j] = (i == j ? 1.0 : 0.0) + sine * cross[3 * i + j] + rest * square;
    }
}

/* The offset between control points; beyond the outermost ones it goes on as between the last two. */
static double between(const int16_t *grid, int32_t columns, int32_t rows, double u_px, double v_px, int component) {
  const double x = u_px / GRID_STEP_PX, y = v_px / GRID_STEP_PX;
  const int32_t column = (int32_t)fmin(fmax(floor(x), 0.0), columns - 2);
  const int32_t row = (int32_t)fmin(fmax(floor(y), 0.0), rows - 2);
  const double fx = x - column, fy = y - row;
  const int16_t *const at = grid + 2 * (row * columns + column) + component, *const below = at + 2 * columns;
  return ((1.0 - fx) * at[0] + fx * at[2]) * (1.0 - fy) + ((1.0 - fx) * below[0] + fx * below[2]) * fy;
}

vista_status vista_turn_grid(const vista_turn *turn, const vista_camera *camera, const int16_t *calibrated,
                             int32_t columns, int32_t rows, int16_t *turned) {
  if (turn == NULL || camera == NULL || calibrated == NULL || turned == NULL) return VISTA_ERROR_ARGUMENT;
  if (!isfinite(turn->pitch_rad) || !isfinite(turn->roll_rad)) return VISTA_ERROR_NUMBER;
  const vista_status status = vista_frame_check_camera(camera);
  if (status != VISTA_OK) return status;
  if (columns < 2 || rows < 2) return VISTA_ERROR_SIZE;
  double rotation[9];
  vista_turn_rotation(turn, rotation);
  const double f = camera->focal_px, cu = camera->center_u_px, cv = camera->center_v_px;
  for (int32_t row = 0; row < rows; ++row)
    for (int32_t column = 0; column < columns; ++column) {
      const double u = GRID_STEP_PX * column, v = GRID_STEP_PX * row;
      const double ray[3] = {(u - cu) / f, (v - cv) / f, 1.0};
      const double z = vista_dot(rotation + 6, ray);
      if (!(z > 0.1)) return VISTA_ERROR_RANGE;
      const double seen[2] = {cu + f * vista_dot(rotation, ray) / z, cv + f * vista_dot(rotation + 3, ray) / z};
      const double own[2] = {u, v};
      for (int k = 0; k < 2; ++k) {
        const double offset =
            rint(GRID_SCALE * (seen[k] - own[k]) + between(calibrated, columns, rows, seen[0], seen[1], k));
        if (!(offset >= INT16_MIN && offset <= INT16_MAX)) return VISTA_ERROR_RANGE;
        turned[2 * (row * columns + column) + k] = (int16_t)offset;
      }
    }
  return VISTA_OK;
}
