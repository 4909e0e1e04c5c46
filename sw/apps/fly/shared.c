/* Reads the ring with calls of the system instead of mapping it: whatever its writer does to the file, a read fails or
 * gives bytes, and nothing crashes. */
#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdatomic.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "clock.h"
#include "source.h"
#include "vista/shared_frames.h"

#define POLL_NS FLY_MS
#define LOOK_NS (200 * FLY_MS) /* without a frame for so long: is it still the same ring? */
#define OLDEST_NS (10 * FLY_SECOND) /* an exposure further back is none of this clock */
#define NAME_BYTES 64

typedef struct shared {
  char path[96];
  int file; /* -1: there is no ring */
  ino_t inode;
  dev_t device;
  vista_shared_head head;
  uint32_t last; /* number of the frame that was read last */
  bool begins; /* the next frame is the first of this ring */
  int64_t looked_ns;
} shared;

static bool read_at(const shared *r, size_t at, void *to, size_t bytes) {
  return pread(r->file, to, bytes, (off_t)at) == (ssize_t)bytes;
}

static void leave(shared *r) {
  if (r->file >= 0) (void)close(r->file);
  r->file = -1;
}

/* Opens the ring of that name. False: there is none, or it is not finished or not of these images; *whose says that. */
static bool join(shared *r, const source *s, bool *other_size) {
  struct stat status;
  *other_size = false;
  r->file = open(r->path, O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
  if (r->file < 0) return false;
  const size_t pixels = 2 * (size_t)s->width_px * (size_t)s->height_px;
  if (fstat(r->file, &status) == 0 && S_ISREG(status.st_mode) && read_at(r, 0, &r->head, sizeof r->head) &&
      memcmp(r->head.magic, "VISTASHM", sizeof r->head.magic) == 0 && r->head.version == VISTA_SHARED_VERSION) {
    *other_size = r->head.width_px != (uint32_t)s->width_px || r->head.height_px != (uint32_t)s->height_px ||
                  r->head.slot_bytes < VISTA_SHARED_PIXELS + pixels;
    if (!*other_size) {
      r->inode = status.st_ino;
      r->device = status.st_dev;
      r->last = 0;
      r->begins = true;
      return true;
    }
  }
  leave(r);
  return false;
}

/* Whether the name still stands for the ring that is open. */
static bool is_current(const shared *r) {
  struct stat status;
  return stat(r->path, &status) == 0 && status.st_ino == r->inode && status.st_dev == r->device;
}

static bool is_usable(const vista_shared_frame *about) {
  const double *const numbers = about->pose.rotation; /* with the translation behind it */
  for (int k = 0; k < 12 && about->has_pose; ++k)
    if (!isfinite(numbers[k])) return false;
  for (int k = 0; k < 3 && about->has_up; ++k)
    if (!isfinite(about->up_world[k])) return false;
  return about->t_ns >= 0;
}

/* Reads the newest frame, if it was not read yet. */
static bool take(source *s, shot *to) {
  shared *const r = s->own;
  uint32_t newest = 0, after = 0;
  vista_shared_frame about;
  if (!read_at(r, offsetof(vista_shared_head, newest), &newest, sizeof newest) || newest == 0 || newest == r->last)
    return false;
  atomic_thread_fence(memory_order_seq_cst);
  const size_t slot = sizeof r->head + newest % VISTA_SHARED_SLOTS * (size_t)r->head.slot_bytes;
  const size_t pixels = (size_t)s->box->pixels;
  if (!read_at(r, slot, &about, sizeof about) || !read_at(r, slot + VISTA_SHARED_PIXELS, to->left, pixels) ||
      !read_at(r, slot + VISTA_SHARED_PIXELS + pixels, to->right, pixels))
    return false;
  atomic_thread_fence(memory_order_seq_cst);
  if (!read_at(r, slot, &after, sizeof after) || about.number != newest || after != newest) return false;
  if (r->last != 0 && newest > r->last + 1) atomic_fetch_add(&s->skipped, newest - r->last - 1);
  r->last = newest;
  if (!is_usable(&about)) return atomic_fetch_add(&s->skipped, 1), false;
  const int64_t now_ns = fly_now_ns();
  const bool timed = about.exposed_ns <= now_ns && about.exposed_ns >= now_ns - OLDEST_NS;
  to->t_ns = about.t_ns;
  to->exposed_ns = timed ? about.exposed_ns : now_ns;
  to->continues = !r->begins && !about.begins;
  to->has_pose = about.has_pose != 0;
  to->has_up = about.has_up != 0;
  to->pose = about.pose;
  memcpy(to->up_world, about.up_world, sizeof to->up_world);
  r->begins = false;
  return true;
}

/* Follows the name, when no frame came for a while. */
static void look(source *s) {
  shared *const r = s->own;
  const int64_t now_ns = fly_now_ns();
  if (now_ns - r->looked_ns < LOOK_NS) return;
  r->looked_ns = now_ns;
  if (r->file >= 0 && is_current(r)) return;
  if (r->file >= 0) dprintf(STDERR_FILENO, "vista-fly: %s: gone; waiting for it\n", r->path);
  leave(r);
  bool other_size;
  if (join(r, s, &other_size)) dprintf(STDERR_FILENO, "vista-fly: %s: there\n", r->path);
}

static bool run(source *s) {
  shared *const r = s->own;
  int64_t index = 0;
  while (fly_sleep_until(fly_now_ns() + POLL_NS, &s->stopped)) {
    atomic_store(&s->alive_ns, fly_now_ns());
    shot *const to = mailbox_blank(s->box);
    if (r->file < 0 || !take(s, to)) {
      look(s);
      continue;
    }
    r->looked_ns = fly_now_ns();
    to->index = index++;
    mailbox_put(s->box);
  }
  return true;
}

static void close_shared(source *s) {
  if (s->own != NULL) leave(s->own);
  free(s->own);
}

bool source_open_shared(source *s, const char *name, problem *p) {
  static const source_kind kind = {run, close_shared};
  if (name[0] == '\0' || name[0] == '.' || strlen(name) > NAME_BYTES || strchr(name, '/') != NULL)
    return problem_say(p, "--shared", "is no name of shared memory: %s", name);
  shared *const r = calloc(1, sizeof *r);
  if (r == NULL) return problem_say(p, name, "out of memory");
  s->kind = &kind;
  s->own = r;
  s->has_poses = true;
  (void)snprintf(r->path, sizeof r->path, "/dev/shm/%s", name);
  bool other_size;
  if (!join(r, s, &other_size) && other_size)
    return problem_say(p, r->path, "images are %ux%u, the rig says %dx%d", r->head.width_px, r->head.height_px,
                       s->width_px, s->height_px);
  if (r->file < 0) dprintf(STDERR_FILENO, "vista-fly: %s: waiting for it\n", r->path);
  return true;
}
