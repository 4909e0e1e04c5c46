/* Cameras of V4L2 as a source: pictures are paired by their times, and a camera that is unplugged is waited for. */
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "clock.h"
#include "device.h"
#include "jpeg.h"
#include "source.h"

#define POLL_MS 100
#define REOPEN_NS FLY_SECOND
#define SILENT_NS (2 * FLY_SECOND) /* a camera that delivers nothing for so long is opened anew */

typedef struct eye {
  device device;
  uint8_t *picture; /* its newest one, or both views */
  bool has_picture;
  int64_t taken_ns, heard_ns, tried_ns;
} eye;

typedef struct cameras {
  eye eyes[2];
  int count;
  int64_t tolerance_ns;
} cameras;

static void lose(eye *e) {
  dprintf(STDERR_FILENO, "vista-fly: %s: lost; trying to open it again\n", e->device.name);
  device_close(&e->device);
  e->has_picture = false;
  e->tried_ns = fly_now_ns();
}

static void open_again(eye *e) {
  problem p;
  const int64_t now_ns = fly_now_ns();
  if (e->device.file >= 0 || now_ns - e->tried_ns < REOPEN_NS) return;
  e->tried_ns = now_ns;
  if (!device_open(&e->device, &p)) return;
  e->heard_ns = now_ns;
  dprintf(STDERR_FILENO, "vista-fly: %s: back\n", e->device.name);
}

static void look(source *s, eye *e) {
  int64_t older = 0;
  uint8_t *const right = e->device.both ? e->picture + s->box->pixels : NULL;
  if (e->device.file < 0) return;
  const device_news news = device_take(&e->device, e->picture, right, &e->taken_ns, &older);
  const int64_t now_ns = fly_now_ns();
  if (news == DEVICE_PICTURE || news == DEVICE_DAMAGED) {
    atomic_fetch_add(&s->skipped, older + e->has_picture); /* one that waited for the other camera gives way */
    e->has_picture = news == DEVICE_PICTURE;
  }
  if (news == DEVICE_PICTURE) e->heard_ns = now_ns;
  if (news == DEVICE_LOST || now_ns - e->heard_ns > SILENT_NS) lose(e);
}

/* Hands over the pictures if they belong together, else drops the older one. */
static void pair(source *s, int64_t *index) {
  cameras *const c = s->own;
  eye *const left = &c->eyes[0], *const right = &c->eyes[c->count - 1];
  if (!left->has_picture || !right->has_picture) return;
  const int64_t apart_ns = left->taken_ns - right->taken_ns;
  if (llabs(apart_ns) > c->tolerance_ns) {
    (apart_ns < 0 ? left : right)->has_picture = false;
    atomic_fetch_add(&s->skipped, 1);
    return;
  }
  const size_t pixels = (size_t)s->box->pixels;
  shot *const to = mailbox_blank(s->box);
  to->t_ns = to->exposed_ns = right->taken_ns + apart_ns / 2;
  to->index = (*index)++;
  to->continues = true;
  to->has_pose = to->has_up = false;
  memcpy(to->left, left->picture, pixels);
  memcpy(to->right, right->picture + (c->count == 1 ? pixels : 0), pixels);
  left->has_picture = right->has_picture = false;
  mailbox_put(s->box);
}

static bool run(source *s) {
  cameras *const c = s->own;
  int64_t index = 0;
  while (!atomic_load(&s->stopped)) {
    struct pollfd ready[2];
    for (int k = 0; k < c->count; ++k) {
      open_again(&c->eyes[k]);
      ready[k] = (struct pollfd){c->eyes[k].device.file, POLLIN, 0};
    }
    (void)poll(ready, (nfds_t)c->count, POLL_MS);
    atomic_store(&s->alive_ns, fly_now_ns());
    for (int k = 0; k < c->count; ++k) look(s, &c->eyes[k]);
    pair(s, &index);
  }
  return true;
}

static void close_cameras(source *s) {
  cameras *const c = s->own;
  for (int k = 0; c != NULL && k < c->count; ++k) {
    device_close(&c->eyes[k].device);
    free(c->eyes[k].device.scratch);
    free(c->eyes[k].picture);
  }
  free(c);
}

static bool open_eye(eye *e, const char *name, bool both, const source *s, problem *p) {
  const int32_t width_px = (both ? 2 : 1) * s->width_px;
  const size_t scratch_bytes = jpeg_scratch_bytes(width_px);
  *e = (eye){.device = {.name = name, .file = -1, .both = both}};
  e->device.width_px = s->width_px;
  e->device.height_px = s->height_px;
  e->picture = malloc(2 * (size_t)s->width_px * (size_t)s->height_px);
  if (scratch_bytes > 0) e->device.scratch = malloc(scratch_bytes);
  e->device.scratch_bytes = scratch_bytes;
  const bool enough = e->picture != NULL && (scratch_bytes == 0 || e->device.scratch != NULL);
  if (!enough) (void)problem_say(p, name, "out of memory");
  if (enough && device_open(&e->device, p)) {
    e->heard_ns = fly_now_ns();
    return true;
  }
  free(e->device.scratch);
  free(e->picture);
  return false;
}

bool source_open_cameras(source *s, const char *const *devices, int count, int64_t tolerance_ns, problem *p) {
  static const source_kind kind = {run, close_cameras};
  cameras *const c = calloc(1, sizeof *c);
  if (c == NULL) return problem_say(p, devices[0], "out of memory");
  s->kind = &kind;
  s->own = c;
  c->tolerance_ns = tolerance_ns;
  for (; c->count < count; ++c->count)
    if (!open_eye(&c->eyes[c->count], devices[c->count], count == 1, s, p)) return false;
  return true;
}
