#include "container.h"

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "vista/frontend.h"

#define MAGIC "VISTAREC"
#define VERSION 5
#define SCALE 32 /* of fractions: units a pixel */
#define NAME_BYTES 48
#define CHOICE_BYTES 32
#define MOST_PARAMETERS 4096

enum { TABLES_NONE = 0, TABLES_MAP, TABLES_GRID };                     /* how raw images are rectified */
enum { CONTENT_RAW = 0, CONTENT_LEFT, CONTENT_PAIR, CONTENT_COUNT }; /* of a frame: raw pair; rectified, with words */
enum { FRAME_ANEW = 1, FRAME_HAS_POSE = 2, FRAME_HAS_UP = 4 };

typedef struct head {
  char magic[8];
  uint32_t version, width_px, height_px, tables, rectify_rows, content, stills, parameters;
  double focal_px, center_u_px, center_v_px, baseline_m, left_from_rectified[9];
  double right_focal_u_px, right_focal_v_px, right_center_u_px, right_center_v_px;
  double right_distortion[VISTA_DISTORTION_MOST], rectified_from_right[9];
  uint64_t right_lens;
  char problems[2][CONTAINER_TEXT_BYTES];
} head;

typedef struct parameter {
  char name[NAME_BYTES], choice[CHOICE_BYTES];
  double value;
} parameter;

typedef struct frame {
  int64_t t_ns;
  uint32_t index, flags;
  vista_pose pose;
  double up_world[3];
} frame;

static bool damaged(const container *c, problem *p) { return problem_say(p, c->path, "damaged"); }

static bool take(container *c, void *target, size_t bytes) { return fread(target, 1, bytes, c->stream) == bytes; }

/* ---- head ---- */

static bool is_rotation(const double *numbers) {
  for (int k = 0; k < 9; ++k)
    if (!(fabs(numbers[k]) <= 1.001)) return false;
  return true;
}

static bool check_head(const container *c, const head *h, problem *p) {
  if (memcmp(h->magic, MAGIC, sizeof h->magic) != 0) return problem_say(p, c->path, "no file of vista prepare");
  if (h->version != VERSION) return problem_say(p, c->path, "made by another version of vista: make it again");
  const bool sized = h->width_px >= VISTA_LEAST_IMAGE_PX && h->width_px <= VISTA_MOST_IMAGE_PX &&
                     h->height_px >= VISTA_LEAST_IMAGE_PX && h->height_px <= VISTA_MOST_IMAGE_PX;
  if (!sized || h->tables > TABLES_GRID || h->rectify_rows > 128 || h->content >= CONTENT_COUNT || h->stills > 1 ||
      h->parameters > MOST_PARAMETERS || h->right_lens >= VISTA_LENS_COUNT)
    return damaged(c, p);
  if (!is_rotation(h->left_from_rectified) || !is_rotation(h->rectified_from_right)) return damaged(c, p);
  return true; /* the numbers of the cameras are the library's to check */
}

static const char *problem_of(container *c, const head *h, int which) {
  memcpy(c->problems[which], h->problems[which], CONTAINER_TEXT_BYTES);
  c->problems[which][CONTAINER_TEXT_BYTES - 1] = '\0';
  return c->problems[which][0] != '\0' ? c->problems[which] : NULL;
}

static void set_rig(container *c, const head *h) {
  c->rig = (vista_rig){.camera = {(int32_t)h->width_px, (int32_t)h->height_px, h->focal_px, h->center_u_px,
                                  h->center_v_px, h->baseline_m},
                       .rectify_rows = (int32_t)h->rectify_rows,
                       .right = {.lens = (vista_lens)h->right_lens,
                                 .focal_u_px = h->right_focal_u_px,
                                 .focal_v_px = h->right_focal_v_px,
                                 .center_u_px = h->right_center_u_px,
                                 .center_v_px = h->right_center_v_px},
                       .baseline_problem = problem_of(c, h, 0),
                       .calibration_problem = problem_of(c, h, 1)};
  memcpy(c->rig.left_from_rectified, h->left_from_rectified, sizeof c->rig.left_from_rectified);
  memcpy(c->rig.right.distortion, h->right_distortion, sizeof c->rig.right.distortion);
  memcpy(c->rig.right.rectified_from_raw, h->rectified_from_right, sizeof c->rig.right.rectified_from_raw);
  c->has_words = h->content != CONTENT_RAW;
  c->has_right = h->content != CONTENT_LEFT;
  c->stills = h->stills != 0;
  c->pixels = (size_t)h->width_px * h->height_px;
}

/* ---- parameters ---- */

static bool read_parameters(container *c, uint32_t count, problem *p) {
  c->parameters = vista_parameters_default();
  for (uint32_t k = 0; k < count; ++k) {
    parameter given;
    if (!take(c, &given, sizeof given)) return damaged(c, p);
    char name[NAME_BYTES + 1] = {0}, choice[CHOICE_BYTES + 1] = {0};
    memcpy(name, given.name, NAME_BYTES);
    memcpy(choice, given.choice, CHOICE_BYTES);
    const vista_status status = choice[0] != '\0' ? vista_parameters_set_choice(&c->parameters, name, choice)
                                                  : vista_parameters_set(&c->parameters, name, given.value);
    if (status == VISTA_OK) continue;
    for (char *letter = name; *letter != '\0'; ++letter)
      if (!isprint((unsigned char)*letter)) *letter = '?';
    return problem_say(p, c->path, "unknown parameter or value: %s", name);
  }
  const char *culprit = NULL;
  return vista_parameters_check(&c->parameters, &culprit) == VISTA_OK ||
         problem_say(p, c->path, "%s is out of range", culprit);
}

/* ---- tables ---- */

static size_t table_bytes(const container *c, uint32_t tables) {
  const size_t columns = (size_t)vista_frontend_grid_points(c->rig.camera.width_px);
  const size_t rows = (size_t)vista_frontend_grid_points(c->rig.camera.height_px);
  return tables == TABLES_MAP    ? c->pixels * 3 * sizeof(int16_t)
         : tables == TABLES_GRID ? columns * rows * sizeof(vista_frontend_offset)
                                 : 0;
}

static bool set_table(container *c, uint32_t tables, int side) {
  const unsigned char *const at = (const unsigned char *)c->tables + (size_t)side * table_bytes(c, tables);
  vista_right_table *const table = &c->rig.tables[side];
  if (tables == TABLES_GRID) {
    table->grid = (const int16_t *)(const void *)at;
    return true;
  }
  table->whole = (const int16_t *)(const void *)at;
  table->fraction = (const uint16_t *)(const void *)(at + 2 * c->pixels * sizeof(int16_t));
  for (size_t k = 0; k < c->pixels; ++k)
    if (table->fraction[k] >= SCALE * SCALE) return false;
  return true;
}

static bool read_tables(container *c, uint32_t tables, problem *p) {
  const size_t bytes = 2 * table_bytes(c, tables);
  if (bytes == 0) return true;
  c->tables = malloc(bytes);
  if (c->tables == NULL) return problem_say(p, c->path, "out of memory");
  return (take(c, c->tables, bytes) && set_table(c, tables, 0) && set_table(c, tables, 1)) || damaged(c, p);
}

/* ---- frames ---- */

static size_t words_of(const vista_camera *camera, int32_t levels) {
  int32_t width_px = camera->width_px, height_px = camera->height_px;
  size_t words = 0;
  for (int32_t level = 0; level < levels; ++level) {
    words += (size_t)width_px * (size_t)height_px;
    width_px = vista_frontend_reduced_px(width_px);
    height_px = vista_frontend_reduced_px(height_px);
  }
  return words;
}

static bool count_frames(container *c, problem *p) {
  const size_t images = (c->has_right ? 2 : 1) * c->pixels;
  const off_t frame_bytes = (off_t)(sizeof(frame) + images + c->words * sizeof(int16_t));
  c->first_frame = ftello(c->stream);
  if (c->first_frame < 0 || fseeko(c->stream, 0, SEEK_END) != 0) return problem_errno(p, c->path, errno);
  const off_t bytes = ftello(c->stream) - c->first_frame;
  c->frames = (int64_t)(bytes / frame_bytes);
  return bytes % frame_bytes == 0 || problem_say(p, c->path, "cut off in a frame");
}

static bool read_all(container *c, problem *p) {
  head h;
  if (!take(c, &h, sizeof h)) return problem_say(p, c->path, "no file of vista prepare");
  if (!check_head(c, &h, p)) return false;
  set_rig(c, &h);
  if (!read_parameters(c, h.parameters, p) || !read_tables(c, h.tables, p)) return false;
  if (c->has_words) c->words = container_words_of_pair(c);
  return count_frames(c, p);
}

size_t container_words_of_pair(const container *c) { return words_of(&c->rig.camera, c->parameters.stereo.levels); }

bool container_open(container *c, const char *path, problem *p) {
  *c = (container){.path = path, .stream = fopen(path, "rb")};
  if (c->stream == NULL) return problem_errno(p, path, errno);
  (void)setvbuf(c->stream, c->buffer, _IOFBF, sizeof c->buffer);
  if (read_all(c, p)) return true;
  container_close(c);
  return false;
}

void container_close(container *c) {
  if (c->stream != NULL) (void)fclose(c->stream);
  free(c->tables);
  c->stream = NULL;
  c->tables = NULL;
}

bool container_rewind(container *c, problem *p) {
  return fseeko(c->stream, c->first_frame, SEEK_SET) == 0 || problem_errno(p, c->path, errno);
}

static bool is_finite(const double *numbers, int count) {
  for (int k = 0; k < count; ++k)
    if (!isfinite(numbers[k])) return false;
  return true;
}

bool container_read(container *c, shot *to, problem *p) {
  frame f;
  if (!take(c, &f, sizeof f) || !take(c, to->left, c->pixels) || (c->has_right && !take(c, to->right, c->pixels)) ||
      (c->words > 0 && !take(c, to->words, c->words * sizeof(int16_t))))
    return problem_say(p, c->path, "cannot be read to its end");
  to->has_pose = (f.flags & FRAME_HAS_POSE) != 0;
  to->has_up = (f.flags & FRAME_HAS_UP) != 0;
  if (to->has_pose && !is_finite(f.pose.rotation, 12)) /* with the translation behind it */
    return problem_say(p, c->path, "a pose is not finite");
  if (to->has_up && !is_finite(f.up_world, 3)) return problem_say(p, c->path, "a direction is not finite");
  to->index = f.index;
  to->t_ns = f.t_ns;
  to->anew = (f.flags & FRAME_ANEW) != 0;
  to->matched = c->has_words;
  to->left_alone = !c->has_right;
  to->pose = f.pose;
  memcpy(to->up_world, f.up_world, sizeof to->up_world);
  return true;
}
