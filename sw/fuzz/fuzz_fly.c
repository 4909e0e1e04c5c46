/* What vista-fly reads: a configuration, a rig, or bytes of an autopilot. No error of memory or arithmetic, every
 * refusal is one line, and a pose is finite. */
#define _GNU_SOURCE
#include <math.h>
#include <stdio.h>
#include <sys/mman.h>
#include <unistd.h>

#include "../apps/fly/config.h"
#include "../apps/fly/rig.h"
#include "input.h"
#include "vista/vista.h"

#define RIG_MOST_PX 65536

static void check_line(const problem *p) {
  if (p->line[0] == '\0' || strchr(p->line, '\n') != NULL) abort();
}

static void read_config(const fuzz_input *input) {
  problem p = {0};
  vista_parameters parameters = vista_parameters_default();
  if (!config_parse("my.toml", (const char *)input->data, input->size, &parameters, &p))
    check_line(&p);
  else if (vista_parameters_check(&parameters, NULL) != VISTA_OK)
    abort();
}

static void rectify(const vista_camera *camera, const vista_right_table *table, const uint8_t *raw, uint8_t *out) {
  const vista_image image = {raw, camera->width_px, camera->height_px, camera->width_px};
  if (vista_rectify(camera, table, &image, out) != VISTA_OK) abort();
}

/* What the correction makes of a rig. */
static void turn(const rig *r, const uint8_t *raw, uint8_t *out) {
  const vista_camera *const camera = &r->cameras.camera;
  const size_t pixels = (size_t)camera->width_px * (size_t)camera->height_px;
  int16_t *const whole = fuzz_allocate(2 * pixels * sizeof *whole);
  uint16_t *const fraction = fuzz_allocate(pixels * sizeof *fraction);
  const vista_turn turn = {0.01, -0.02};
  const vista_right_table table = {.whole = whole, .fraction = fraction};
  if (vista_turn_map(&turn, camera, &r->cameras.right, 0, camera->height_px, whole, fraction) == VISTA_OK) {
    rectify(camera, &table, raw, out);
    if (out[0] != 7 || out[pixels - 1] != 7) abort();
  }
  free(fraction);
  free(whole);
}

static void read_rig(const fuzz_input *input) {
  char path[64];
  problem p = {0};
  rig r;
  const int file = memfd_create("rig", 0);
  if (file < 0 || write(file, input->data, input->size) != (ssize_t)input->size) abort();
  (void)snprintf(path, sizeof path, "/proc/self/fd/%d", file);
  if (rig_read(path, &r, &p)) {
    const vista_camera *const camera = &r.cameras.camera;
    const size_t pixels = (size_t)camera->width_px * (size_t)camera->height_px;
    uint8_t *const raw = fuzz_allocate(pixels), *const out = fuzz_allocate(pixels);
    memset(raw, 7, pixels);
    for (int side = 0; side < 2 && pixels <= RIG_MOST_PX; ++side) {
      rectify(camera, &r.cameras.tables[side], raw, out);
      if (out[0] != 7 || out[pixels - 1] != 7) abort(); /* of an even image whatever the map says */
    }
    if (pixels <= RIG_MOST_PX) turn(&r, raw, out);
    free(out);
    free(raw);
    rig_free(&r);
  } else {
    check_line(&p);
  }
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
  switch (fuzz_byte(&input) % 3) {
    case 0:
      read_config(&input);
      break;
    case 1:
      read_rig(&input);
      break;
    default:
      hear(&input);
      break;
  }
  return 0;
}
