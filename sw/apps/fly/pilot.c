#include "pilot.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "clock.h"

bool pilot_open(pilot *p, const vista_parameters *parameters, const double goal_m[3], double speed_m_s,
                problem *problem) {
  const vista_status status = vista_planner_start(&p->planner, parameters);
  memcpy(p->goal.to_m, goal_m, sizeof p->goal.to_m);
  p->goal.speed_m_s = speed_m_s;
  return status == VISTA_OK || problem_say(problem, "plan", "%s", vista_status_text(status));
}

/* A leg begins where the vehicle is when it is taken over. */
static void take_over(pilot *p, bool follows, const double position_m[3]) {
  if (follows && p->follows) return;
  p->taken_over += follows;
  p->follows = follows;
  vista_planner_reset(&p->planner);
  memcpy(p->goal.from_m, position_m, sizeof p->goal.from_m);
  p->state_ns = 0;
}

/* The acceleration is the one that was asked for: the autopilot says none. */
static vista_plan_state state_of(const pilot *p, const vista_vehicle_motion *motion, int64_t t_ns, int64_t now_ns) {
  vista_plan_state state = {.t_ns = t_ns};
  memcpy(state.position_m, motion->pose.translation_m, sizeof state.position_m);
  memcpy(state.velocity_m_s, motion->velocity_m_s, sizeof state.velocity_m_s);
  memcpy(state.up, motion->up_world, sizeof state.up);
  for (int i = 0; i < 3; ++i) state.heading[i] = motion->pose.rotation[3 * i + 2];
  if (p->state_ns == 0) return state;
  vista_plan_setpoint asked;
  vista_plan_at(&p->decision, 1e-9 * (double)(now_ns - p->state_ns), &asked);
  memcpy(state.acceleration_m_s2, asked.acceleration_m_s2, sizeof state.acceleration_m_s2);
  return state;
}

void pilot_decide(pilot *p, autopilot *a, const vista_detector *detector, int64_t t_ns, int64_t exposed_ns) {
  vista_vehicle_motion motion;
  const int64_t now_ns = fly_now_ns();
  const bool follows = autopilot_motion(a, now_ns, &motion);
  if (!motion.pose_known || !motion.velocity_known) return;
  take_over(p, follows, motion.pose.translation_m);
  const vista_plan_state state = state_of(p, &motion, t_ns + now_ns - exposed_ns, now_ns);
  if (vista_planner_decide(&p->planner, detector, &state, &p->goal, &p->decision) != VISTA_OK) return;
  p->state_ns = now_ns;
  ++p->actions[p->decision.action];
  autopilot_fly(a, &p->decision, now_ns);
  vista_latency_add(&p->took, 1e-6 * (double)(fly_now_ns() - now_ns));
}

void pilot_print(const pilot *p) {
  dprintf(STDERR_FILENO,
          "vista-fly: decisions took %.2f ms (p99 %.2f, most %.2f); taken over %" PRId64
          " times\nvista-fly: decisions:",
          vista_latency_percentile_ms(&p->took, 50.0), vista_latency_percentile_ms(&p->took, 99.0), p->took.most_ms,
          p->taken_over);
  for (int k = 0; k < VISTA_PLAN_ACTION_COUNT; ++k)
    dprintf(STDERR_FILENO, "%s %" PRId64 " %s", k > 0 ? "," : "", p->actions[k], vista_plan_action_name(k));
  dprintf(STDERR_FILENO, "\n");
}
