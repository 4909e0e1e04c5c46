#include "flight.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <time.h>
#include <unistd.h>

#include "clock.h"
#include "vista/frontend.h"

#define TAKE_NS (100 * FLY_MS)
#define BOARD_MS 1000.0 /* that a board may be silent, and less than the guard waits for it */
#define LARGE_PAGE_BYTES ((size_t)1 << 21)

static bool open_source(flight *f, problem *p) {
  const options *const o = &f->options;
  source *const s = &f->source;
  s->box = &f->box;
  s->width_px = f->file.rig.camera.width_px;
  s->height_px = f->file.rig.camera.height_px;
  const size_t words = o->board != NULL ? container_words_of_pair(&f->file) : f->file.words;
  if (!mailbox_make(&f->box, s->width_px * s->height_px, words, o->all_frames))
    return problem_say(p, "rig", "out of memory");
  if (o->recording != NULL) {
    const int64_t passes = o->passes > 0.0 ? (int64_t)o->passes : 1;
    return source_open_recording(s, &f->file, o->repeat ? 0 : passes, (int64_t)o->frames, p) &&
           (o->times == NULL || times_make(&f->times, passes * f->file.frames, p));
  }
  if (o->shared != NULL) return source_open_shared(s, o->shared, p);
  if (o->board != NULL)
    return source_open_board(s, o->board, &f->file, (int32_t)fmin(BOARD_MS, o->watchdog_s * BOARD_MS / 3.0), p);
  return source_open_cameras(s, o->camera, o->camera_count, (int64_t)(o->pair_tolerance_ms * FLY_MS), p);
}

/* Makes the detector on large pages, which are there before the first frame. */
static bool open_detector(flight *f, problem *p) {
  const vista_detector_options options = {.every_pair = f->options.all_frames, .stills = f->file.stills};
  size_t bytes = 0;
  vista_status status = vista_detector_bytes(&f->file.parameters, &f->file.rig, &options, &bytes);
  if (status != VISTA_OK) return problem_say(p, "rig", "%s", vista_status_text(status));
  const size_t all = (bytes + LARGE_PAGE_BYTES - 1) / LARGE_PAGE_BYTES * LARGE_PAGE_BYTES;
  f->memory = aligned_alloc(LARGE_PAGE_BYTES, all);
  if (f->memory == NULL) return problem_say(p, "rig", "out of memory");
#if defined(MADV_HUGEPAGE)
  (void)madvise(f->memory, all, MADV_HUGEPAGE); /* without them it works, too */
#endif
  memset(f->memory, 0, all);
  status = vista_detector_create(f->memory, all, &f->file.parameters, &f->file.rig, &options, &f->detector);
  return status == VISTA_OK || problem_say(p, "rig", "%s", vista_status_text(status));
}

bool flight_open(flight *f, const options *o, problem *p) {
  f->options = *o;
  f->lines.file = f->autopilot.way.file = -1;
  if (!container_open(&f->file, o->recording != NULL ? o->recording : o->rig, p)) return false;
  if (o->threads > 0.0) f->file.parameters.host.threads = (int32_t)o->threads;
  if (!open_detector(f, p) || !open_source(f, p)) return false;
  if (o->to != NULL && !autopilot_open(&f->autopilot, o->to, o->listen_port, (int64_t)(o->pose_delay_ms * FLY_MS),
                                       &f->file.parameters.mavlink, p))
    return false;
  if (o->has_goal && !pilot_open(&f->pilot, &f->file.parameters, o->goal_m, o->speed_m_s, p)) return false;
  return lines_open(&f->lines, o->out, p);
}

/* ---- the thread of the source ---- */

static void *read_frames(void *context) {
  source *const s = context;
  (void)s->kind->run(s);
  atomic_store(&s->alive_ns, INT64_MAX); /* it has ended, and stands still for good */
  mailbox_close(s->box);
  return NULL;
}

/* ---- the loop ---- */

/* Whether a frame is to be judged: not one that repeats what was seen before. */
static vista_status take(flight *f, const shot *s, bool *judged) {
  const int32_t width = f->source.width_px, height = f->source.height_px;
  const vista_image none = {0}, left = {s->left, width, height, width}, right = {s->right, width, height, width};
  const vista_detector_pair pair = {.left = s->words_alone ? none : left,
                                    .right = s->words_alone || s->left_alone ? none : right,
                                    .t_ns = s->t_ns,
                                    .rectified = s->matched,
                                    .restarts = !s->continues};
  vista_novelty novelty = VISTA_PAIR_NEW;
  const vista_status status = vista_detector_take(f->detector, &pair, &novelty);
  f->restarts += novelty == VISTA_PAIR_RESTARTED;
  f->duplicates += novelty == VISTA_PAIR_REPEATED;
  *judged = novelty != VISTA_PAIR_REPEATED;
  return status;
}

static placement place_of(flight *f, const shot *s) {
  placement where = {.has_pose = s->has_pose, .has_up = s->has_up};
  if (f->options.poses_from_mavlink) {
    autopilot_place(&f->autopilot, s->exposed_ns, f->file.parameters.motion.speed_max_m_s, &where);
    return where;
  }
  if (s->has_pose) where.pose = s->matched ? s->pose : vista_rig_rectified_pose(&f->file.rig, &s->pose);
  memcpy(where.up_world, s->up_world, sizeof where.up_world);
  return where;
}

static void say(const problem *p, const char *more) { dprintf(STDERR_FILENO, "vista-fly: %s%s\n", p->line, more); }

/* Matches with the engine in C, or takes the words that a recording holds or a board sent. */
static vista_status match(flight *f, const shot *s) {
  vista_disparity_image words[1 + VISTA_COARSER_LEVELS];
  const int16_t *at = s->words;
  int32_t width = f->source.width_px, height = f->source.height_px;
  if (!s->matched && !s->words_alone) return vista_detector_match(f->detector, NULL);
  for (int32_t level = 0; level < f->file.parameters.stereo.levels; ++level) {
    words[level] = (vista_disparity_image){at, width, height, width};
    at += (ptrdiff_t)width * height;
    width = vista_frontend_reduced_px(width);
    height = vista_frontend_reduced_px(height);
  }
  return vista_detector_match(f->detector, words);
}

/* The pose may arrive while the pair is matched. */
static vista_status judge(flight *f, const shot *s, vista_detector_result *found) {
  const vista_status status = match(f, s);
  if (status != VISTA_OK) return status;
  const placement where = place_of(f, s);
  const vista_detector_place place = {.pose = where.has_pose ? &where.pose : NULL,
                                      .up_world = where.has_up ? where.up_world : NULL,
                                      .velocity_m_s = where.has_velocity ? where.velocity_m_s : NULL,
                                      .anew = s->anew};
  return vista_detector_judge(f->detector, &place, found);
}

/* A frame that the detector refuses, as one with an impossible pose, ends the tracks and not the flight. */
static bool detect(flight *f, const shot *s, vista_detector_result *found) {
  bool judged = false;
  vista_status status = take(f, s, &judged);
  if (status == VISTA_OK && judged) status = judge(f, s, found);
  if (status == VISTA_OK) return judged;
  problem p;
  (void)problem_say(&p, "frame", "%s", vista_status_text(status));
  if (f->refused++ == 0) say(&p, "; tracks are forgotten and the flight goes on");
  vista_detector_forget(f->detector);
  return false;
}

static void write_line(flight *f, const shot *s, const vista_detector_result *found) {
  size_t bytes = 0;
  problem p;
  if (f->lines.file < 0) return;
  if (vista_detector_write_line(found, s->index, s->t_ns, false, f->line, sizeof f->line, &bytes) != VISTA_OK) return;
  if (!lines_write(&f->lines, f->line, bytes, &p)) say(&p, "; the flight goes on without it");
}

/* What the program has taken of the processors, without the thread of the source, whose time ends with it. */
static double processor_ms(flight *f) {
  struct timespec all = {0}, own;
  clockid_t reader;
  if (f->times.rows == NULL) return 0.0;
  if (pthread_getcpuclockid(f->reader, &reader) == 0 && clock_gettime(reader, &own) == 0) f->reader_time = own;
  (void)clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &all);
  return 1e3 * (double)(all.tv_sec - f->reader_time.tv_sec) + 1e-6 * (double)(all.tv_nsec - f->reader_time.tv_nsec);
}

static void process(flight *f, const shot *s) {
  vista_detector_result found;
  const double start_ms = processor_ms(f);
  if (!detect(f, s, &found)) return;
  const double cpu_ms = processor_ms(f) - start_ms;
  f->aligned = found.alignment;
  f->alignments += found.alignment.changed;
  if (f->options.to != NULL) autopilot_tell(&f->autopilot, &found, s->exposed_ns);
  if (f->options.has_goal) pilot_decide(&f->pilot, &f->autopilot, f->detector, s->t_ns, s->exposed_ns);
  write_line(f, s, &found);
  ++f->processed;
  const double latency_ms = 1e-6 * (double)(fly_now_ns() - s->exposed_ns);
  vista_latency_add(&f->latency, latency_ms);
  if (f->times.rows != NULL) times_add(&f->times, &found, cpu_ms, latency_ms);
}

static void watch(flight *f) {
  const int64_t now_ns = fly_now_ns();
  atomic_store(&f->alive_ns, now_ns);
  atomic_store(&f->source.alive_ns, now_ns);
  guard_open(&f->guard, (int64_t)(f->options.watchdog_s * FLY_SECOND));
  guard_watch(&f->guard, "detection", &f->alive_ns);
  if (!f->options.all_frames) guard_watch(&f->guard, "the source", &f->source.alive_ns);
  if (f->options.to != NULL) guard_watch(&f->guard, "the autopilot's link", &f->autopilot.alive_ns);
}

bool flight_run(flight *f, const atomic_bool *interrupted, problem *p) {
  if (f->options.to != NULL && !autopilot_start(&f->autopilot, p)) return false;
  watch(f);
  if (!guard_start(&f->guard, p)) return false;
  if (pthread_create(&f->reader, NULL, read_frames, &f->source) != 0)
    return problem_say(p, "system", "gives no thread");
  while (!atomic_load(interrupted) && !mailbox_ended(&f->box)) {
    const shot *const s = mailbox_take(&f->box, TAKE_NS);
    atomic_store(&f->alive_ns, fly_now_ns());
    if (s != NULL) process(f, s);
  }
  atomic_store(&f->source.stopped, true);
  mailbox_close(&f->box);
  (void)pthread_join(f->reader, NULL); /* the guard ends the program if it hangs */
  if (f->options.to != NULL) autopilot_stop(&f->autopilot);
  guard_close(&f->guard);
  *p = f->source.problem;
  if (p->line[0] != '\0') return false;
  return f->times.rows == NULL || times_write(&f->times, f->options.times, p);
}

void flight_close(flight *f) {
  if (f->options.to != NULL) autopilot_close(&f->autopilot);
  lines_close(&f->lines);
  if (f->source.kind != NULL) f->source.kind->close(&f->source);
  mailbox_free(&f->box);
  vista_detector_destroy(f->detector);
  free(f->memory);
  times_free(&f->times);
  container_close(&f->file);
}

static void print_latency(const char *what, const char *of, const vista_latency *l) {
  dprintf(STDERR_FILENO, "%s: %s %.1f ms (p99 %.1f, most %.1f)", what, of, vista_latency_percentile_ms(l, 50.0),
          vista_latency_percentile_ms(l, 99.0), l->most_ms);
}

static void print_alignment(const flight *f) {
  const vista_turn *const turn = &f->aligned.correction;
  if (f->file.parameters.alignment.correct != VISTA_ALIGNMENT_CORRECT_ON) return;
  dprintf(STDERR_FILENO,
          "vista-fly: the right camera corrected by %+.3f degrees in pitch, %+.3f in roll at the end; changed %" PRId64
          " times\n",
          VISTA_DEGREES_PER_RADIAN * turn->pitch_rad, VISTA_DEGREES_PER_RADIAN * turn->roll_rad, f->alignments);
}

void flight_print(flight *f) {
  const int64_t dropped = mailbox_dropped(&f->box) + atomic_load(&f->source.skipped);
  dprintf(STDERR_FILENO,
          "vista-fly: %" PRId64 " frames processed, %" PRId64 " dropped for newer ones, %" PRId64
          " duplicates, %" PRId64 " restarts, %" PRId64 " refused\n",
          f->processed, dropped, f->duplicates, f->restarts, f->refused);
  print_latency("vista-fly", "from the exposure to the result", &f->latency);
  dprintf(STDERR_FILENO, "\n");
  print_alignment(f);
  if (f->options.has_goal) pilot_print(&f->pilot);
  if (f->options.to == NULL) return;
  print_latency(f->options.to, "from the exposure to the message", &f->autopilot.told);
  dprintf(STDERR_FILENO, "; %" PRId64 " messages sent, %" PRId64 " of them lost\n", f->autopilot.sent,
          f->autopilot.way.lost);
}
