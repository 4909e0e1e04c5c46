#include <math.h>

#include "common/frame.h"
#include "common/numbers.h"
#include "common/wide_vectors.h"
#include "vista/correction.h"

#define SCALE 32           /* of fractions: units a pixel */
#define DEPTH_MIN 1e-6     /* of a ray: what lies behind the camera is seen nowhere, and not divided by 0 */
#define PLACE_LEAST (-32768.0 * SCALE)
#define PLACE_MOST (32767.0 * SCALE + SCALE - 1)

/* The rays of a row in the raw camera: at column 0, and from a column to the next. */
typedef struct row_rays {
  double start[3], step[3];
} row_rays;

/* 1/32 px; what is no number counts as far away. */
static inline int32_t fixed(double px) {
  const double scaled = SCALE * px, capped = scaled < PLACE_MOST ? scaled : PLACE_MOST;
  return (int32_t)rint(capped > PLACE_LEAST ? capped : PLACE_LEAST);
}

static inline void put(const vista_raw_camera *raw, double x, double y, int16_t whole[2], uint16_t *fraction) {
  const int32_t u = fixed(raw->focal_u_px * x + raw->center_u_px), v = fixed(raw->focal_v_px * y + raw->center_v_px);
  whole[0] = (int16_t)(u >> 5);
  whole[1] = (int16_t)(v >> 5);
  *fraction = (uint16_t)((v & (SCALE - 1)) * SCALE + (u & (SCALE - 1)));
}

static inline void normalize(const row_rays *rays, int32_t u, double *x, double *y) {
  const double depth = rays->start[2] + u * rays->step[2];
  const double inverse = 1.0 / (depth > DEPTH_MIN ? depth : DEPTH_MIN);
  *x = (rays->start[0] + u * rays->step[0]) * inverse;
  *y = (rays->start[1] + u * rays->step[1]) * inverse;
}

VISTA_WIDE_VECTORS static void follow_pinhole(const vista_raw_camera *raw, const row_rays *rays, int32_t width_px,
                                              int16_t *whole, uint16_t *fraction) {
  const double *const k = raw->distortion;
  for (int32_t u = 0; u < width_px; ++u) {
    double x, y;
    normalize(rays, u, &x, &y);
    const double xx = x * x, yy = y * y, xy = 2.0 * x * y, rr = xx + yy;
    const double radial = (1.0 + ((k[4] * rr + k[1]) * rr + k[0]) * rr) / (1.0 + ((k[7] * rr + k[6]) * rr + k[5]) * rr);
    put(raw, x * radial + k[2] * xy + k[3] * (rr + 2.0 * xx), y * radial + k[2] * (rr + 2.0 * yy) + k[3] * xy,
        whole + 2 * (ptrdiff_t)u, fraction + u);
  }
}

static void follow_fisheye(const vista_raw_camera *raw, const row_rays *rays, int32_t width_px, int16_t *whole,
                           uint16_t *fraction) {
  const double *const k = raw->distortion;
  for (int32_t u = 0; u < width_px; ++u) {
    double x, y;
    normalize(rays, u, &x, &y);
    const double r = sqrt(x * x + y * y), theta = atan(r), tt = theta * theta;
    const double bent = theta * (1.0 + (((k[3] * tt + k[2]) * tt + k[1]) * tt + k[0]) * tt);
    const double scale = r > 0.0 ? bent / r : 1.0;
    put(raw, x * scale, y * scale, whole + 2 * (ptrdiff_t)u, fraction + u);
  }
}

/* raw_from_turned = transposed(rectified_from_raw) rotation(turn), applied to a vector. */
static void to_raw(const vista_raw_camera *raw, const double rotation[9], const double ray[3], double seen[3]) {
  const double turned[3] = {vista_dot(rotation, ray), vista_dot(rotation + 3, ray), vista_dot(rotation + 6, ray)};
  for (int i = 0; i < 3; ++i) {
    seen[i] = 0.0;
    for (int j = 0; j < 3; ++j) seen[i] += raw->rectified_from_raw[3 * j + i] * turned[j];
  }
}

static vista_status check_raw(const vista_raw_camera *raw) {
  double sum = raw->focal_u_px + raw->focal_v_px + raw->center_u_px + raw->center_v_px;
  for (int k = 0; k < VISTA_DISTORTION_MOST; ++k) sum += raw->distortion[k];
  for (int k = 0; k < 9; ++k) sum += raw->rectified_from_raw[k];
  const bool known = (unsigned)raw->lens < VISTA_LENS_COUNT;
  return known && raw->focal_u_px > 0.0 && raw->focal_v_px > 0.0 && isfinite(sum) ? VISTA_OK : VISTA_ERROR_NUMBER;
}

vista_status vista_turn_map(const vista_turn *turn, const vista_camera *camera, const vista_raw_camera *raw,
                            int32_t first_row, int32_t end_row, int16_t *whole, uint16_t *fraction) {
  if (turn == NULL || camera == NULL || raw == NULL || whole == NULL || fraction == NULL) return VISTA_ERROR_ARGUMENT;
  if (!isfinite(turn->pitch_rad) || !isfinite(turn->roll_rad)) return VISTA_ERROR_NUMBER;
  vista_status status = vista_frame_check_camera(camera);
  if (status == VISTA_OK) status = check_raw(raw);
  if (status != VISTA_OK) return status;
  if (first_row < 0 || end_row > camera->height_px || first_row > end_row) return VISTA_ERROR_RANGE;
  double rotation[9];
  row_rays rays;
  vista_turn_rotation(turn, rotation);
  to_raw(raw, rotation, (const double[3]){1.0 / camera->focal_px, 0.0, 0.0}, rays.step);
  for (int32_t v = first_row; v < end_row; ++v) {
    const double first[3] = {-camera->center_u_px / camera->focal_px, (v - camera->center_v_px) / camera->focal_px,
                             1.0};
    const ptrdiff_t at = (ptrdiff_t)v * camera->width_px;
    to_raw(raw, rotation, first, rays.start);
    if (raw->lens == VISTA_LENS_FISHEYE)
      follow_fisheye(raw, &rays, camera->width_px, whole + 2 * at, fraction + at);
    else
      follow_pinhole(raw, &rays, camera->width_px, whole + 2 * at, fraction + at);
  }
  return VISTA_OK;
}
