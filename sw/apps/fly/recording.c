#include "clock.h"
#include "container.h"
#include "source.h"

#define BETWEEN_PASSES_NS FLY_SECOND

/* One pass over the file. *start_ns: when the first frame is due; *first_ns: its time plus what earlier passes took. */
static bool play(source *s, int64_t start_ns, int64_t later_ns, int64_t *first_ns, int64_t *last_ns) {
  container *const c = s->own;
  if (!container_rewind(c, &s->problem)) return false;
  const int64_t count = s->frames > 0 && s->frames < c->frames ? s->frames : c->frames;
  for (int64_t k = 0; k < count && !atomic_load(&s->stopped); ++k) {
    shot *const to = mailbox_blank(s->box);
    if (!container_read(c, to, &s->problem)) return false;
    if (k == 0) *first_ns = to->t_ns;
    *last_ns = to->t_ns;
    const int64_t due_ns = start_ns + (to->t_ns - *first_ns);
    if (!s->box->patient && !fly_sleep_until(due_ns, &s->stopped)) return true;
    to->t_ns += later_ns;
    to->exposed_ns = s->box->patient ? fly_now_ns() : due_ns;
    to->continues = k > 0;
    atomic_store(&s->alive_ns, fly_now_ns());
    mailbox_put(s->box);
  }
  return true;
}

static bool run(source *s) {
  int64_t start_ns = fly_now_ns() + 10 * FLY_MS, later_ns = 0;
  for (int64_t pass = 0; (pass < s->passes || s->passes == 0) && !atomic_load(&s->stopped); ++pass) {
    int64_t first_ns = 0, last_ns = 0;
    if (!play(s, start_ns, later_ns, &first_ns, &last_ns)) return false;
    const int64_t pass_ns = last_ns - first_ns + BETWEEN_PASSES_NS;
    start_ns += pass_ns;
    later_ns += pass_ns;
  }
  return true;
}

static void close_recording(source *s) { (void)s; /* the file is the flight's */ }

bool source_open_recording(source *s, container *c, int64_t passes, int64_t frames, problem *p) {
  static const source_kind kind = {run, close_recording};
  s->kind = &kind;
  s->own = c;
  s->has_poses = true;
  s->passes = passes;
  s->frames = frames;
  return c->frames > 0 || problem_say(p, c->path, "holds no frame");
}
