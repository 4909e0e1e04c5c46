#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/types.h>

#include "clock.h"
#include "source.h"

#define MAGIC "VISTAFRM"
#define VERSION 1
#define BETWEEN_PASSES_NS FLY_SECOND

typedef struct frames_head {
  char magic[8];
  uint32_t version, width_px, height_px, has_up;
  double up_world[3];
} frames_head;

typedef struct frame_head {
  int64_t t_ns;
  uint32_t index, has_pose;
  vista_pose pose;
} frame_head;

typedef struct recording {
  const char *path;
  FILE *stream;
  frames_head head;
  int64_t count;
  bool repeat;
  char buffer[1 << 16]; /* of the stream, which would take its own from the heap */
} recording;

static bool is_finite(const double *numbers, int count) {
  for (int k = 0; k < count; ++k)
    if (!isfinite(numbers[k])) return false;
  return true;
}

static bool count_frames(recording *r, const char *path, problem *p) {
  const off_t frame_bytes = (off_t)sizeof(frame_head) + 2 * (off_t)r->head.width_px * (off_t)r->head.height_px;
  if (fseeko(r->stream, 0, SEEK_END) != 0) return problem_errno(p, path, errno);
  const off_t bytes = ftello(r->stream) - (off_t)sizeof(frames_head);
  r->count = (int64_t)(bytes / frame_bytes);
  if (bytes <= 0) return problem_say(p, path, "holds no frame");
  return bytes % frame_bytes == 0 || problem_say(p, path, "cut off in a frame");
}

static bool read_head(recording *r, const source *s, const char *path, problem *p) {
  if (fread(&r->head, sizeof r->head, 1, r->stream) != 1 || memcmp(r->head.magic, MAGIC, sizeof r->head.magic) != 0)
    return problem_say(p, path, "no frames of vista prepare");
  if (r->head.version != VERSION) return problem_say(p, path, "made by another version of vista: prepare it again");
  if (r->head.width_px != (uint32_t)s->width_px || r->head.height_px != (uint32_t)s->height_px)
    return problem_say(p, path, "images are %ux%u, the rig says %dx%d", r->head.width_px, r->head.height_px,
                       s->width_px, s->height_px);
  return count_frames(r, path, p);
}

static bool read_frame(source *s, frame_head *head, shot *to) {
  recording *const r = s->own;
  if (fread(head, sizeof *head, 1, r->stream) != 1 || fread(to->left, (size_t)s->box->pixels, 1, r->stream) != 1 ||
      fread(to->right, (size_t)s->box->pixels, 1, r->stream) != 1)
    return problem_say(&s->problem, r->path, "cannot be read to its end");
  if (head->has_pose && !is_finite(head->pose.rotation, 12)) /* with the translation behind it */
    return problem_say(&s->problem, r->path, "a pose is not finite");
  to->index = head->index;
  to->has_pose = head->has_pose != 0;
  to->pose = head->pose;
  to->has_up = r->head.has_up != 0;
  memcpy(to->up_world, r->head.up_world, sizeof to->up_world);
  return true;
}

/* One pass over the file. *start_ns: when the first frame is due; *first_ns: its time plus what earlier passes took. */
static bool play(source *s, int64_t start_ns, int64_t later_ns, int64_t *first_ns, int64_t *last_ns) {
  recording *const r = s->own;
  if (fseeko(r->stream, (off_t)sizeof(frames_head), SEEK_SET) != 0) return problem_errno(&s->problem, r->path, errno);
  for (int64_t k = 0; k < r->count && !atomic_load(&s->stopped); ++k) {
    frame_head head;
    shot *const to = mailbox_blank(s->box);
    if (!read_frame(s, &head, to)) return false;
    if (k == 0) *first_ns = head.t_ns;
    *last_ns = head.t_ns;
    const int64_t due_ns = start_ns + (head.t_ns - *first_ns);
    if (!s->box->patient && !fly_sleep_until(due_ns, &s->stopped)) return true;
    to->t_ns = head.t_ns + later_ns;
    to->exposed_ns = s->box->patient ? fly_now_ns() : due_ns;
    to->continues = k > 0;
    atomic_store(&s->alive_ns, fly_now_ns());
    mailbox_put(s->box);
  }
  return true;
}

static bool run(source *s) {
  const recording *const r = s->own;
  int64_t start_ns = fly_now_ns() + 10 * FLY_MS, later_ns = 0;
  do {
    int64_t first_ns = 0, last_ns = 0;
    if (!play(s, start_ns, later_ns, &first_ns, &last_ns)) return false;
    const int64_t pass_ns = last_ns - first_ns + BETWEEN_PASSES_NS;
    start_ns += pass_ns;
    later_ns += pass_ns;
  } while (r->repeat && !atomic_load(&s->stopped));
  return true;
}

static void close_recording(source *s) {
  recording *const r = s->own;
  if (r != NULL && r->stream != NULL) (void)fclose(r->stream);
  free(r);
}

bool source_open_recording(source *s, const char *path, bool repeat, problem *p) {
  static const source_kind kind = {run, close_recording};
  recording *const r = calloc(1, sizeof *r);
  if (r == NULL) return problem_say(p, path, "out of memory");
  s->kind = &kind;
  s->own = r;
  s->has_poses = true;
  r->path = path;
  r->repeat = repeat;
  r->stream = fopen(path, "rb");
  if (r->stream == NULL) return problem_errno(p, path, errno);
  (void)setvbuf(r->stream, r->buffer, _IOFBF, sizeof r->buffer);
  return read_head(r, s, path, p);
}
