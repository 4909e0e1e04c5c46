#include "rig.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "vista/frontend.h"

#define VERSION 2
#define SCALE 32 /* of fractions: units a pixel */
#define MAGIC "VISTARIG"
#define BASELINE_IMPLAUSIBLE 1u /* in findings */
#define CALIBRATION_MISFIT 2u

typedef enum rig_kind { RIG_PASSTHROUGH = 0, RIG_MAP, RIG_GRID } rig_kind;

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
    vista_right_table *const table = &r->cameras.tables[side];
    if (head->kind == RIG_GRID) {
      table->grid = (const int16_t *)(const void *)at;
    } else if (head->kind == RIG_MAP) {
      table->whole = (const int16_t *)(const void *)at;
      table->fraction = (const uint16_t *)(const void *)(at + 2 * pixels * sizeof(int16_t));
    }
  }
}

static bool check_fractions(const char *path, const rig *r, problem *p) {
  const size_t pixels = (size_t)r->cameras.camera.width_px * (size_t)r->cameras.camera.height_px;
  for (int side = 0; side < 2; ++side)
    for (size_t k = 0; r->cameras.tables[side].fraction != NULL && k < pixels; ++k)
      if (r->cameras.tables[side].fraction[k] >= SCALE * SCALE) return problem_say(p, path, "damaged");
  return true;
}

static vista_rig rig_of(const rig_head *head) {
  vista_rig r = {.camera = {(int32_t)head->width_px, (int32_t)head->height_px, head->focal_px, head->center_u_px,
                            head->center_v_px, head->baseline_m},
                 .rectify_rows = (int32_t)head->rectify_rows,
                 .right = {.lens = (vista_lens)head->right_lens,
                           .focal_u_px = head->right_focal_u_px,
                           .focal_v_px = head->right_focal_v_px,
                           .center_u_px = head->right_center_u_px,
                           .center_v_px = head->right_center_v_px}};
  memcpy(r.left_from_rectified, head->left_from_rectified, sizeof r.left_from_rectified);
  memcpy(r.right.distortion, head->right_distortion, sizeof r.right.distortion);
  memcpy(r.right.rectified_from_raw, head->rectified_from_right, sizeof r.right.rectified_from_raw);
  if (head->findings & BASELINE_IMPLAUSIBLE) r.baseline_problem = "the baseline is not that of a vehicle";
  if (head->findings & CALIBRATION_MISFIT) r.calibration_problem = "the calibration does not fit the images";
  return r;
}

static bool read_stream(const char *path, FILE *stream, rig *r, problem *p) {
  rig_head head;
  if (fread(&head, sizeof head, 1, stream) != 1) return problem_say(p, path, "no rig of vista prepare");
  if (!check_head(path, &head, p)) return false;
  r->cameras = rig_of(&head);
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

void rig_free(rig *r) {
  free(r->memory);
  *r = (rig){0};
}
