#include "vista/rig.h"

#include <stdbool.h>
#include <string.h>

#include "vista/frontend.h"

#define SCALE 32 /* of fractions: units a pixel */

static int32_t inside(int32_t value, int32_t last) { return value < 0 ? 0 : value > last ? last : value; }

/* Interpolates between four pixels, so many 1/32 px to the right of the first and below it. */
static uint8_t between(const uint8_t *upper, const uint8_t *lower, int32_t u0, int32_t u1, int32_t fu, int32_t fv) {
  const int32_t a = (SCALE - fu) * upper[u0] + fu * upper[u1], b = (SCALE - fu) * lower[u0] + fu * lower[u1];
  return (uint8_t)(((SCALE - fv) * a + fv * b + SCALE * SCALE / 2) / (SCALE * SCALE));
}

static void follow_map(const vista_right_table *table, const vista_image *raw, uint8_t *out) {
  const int32_t right = raw->width_px - 1, bottom = raw->height_px - 1, pixels = raw->width_px * raw->height_px;
  for (int32_t k = 0; k < pixels; ++k) {
    const int32_t u = table->whole[2 * (ptrdiff_t)k], v = table->whole[2 * (ptrdiff_t)k + 1];
    const int32_t fu = table->fraction[k] % SCALE, fv = table->fraction[k] / SCALE % SCALE;
    if (u >= 0 && u < right && v >= 0 && v < bottom) {
      const uint8_t *const upper = raw->data + v * raw->stride;
      out[k] = between(upper, upper + raw->stride, u, u + 1, fu, fv);
    } else {
      out[k] = between(raw->data + inside(v, bottom) * raw->stride, raw->data + inside(v + 1, bottom) * raw->stride,
                       inside(u, right), inside(u + 1, right), fu, fv);
    }
  }
}

vista_status vista_rectify(const vista_camera *camera, const vista_right_table *table, const vista_image *raw,
                           uint8_t *out) {
  if (camera == NULL || table == NULL || raw == NULL || raw->data == NULL || out == NULL) return VISTA_ERROR_ARGUMENT;
  const int32_t width = camera->width_px, height = camera->height_px;
  if (raw->width_px != width || raw->height_px != height || raw->stride < width) return VISTA_ERROR_SIZE;
  const vista_frontend_image image = {raw->data, width, height, raw->stride};
  const vista_frontend_offset *const grid = (const vista_frontend_offset *)(const void *)table->grid;
  if (table->whole != NULL && table->fraction != NULL)
    follow_map(table, raw, out);
  else if (grid != NULL)
    return vista_frontend_rectify(&image, grid, out, width) == VISTA_ENGINE_OK ? VISTA_OK : VISTA_ERROR_ARGUMENT;
  else
    for (int32_t v = 0; v < height; ++v) memcpy(out + (ptrdiff_t)v * width, raw->data + v * raw->stride, (size_t)width);
  return VISTA_OK;
}

static bool comes_rectified(const vista_rig *rig) {
  return rig->tables[0].whole == NULL && rig->tables[0].grid == NULL;
}

vista_pose vista_rig_rectified_pose(const vista_rig *rig, const vista_pose *raw) {
  vista_pose pose = *raw;
  if (comes_rectified(rig)) return pose;
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) {
      double sum = 0.0;
      for (int k = 0; k < 3; ++k) sum += raw->rotation[3 * row + k] * rig->left_from_rectified[3 * k + column];
      pose.rotation[3 * row + column] = sum;
    }
  return pose;
}
