#include "perceive/line/thin.h"

#include <math.h>
#include <stddef.h>

#include "common/flight_path.h"
#include "common/frame.h"
#include "perceive/line/line_depth.h"

#define CONTRAST_NOISE 3.0 /* the contrast that counts in full is at least this many sigmas of the image's noise */

#define WIDTH_PX 640
#define HEIGHT_PX 256
#define LEAD_M 30.0 /* of the path, to the point in the middle of what is searched */
/* Rows per strip of columns. */
#define LEAN ((VISTA_STRIP_ROWS * VISTA_STRIP_ROWS + VISTA_STRIP_LEAN - 1) / VISTA_STRIP_LEAN)
/* A steeper line is found from row to row. */
#define STEEPEST ((double)VISTA_STRIP_ROWS / VISTA_STRIP_LEAN)

typedef struct flat_lines {
  uint8_t *turned; /* the part of the image that is searched: a row for each of its columns */
  vista_straight_lines lines;
} flat_lines;

struct vista_thin {
  int32_t width_px, height_px;
  vista_straight_lines image;
  flat_lines flat;
  vista_line_motion motion;
  vista_line_sample *samples; /* scratch: the longer side of the image */
  vista_thin_line *items;
  int32_t count;
};

static void layout_flat(flat_lines *flat, vista_arena *arena, int32_t width_px, int32_t height_px) {
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

/* Looks for lines that lie flat near where the flight path leads, from column to column: the image around the path is
 * turned. What is steeper is looked for from row to row. */
static void find_flat(const vista_frame_view *frame, double contrast, flat_lines *flat) {
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

vista_status vista_thin_layout(vista_thin **thin, vista_arena *arena, int32_t width_px, int32_t height_px) {
  *thin = NULL;
  if (width_px < 1 || height_px < 1 || width_px > INT16_MAX || height_px > INT16_MAX) return VISTA_ERROR_SIZE;
  vista_thin *const made = vista_arena_take(arena, 1, sizeof *made);
  vista_thin parts = {.width_px = width_px, .height_px = height_px};
  vista_straight_lines_layout(&parts.image, arena, width_px, height_px);
  layout_flat(&parts.flat, arena, width_px, height_px);
  vista_line_motion_layout(&parts.motion, arena, width_px, height_px);
  parts.samples =
      vista_arena_take(arena, (size_t)(width_px > height_px ? width_px : height_px), sizeof(vista_line_sample));
  parts.items = vista_arena_take(arena, VISTA_STRAIGHT_LINES_MAX, sizeof(vista_thin_line));
  if (arena->base == NULL) return VISTA_OK;
  if (arena->used > arena->size) return VISTA_ERROR_MEMORY;
  *made = parts;
  *thin = made;
  return VISTA_OK;
}

/* Adds those lines of the image along which the words tell of a thin thing. */
static void add_things(const vista_frame_view *frame, const vista_surfaces *surfaces, const vista_straight_lines *lines,
                       vista_thin *thin) {
  const vista_line_view view = {frame, surfaces, &lines->ridge, &thin->motion, thin->samples};
  vista_line_motion_begin(&thin->motion);
  for (int32_t i = 0; i < lines->count && thin->count < VISTA_THIN_MAX; ++i)
    thin->count += vista_line_depth(&view, &lines->items[i], &thin->items[thin->count]);
}

void vista_thin_search(const vista_frame_view *frame, const vista_surfaces *surfaces, vista_thin *thin) {
  const vista_thin_params *const params = &frame->params->thin;
  thin->count = 0;
  if (params->find == VISTA_THIN_FIND_OFF || thin->width_px <= 2 * VISTA_RIDGE_REACH) return;
  vista_past_views_begin(&thin->motion.views, frame);
  const double contrast = fmax(params->contrast, CONTRAST_NOISE * frame->noise.sigma);
  vista_straight_lines_find(&frame->image, contrast, &thin->image);
  add_things(frame, surfaces, &thin->image, thin);
  find_flat(frame, contrast, &thin->flat);
  add_things(frame, surfaces, &thin->flat.lines, thin);
  vista_past_views_keep(&thin->motion.views, frame);
}

vista_thin_lines vista_thin_found(const vista_thin *thin) { return (vista_thin_lines){thin->items, thin->count}; }
