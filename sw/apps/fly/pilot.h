/* Flies to a goal: a decision of the planner for each frame, which the autopilot's link sends as setpoints.
 *
 * The pilot takes over by the mode of the autopilot, and gives back by any other mode. Until then setpoints lead on from
 * where the vehicle is, since PX4 enters its mode only if they come; the leg begins where it is taken over. */
#ifndef VISTA_FLY_PILOT_H
#define VISTA_FLY_PILOT_H

#include "autopilot.h"
#include "vista/plan.h"

typedef struct pilot {
  vista_planner planner;
  vista_plan_goal goal;
  vista_plan_decision decision; /* the last one, */
  int64_t state_ns;             /* and the time of its state on our clock; 0: none */
  bool follows;                 /* the autopilot flies it */
  vista_latency took;           /* a decision */
  int64_t taken_over, actions[VISTA_PLAN_ACTION_COUNT]; /* how often */
} pilot;

/* goal_m: in NED. */
bool pilot_open(pilot *p, const vista_parameters *parameters, const double goal_m[3], double speed_m_s,
                problem *problem);

/* Decides after a frame was judged, of which the source says t_ns and our clock exposed_ns. Without a motion of the
 * vehicle no decision is made, and the one before is flown on. */
void pilot_decide(pilot *p, autopilot *a, const vista_detector *detector, int64_t t_ns, int64_t exposed_ns);

/* What it did, on stderr. */
void pilot_print(const pilot *p);

#endif
