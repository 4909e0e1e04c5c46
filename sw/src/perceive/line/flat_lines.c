#include "perceive/line/flat_lines.h"

#include <math.h>
#include <stddef.h>

#include "common/flight_path.h"
#include "common/frame.h"

#define WIDTH_PX 640
#define HEIGHT_PX 256
#define LEAD_M 30.0 /* of the path, to the point in the middle of what is searched */
#define LEAN 5 /* rows per strip of columns */
/* A steeper line is found from row to row. */
#define STEEPEST ((double)VISTA_STRIP_ROWS / VISTA_STRIP_LEAN)

void vista_flat_lines_layout(vista_flat_lines *flat, vista_arena *arena, int32_t width_px, int32_t height_px) {
  const int32_t width = width_px < WIDTH_PX ? width_px : WIDTH_PX;
  const int32_t height = height_px < HEIGHT_PX ? height_px : HEIGHT_PX;
  flat->turned = vista_arena_take(arena, (size_t)width * (size_t)height, 1);
  vista_straight_lines_layout(&flat->lines, arena, height, width);
  flat->lines.ridge.flat = true;
  flat->lines.ridge.lean_max = LEAN;
}

static int32_t first_of(double middle, int32_t length, int32_t whole) {
  return (int32_t)lround(fmin(fmax(middle - 0.5 * length, 0.0), whole - length));
}

static void turn(const vista_image *image, int32_t first_u, int32_t first_v, int32_t width, int32_t height,
                 uint8_t *restrict turned) {
  for (int32_t v = 0; v < height; ++v) {
    const uint8_t *const row = image->data + (ptrdiff_t)(first_v + v) * image->stride + first_u;
    for (int32_t u = 0; u < width; ++u) turned[(ptrdiff_t)u * height + v] = row[u];
  }
}

void vista_flat_lines_find(const vista_frame_view *frame, double contrast, vista_flat_lines *flat) {
  vista_ridge *const ridge = &flat->lines.ridge;
  const vista_camera *const camera = frame->camera;
  const int32_t width = ridge->height_px, height = ridge->width_px;
  double point_m[3], ahead_m[3];
  vista_flight_path_point(&frame->path, fmin(LEAD_M, frame->path.length_m), point_m, NULL);
  vista_frame_to_camera(&frame->motion.pose, point_m, ahead_m);
  flat->lines.count = 0;
  if (!(ahead_m[2] > 0.0)) return;
  const double per_m = camera->focal_px / ahead_m[2];
  ridge->along_px = first_of(camera->center_u_px + per_m * ahead_m[0], width, frame->image.width_px);
  ridge->across_px = first_of(camera->center_v_px + per_m * ahead_m[1], height, frame->image.height_px);
  turn(&frame->image, ridge->along_px, ridge->across_px, width, height, flat->turned);
  const vista_image turned = {.data = flat->turned, .width_px = height, .height_px = width, .stride = height};
  vista_straight_lines_find(&turned, contrast, &flat->lines);
  int32_t kept = 0;
  for (int32_t i = 0; i < flat->lines.count; ++i) {
    const vista_thin_line line = flat->lines.items[i];
    if (fabs(line.slope) <= STEEPEST) flat->lines.items[kept++] = line;
  }
  flat->lines.count = kept;
}
