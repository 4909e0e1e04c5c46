/* Rectification by a control grid: one row at a time, from one column of control points to the next. */
#include "front_check.h"

enum { STEP = VISTA_FRONTEND_GRID_STEP_PX, SCALE = VISTA_FRONTEND_GRID_SCALE, SPARE_ROWS = 2 };

int32_t vista_frontend_grid_points(int32_t side_px) { return (side_px + STEP - 1) / STEP + 1; }

/* Offsets along a row, in 1/256 of 1/32 px. */
typedef struct offset {
  int32_t x, y;
} offset;

/* The offset between two control points of a column, times STEP; j rows below the upper one. */
static offset between_rows(const vista_frontend_offset *upper, int32_t columns, int32_t j) {
  const vista_frontend_offset *lower = upper + columns;
  return (offset){(STEP - j) * upper->dx + j * lower->dx, (STEP - j) * upper->dy + j * lower->dy};
}

static int32_t inside(int32_t value, int32_t last) { return value < 0 ? 0 : value > last ? last : value; }

/* A right shift of a negative number is arithmetic on every compiler that builds this; the tests hold it to that. */
static int32_t rounded(int32_t sum) { return (sum + 128) >> 8; }

static uint8_t sample(const vista_frontend_image *image, int32_t x, int32_t y) {
  x = inside(x, (image->width - 1) * SCALE);
  y = inside(y, (image->height - 1) * SCALE);
  const int32_t fx = x % SCALE, fy = y % SCALE;
  const uint8_t *above = image->pixels + y / SCALE * image->stride + x / SCALE;
  const uint8_t *under = above + (fy ? image->stride : 0); /* what has no weight may lie outside */
  const int32_t right = fx != 0;
  const int32_t a = (SCALE - fx) * above[0] + fx * above[right], b = (SCALE - fx) * under[0] + fx * under[right];
  return (uint8_t)(((SCALE - fy) * a + fy * b + 512) >> 10);
}

static void rectify_row(const vista_frontend_image *image, const vista_frontend_offset *grid, int32_t y, uint8_t *out) {
  const int32_t columns = vista_frontend_grid_points(image->width), j = y % STEP;
  const vista_frontend_offset *upper = grid + (ptrdiff_t)(y / STEP) * columns;
  offset left = between_rows(upper, columns, j);
  for (int32_t first = 0; first < image->width; first += STEP) {
    const offset right = between_rows(++upper, columns, j);
    const int32_t end = image->width - first < STEP ? image->width - first : STEP;
    for (int32_t i = 0; i < end; ++i)
      out[first + i] = sample(image, (first + i) * SCALE + rounded((STEP - i) * left.x + i * right.x),
                              y * SCALE + rounded((STEP - i) * left.y + i * right.y));
    left = right;
  }
}

vista_engine_status vista_frontend_rectify(const vista_frontend_image *image, const vista_frontend_offset *grid,
                                           uint8_t *out, ptrdiff_t out_stride) {
  vista_engine_status status = vista_front_check_image(image, out);
  if (status == VISTA_ENGINE_OK && !grid) status = VISTA_ENGINE_ERROR_ARGUMENT;
  if (status == VISTA_ENGINE_OK) status = vista_front_check_memory(image, out, image->width, image->height, out_stride);
  if (status != VISTA_ENGINE_OK) return status;
  for (int32_t y = 0; y < image->height; ++y) rectify_row(image, grid, y, out + y * out_stride);
  return VISTA_ENGINE_OK;
}

int32_t vista_frontend_row_beyond(const vista_frontend_offset *grid, int32_t width, int32_t height,
                                  int32_t buffer_rows) {
  const int32_t columns = vista_frontend_grid_points(width), rows = vista_frontend_grid_points(height);
  const int32_t reach = (buffer_rows - SPARE_ROWS) / 2 - 1;
  for (int32_t row = 0; row < rows; ++row)
    for (int32_t column = 0; column < columns; ++column, ++grid)
      if (grid->dy < -reach * SCALE || grid->dy >= (reach + 1) * SCALE) return row * STEP;
  return -1;
}
