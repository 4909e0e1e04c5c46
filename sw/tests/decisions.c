/* The planner's decisions over a recording, on stdout: for machines other than that of the test.
 *
 *   decisions RECORDING
 *
 * The detector judges each frame, then planners of both vehicles decide, each in its own way: some begin anew with each
 * frame, some follow the camera, some fly what they decided. A decision: int32 status, vista_plan_decision, as the
 * machine has them, which is little endian. Before and after a frame and a decision a system call
 * is made that does not exist, MARK: an emulator may count what lies between (sw/bench/count_instructions.c). Exit status 1
 * when something fails, with a line on stderr. */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "container.h"
#include "vista/detector.h"
#include "vista/plan.h"

#define MARK 4242
#define NEAR_M 15.0 /* a vehicle that flies its own way begins anew when the camera is farther away */

enum { MARK_BEGINS = 0, MARK_JUDGED, MARK_DECIDED };
enum manner { BEGINS_ANEW, FOLLOWS, FLIES };

typedef struct lane {
  enum manner manner;
  double aside, rise, far_m; /* the goal: to the right and up, of the way ahead, and how far that is */
  double speed_m_s;
  bool passed;
  double sigma_m;
} lane;

static const lane lanes[] = {
    {BEGINS_ANEW, 0.0, 0.0, 60.0, 5.0, true, 0.0},   {BEGINS_ANEW, -1.0, 0.1, 60.0, 10.0, true, 0.0},
    {BEGINS_ANEW, 0.4, 0.0, 60.0, 15.0, true, 0.05}, {BEGINS_ANEW, 1.0, -0.1, 0.3, 4.0, false, 0.0},
    {FOLLOWS, 0.0, 0.0, 60.0, 8.0, true, 0.0},       {FOLLOWS, -0.4, 0.0, 25.0, 4.0, false, 0.02},
    {FLIES, 0.0, 0.05, 60.0, 6.0, true, 0.0},        {FLIES, 0.3, 0.0, 25.0, 4.0, false, 0.0},
};
#define LANES ((int)(sizeof lanes / sizeof lanes[0]))

typedef struct vehicle {
  bool began;
  vista_planner planner;
  vista_plan_goal goal;
  vista_plan_state state;
  vista_plan_decision decision;
} vehicle;

typedef struct run {
  container file;
  vista_detector *detector;
  shot shot;
  vehicle vehicles[VISTA_PLAN_VEHICLE_FIXED_WING + 1][LANES];
} run;

static int fail(const char *what, const char *why) {
  fprintf(stderr, "decisions: %s: %s\n", what, why);
  return 1;
}

static void mark(int which) { (void)syscall(MARK, which); }

static bool judge(run *r, vista_detector_result *found) {
  const shot *const s = &r->shot;
  const int32_t width = r->file.rig.camera.width_px, height = r->file.rig.camera.height_px;
  const vista_detector_pair pair = {.left = {s->left, width, height, width},
                                    .right = {s->left_alone ? NULL : s->right, width, height, width},
                                    .t_ns = s->t_ns,
                                    .rectified = s->matched};
  vista_disparity_image words[1 + VISTA_COARSER_LEVELS];
  const int16_t *at = s->words;
  for (int32_t level = 0, w = width, h = height; level < r->file.parameters.stereo.levels; ++level) {
    words[level] = (vista_disparity_image){at, w, h, w};
    at += (ptrdiff_t)w * h;
    w = (w + 1) / 2;
    h = (h + 1) / 2;
  }
  const vista_pose pose = s->matched || !s->has_pose ? s->pose : vista_rig_rectified_pose(&r->file.rig, &s->pose);
  const vista_detector_place place = {
      .pose = s->has_pose ? &pose : NULL, .up_world = s->has_up ? s->up_world : NULL, .anew = s->anew};
  vista_novelty novelty;
  mark(MARK_BEGINS);
  vista_status status = vista_detector_take(r->detector, &pair, &novelty);
  if (status == VISTA_OK) status = vista_detector_match(r->detector, s->matched ? words : NULL);
  if (status == VISTA_OK) status = vista_detector_judge(r->detector, &place, found);
  mark(MARK_JUDGED);
  if (status != VISTA_OK) vista_detector_forget(r->detector);
  return status == VISTA_OK;
}

static void set_goal(const lane *l, vehicle *v, const vista_motion *motion) {
  const double *const turn = motion->pose.rotation;
  v->goal = (vista_plan_goal){.speed_m_s = l->speed_m_s, .passed = l->passed};
  for (int i = 0; i < 3; ++i) {
    const double way = turn[3 * i + 2] + l->aside * turn[3 * i] - l->rise * turn[3 * i + 1];
    v->goal.from_m[i] = motion->pose.translation_m[i];
    v->goal.to_m[i] = v->goal.from_m[i] + l->far_m * way;
  }
}

static bool is_near(const double a_m[3], const double b_m[3]) {
  double apart2 = 0.0;
  for (int i = 0; i < 3; ++i) apart2 += (a_m[i] - b_m[i]) * (a_m[i] - b_m[i]);
  return apart2 < NEAR_M * NEAR_M;
}

/* Where the vehicle is: with the camera, or where it has flown by itself. */
static void set_state(const lane *l, vehicle *v, const vista_motion *motion, const double up[3], int64_t t_ns) {
  const vista_plan_state before = v->state;
  vista_plan_state *const state = &v->state;
  *state = (vista_plan_state){.t_ns = t_ns, .position_sigma_m = l->sigma_m};
  memcpy(state->up, up, sizeof state->up);
  memcpy(state->position_m, motion->pose.translation_m, sizeof state->position_m);
  for (int i = 0; i < 3; ++i) state->heading[i] = motion->pose.rotation[3 * i + 2];
  for (int i = 0; i < 3; ++i)
    state->velocity_m_s[i] = l->manner == FOLLOWS ? motion->velocity_m_s[i] : l->speed_m_s * state->heading[i];
  if (l->manner == FLIES && v->began && t_ns > before.t_ns) {
    vista_plan_setpoint now;
    vista_plan_at(&v->decision, 1e-9 * (double)(t_ns - before.t_ns), &now);
    if (is_near(now.position_m, state->position_m)) {
      memcpy(state->position_m, now.position_m, sizeof state->position_m);
      memcpy(state->velocity_m_s, now.velocity_m_s, sizeof state->velocity_m_s);
      memcpy(state->acceleration_m_s2, now.acceleration_m_s2, sizeof state->acceleration_m_s2);
      memcpy(state->heading, now.heading, sizeof state->heading);
      return;
    }
  }
  if (l->manner == FOLLOWS && v->began) return;
  vista_planner_reset(&v->planner);
  set_goal(l, v, motion);
}

static bool decide(run *r, const lane *l, vehicle *v, const vista_motion *motion) {
  static const double down_rows[3] = {0.0, -1.0, 0.0};
  set_state(l, v, motion, r->shot.has_up ? r->shot.up_world : down_rows, r->shot.t_ns);
  memset(&v->decision, 0, sizeof v->decision);
  mark(MARK_BEGINS);
  const int32_t status = vista_planner_decide(&v->planner, r->detector, &v->state, &v->goal, &v->decision);
  mark(MARK_DECIDED);
  v->began = status == VISTA_OK;
  return fwrite(&status, sizeof status, 1, stdout) == 1 && fwrite(&v->decision, sizeof v->decision, 1, stdout) == 1;
}

static bool open_all(run *r, const char *path, problem *p) {
  if (!container_open(&r->file, path, p)) return false;
  const size_t pixels = r->file.pixels;
  r->shot.left = malloc(pixels);
  r->shot.right = malloc(pixels);
  r->shot.words = malloc((r->file.words + 1) * sizeof *r->shot.words);
  const vista_detector_options options = {.every_pair = true, .stills = r->file.stills};
  vista_parameters parameters = r->file.parameters;
  parameters.host.threads = 1;
  size_t bytes = 0;
  vista_status status = vista_detector_bytes(&parameters, &r->file.rig, &options, &bytes);
  void *const memory = status == VISTA_OK ? calloc(1, bytes) : NULL;
  if (r->shot.left == NULL || r->shot.right == NULL || r->shot.words == NULL || memory == NULL)
    return problem_say(p, path, "no memory, or no camera");
  status = vista_detector_create(memory, bytes, &parameters, &r->file.rig, &options, &r->detector);
  for (int kind = 0; status == VISTA_OK && kind <= VISTA_PLAN_VEHICLE_FIXED_WING; ++kind) {
    parameters.plan.vehicle = kind;
    for (int k = 0; status == VISTA_OK && k < LANES; ++k)
      status = vista_planner_start(&r->vehicles[kind][k].planner, &parameters);
  }
  return status == VISTA_OK || problem_say(p, path, "%s", vista_status_text(status));
}

static bool play(run *r, problem *p) {
  if (!container_rewind(&r->file, p)) return false;
  for (int64_t k = 0; k < r->file.frames; ++k) {
    vista_detector_result found;
    if (!container_read(&r->file, &r->shot, p)) return false;
    if (!judge(r, &found)) continue;
    const vista_motion motion = found.result.motion;
    for (int kind = 0; kind <= VISTA_PLAN_VEHICLE_FIXED_WING; ++kind)
      for (int lane = 0; lane < LANES; ++lane)
        if (!decide(r, &lanes[lane], &r->vehicles[kind][lane], &motion)) return problem_say(p, "stdout", "is full");
  }
  return true;
}

int main(int count, char **arguments) {
  problem p;
  run *const r = calloc(1, sizeof *r);
  if (count != 2 || r == NULL) return fail("usage", "decisions RECORDING");
  return open_all(r, arguments[1], &p) && play(r, &p) ? 0 : fail("failed", p.line);
}
