#include "rig.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define VERSION 2
#define SCALE 32 /* of fractions: units a pixel */
#define MAGIC "VISTARIG"

typedef struct rig_head {
  char magic[8];
  uint32_t version, width_px, height_px, kind, rectify_rows, findings;
  double focal_px, center_u_px, center_v_px, baseline_m, left_from_rectified[9];
  double right_focal_u_px, right_focal_v_px, right_center_u_px, right_center_v_px;
  double right_distortion[VISTA_DISTORTION_MOST], rectified_from_right[9];
  uint64_t right_lens;
} rig_head;

static size_t table_bytes(const rig_head *head) {
  const size_t pixels = (size_t)head->width_px * head->height_px;
  const size_t columns = (size_t)vista_frontend_grid_points((int32_t)head->width_px);
  const size_t rows = (size_t)vista_frontend_grid_points((int32_t)head->height_px);
  switch ((rig_kind)head->kind) {
    case RIG_MAP:
      return pixels * 3 * sizeof(int16_t);
    case RIG_GRID:
      return columns * rows * sizeof(vista_frontend_offset);
    default:
      return 0;
  }
}

static bool check_head(const char *path, const rig_head *head, problem *p) {
  if (memcmp(head->magic, MAGIC, sizeof head->magic) != 0) return problem_say(p, path, "no rig of vista prepare");
  if (head->version != VERSION) return problem_say(p, path, "made by another version of vista: prepare it again");
  const bool sized = head->width_px >= VISTA_LEAST_IMAGE_PX && head->width_px <= VISTA_MOST_IMAGE_PX &&
                     head->height_px >= VISTA_LEAST_IMAGE_PX && head->height_px <= VISTA_MOST_IMAGE_PX;
  if (!sized || head->kind > RIG_GRID || head->rectify_rows > 128) return problem_say(p, path, "damaged");
  for (int k = 0; k < 9; ++k)
    if (!(fabs(head->left_from_rectified[k]) <= 1.001 && fabs(head->rectified_from_right[k]) <= 1.001))
      return problem_say(p, path, "damaged");
  if (head->right_lens >= VISTA_LENS_COUNT) return problem_say(p, path, "damaged");
  return true; /* the numbers of the cameras are the library's to check */
}

static void set_tables(rig *r, const rig_head *head) {
  const size_t pixels = (size_t)head->width_px * head->height_px;
  for (int side = 0; side < 2; ++side) {
    unsigned char *const at = (unsigned char *)r->memory + (size_t)side * table_bytes(head);
    if (r->kind == RIG_GRID) {
      r->tables[side].grid = (const int16_t *)(const void *)at;
    } else if (r->kind == RIG_MAP) {
      r->tables[side].whole = (const int16_t *)(const void *)at;
      r->tables[side].fraction = (const uint16_t *)(const void *)(at + 2 * pixels * sizeof(int16_t));
    }
  }
}

static bool check_fractions(const char *path, const rig *r, problem *p) {
  const size_t pixels = (size_t)r->camera.width_px * (size_t)r->camera.height_px;
  for (int side = 0; side < 2 && r->kind == RIG_MAP; ++side)
    for (size_t k = 0; k < pixels; ++k)
      if (r->tables[side].fraction[k] >= SCALE * SCALE) return problem_say(p, path, "damaged");
  return true;
}

static bool read_stream(const char *path, FILE *stream, rig *r, problem *p) {
  rig_head head;
  if (fread(&head, sizeof head, 1, stream) != 1) return problem_say(p, path, "no rig of vista prepare");
  if (!check_head(path, &head, p)) return false;
  *r = (rig){.camera = {(int32_t)head.width_px, (int32_t)head.height_px, head.focal_px, head.center_u_px,
                        head.center_v_px, head.baseline_m},
             .kind = (rig_kind)head.kind,
             .rectify_rows = (int32_t)head.rectify_rows,
             .findings = head.findings};
  memcpy(r->left_from_rectified, head.left_from_rectified, sizeof r->left_from_rectified);
  r->right = (vista_raw_camera){(vista_lens)head.right_lens,
                                head.right_focal_u_px,
                                head.right_focal_v_px,
                                head.right_center_u_px,
                                head.right_center_v_px,
                                {0},
                                {0}};
  memcpy(r->right.distortion, head.right_distortion, sizeof r->right.distortion);
  memcpy(r->right.rectified_from_raw, head.rectified_from_right, sizeof r->right.rectified_from_raw);
  const size_t bytes = 2 * table_bytes(&head);
  if (bytes > 0 && (r->memory = malloc(bytes)) == NULL) return problem_say(p, path, "out of memory");
  if (bytes > 0) set_tables(r, &head); /* what is rectified already has none */
  if ((bytes > 0 && fread(r->memory, bytes, 1, stream) != 1) || fgetc(stream) != EOF)
    return problem_say(p, path, "damaged");
  return check_fractions(path, r, p);
}

bool rig_read(const char *path, rig *r, problem *p) {
  *r = (rig){0};
  FILE *const stream = fopen(path, "rb");
  if (stream == NULL) return problem_errno(p, path, errno);
  const bool done = read_stream(path, stream, r, p);
  (void)fclose(stream);
  if (!done) rig_free(r);
  return done;
}

static int32_t inside(int32_t value, int32_t last) { return value < 0 ? 0 : value > last ? last : value; }

/* As cv2.remap with bilinear interpolation and a replicated border. */
static void follow_map(const rig *r, const rig_table *table, const uint8_t *raw, uint8_t *out) {
  const int32_t width = r->camera.width_px, right = width - 1, bottom = r->camera.height_px - 1;
  const int32_t pixels = width * r->camera.height_px;
  for (int32_t k = 0; k < pixels; ++k) {
    const int32_t u = table->whole[2 * (ptrdiff_t)k], v = table->whole[2 * (ptrdiff_t)k + 1];
    const int32_t fu = table->fraction[k] % SCALE, fv = table->fraction[k] / SCALE;
    const int32_t u0 = inside(u, right), u1 = inside(u + 1, right);
    const uint8_t *const upper = raw + (ptrdiff_t)inside(v, bottom) * width;
    const uint8_t *const lower = raw + (ptrdiff_t)inside(v + 1, bottom) * width;
    const int32_t a = (SCALE - fu) * upper[u0] + fu * upper[u1], b = (SCALE - fu) * lower[u0] + fu * lower[u1];
    out[k] = (uint8_t)(((SCALE - fv) * a + fv * b + SCALE * SCALE / 2) / (SCALE * SCALE));
  }
}

void rig_rectify(const rig *r, const rig_table *table, const uint8_t *raw, uint8_t *out) {
  const int32_t width = r->camera.width_px, height = r->camera.height_px;
  const vista_frontend_image image = {raw, width, height, width};
  if (table->whole != NULL)
    follow_map(r, table, raw, out);
  else if (table->grid != NULL)
    (void)vista_frontend_rectify(&image, (const vista_frontend_offset *)(const void *)table->grid, out, width);
  else
    memcpy(out, raw, (size_t)width * (size_t)height);
}

vista_pose rig_rectified_pose(const rig *r, const vista_pose *raw) {
  vista_pose pose = *raw;
  if (r->kind == RIG_PASSTHROUGH) return pose;
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) {
      double sum = 0.0;
      for (int k = 0; k < 3; ++k) sum += raw->rotation[3 * row + k] * r->left_from_rectified[3 * k + column];
      pose.rotation[3 * row + column] = sum;
    }
  return pose;
}

void rig_free(rig *r) {
  free(r->memory);
  *r = (rig){0};
}
