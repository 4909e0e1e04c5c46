/* What vista-fly reads: files of vista prepare, with their frames through the detector, and bytes of an autopilot. No
 * error of memory or arithmetic, every refusal is one line, and a pose is finite. */
#define _GNU_SOURCE
#include <math.h>
#include <stdio.h>
#include <sys/mman.h>
#include <unistd.h>

#include "../apps/fly/container.h"
#include "input.h"
#include "vista/vista.h"

#define MOST_PX 65536
#define MOST_FRAMES 8

static void check_line(const problem *p) {
  if (p->line[0] == '\0' || strchr(p->line, '\n') != NULL) abort();
}

static void rectify(const vista_camera *camera, const vista_right_table *table, const uint8_t *raw, uint8_t *out) {
  const size_t pixels = (size_t)camera->width_px * (size_t)camera->height_px;
  const vista_image image = {raw, camera->width_px, camera->height_px, camera->width_px};
  if (vista_rectify(camera, table, &image, out) != VISTA_OK) abort();
  if (out[0] != 7 || out[pixels - 1] != 7) abort(); /* of an even image whatever the map says */
}

/* What the correction makes of a rig. */
static void turn(const vista_rig *rig, const uint8_t *raw, uint8_t *out) {
  const vista_camera *const camera = &rig->camera;
  const size_t pixels = (size_t)camera->width_px * (size_t)camera->height_px;
  int16_t *const whole = fuzz_allocate(2 * pixels * sizeof *whole);
  uint16_t *const fraction = fuzz_allocate(pixels * sizeof *fraction);
  const vista_turn turn = {0.01, -0.02};
  const vista_right_table table = {.whole = whole, .fraction = fraction};
  if (vista_turn_map(&turn, camera, &rig->right, 0, camera->height_px, whole, fraction) == VISTA_OK)
    rectify(camera, &table, raw, out);
  free(fraction);
  free(whole);
}

/* A frame of the file through the detector, which may refuse it. */
static void judge(const container *c, vista_detector *detector, const shot *s) {
  const int32_t width = c->rig.camera.width_px, height = c->rig.camera.height_px;
  const vista_detector_pair pair = {.left = {s->left, width, height, width},
                                    .right = {s->left_alone ? NULL : s->right, width, height, width},
                                    .t_ns = s->t_ns,
                                    .rectified = s->matched};
  const vista_detector_place place = {
      .pose = s->has_pose ? &s->pose : NULL, .up_world = s->has_up ? s->up_world : NULL, .anew = s->anew};
  vista_disparity_image words[1 + VISTA_COARSER_LEVELS];
  const int16_t *at = s->words;
  int32_t level_width = width, level_height = height;
  for (int32_t level = 0; level < c->parameters.stereo.levels; ++level) {
    words[level] = (vista_disparity_image){at, level_width, level_height, level_width};
    at += s->matched ? (ptrdiff_t)level_width * level_height : 0;
    level_width = (level_width + 1) / 2;
    level_height = (level_height + 1) / 2;
  }
  vista_novelty novelty;
  vista_detector_result result;
  if (vista_detector_take(detector, &pair, &novelty) != VISTA_OK) abort();
  if (novelty == VISTA_PAIR_REPEATED) return;
  if (vista_detector_match(detector, s->matched ? words : NULL) != VISTA_OK) abort();
  if (vista_detector_judge(detector, &place, &result) != VISTA_OK) vista_detector_forget(detector);
}

static void play(container *c) {
  const vista_detector_options options = {.stills = c->stills};
  vista_detector *detector = NULL;
  size_t bytes = 0;
  problem p = {0};
  if (vista_detector_bytes(&c->parameters, &c->rig, &options, &bytes) != VISTA_OK) return;
  shot s = {.left = fuzz_allocate(c->pixels),
            .right = fuzz_allocate(c->pixels),
            .words = fuzz_allocate((c->words + 1) * sizeof(int16_t))};
  void *const memory = fuzz_allocate(bytes);
  if (vista_detector_create(memory, bytes, &c->parameters, &c->rig, &options, &detector) == VISTA_OK) {
    if (!container_rewind(c, &p)) abort();
    for (int64_t k = 0; k < c->frames && k < MOST_FRAMES; ++k) {
      if (!container_read(c, &s, &p)) {
        check_line(&p);
        break;
      }
      judge(c, detector, &s);
    }
    vista_detector_destroy(detector);
  }
  free(memory);
  free(s.words);
  free(s.right);
  free(s.left);
}

static void read_container(const fuzz_input *input) {
  static container c; /* large */
  char path[64];
  problem p = {0};
  const int file = memfd_create("rig", 0);
  if (file < 0 || write(file, input->data, input->size) != (ssize_t)input->size) abort();
  (void)snprintf(path, sizeof path, "/proc/self/fd/%d", file);
  if (!container_open(&c, path, &p)) {
    check_line(&p);
  } else if (c.pixels <= MOST_PX) {
    uint8_t *const raw = fuzz_allocate(c.pixels), *const out = fuzz_allocate(c.pixels);
    memset(raw, 7, c.pixels);
    for (int side = 0; side < 2; ++side) rectify(&c.rig.camera, &c.rig.tables[side], raw, out);
    turn(&c.rig, raw, out);
    free(out);
    free(raw);
    play(&c);
  }
  container_close(&c);
  (void)close(file);
}

static void hear(fuzz_input *input) {
  const vista_parameters parameters = vista_parameters_default();
  vista_vehicle vehicle;
  int64_t now_ns = 0;
  if (vista_vehicle_start(&vehicle, &parameters.mavlink, 0) != VISTA_OK) abort();
  while (input->size > 0) {
    uint8_t bytes[600];
    const int32_t count = fuzz_between(input, 0, (int32_t)sizeof bytes);
    const int32_t given = (size_t)count < input->size ? count : (int32_t)input->size;
    now_ns += fuzz_between(input, 0, 60000) * INT64_C(20000);
    fuzz_take(input, bytes, (size_t)given);
    if (vista_vehicle_receive(&vehicle, now_ns, bytes, given) != VISTA_OK) abort();
    vista_vehicle_motion motion;
    if (vista_vehicle_at(&vehicle, now_ns - fuzz_between(input, 0, 300) * INT64_C(1000000), &motion) != VISTA_OK)
      abort();
    for (int k = 0; k < 9; ++k)
      if (!(fabs(motion.pose.rotation[k]) <= 1.0 + 1e-9)) abort();
    for (int k = 0; k < 3; ++k)
      if (!isfinite(motion.pose.translation_m[k])) abort();
  }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  fuzz_input input = {data, size};
  switch (fuzz_byte(&input) % 2) {
    case 0:
      read_container(&input);
      break;
    default:
      hear(&input);
      break;
  }
  return 0;
}
