/* Lists the manoeuvres that may be flown, and weighs them: the cheapest is asked for first.
 *
 * What a direction costs is time: the way to the goal that begins along it, past all that was seen (plan/way_field.h), and
 * what is lost by the turn to where that way goes on, by flying slower and by the change of velocity. A climb or a descent
 * costs the detour, and a share of what a way costs that ends at something or in what nobody has seen, by how much of the
 * look ahead it leaves. How far a level direction is free, and what ends it, is what the frame says of its columns
 * (vista/directions.h), as wide as the vehicle. */
#ifndef VISTA_PLAN_CHOICE_H
#define VISTA_PLAN_CHOICE_H

#include "plan/space.h"
#include "vista/plan.h"

/* The goal as it is flown to now. */
typedef struct vista_plan_aim {
  double point_m[3];  /* on the leg, ahead; or the goal */
  double level[3];    /* to it, unit length */
  double distance_m;  /* to the goal itself */
  double speed_m_s;   /* at most, so that the vehicle stops at the goal */
  double climb_m_s;   /* that leads to its height */
} vista_plan_aim;

vista_plan_aim vista_plan_aim_at(const vista_planner *planner, const vista_plan_state *state,
                                 const vista_plan_goal *goal);

/* Takes over what the columns of the frame say. */
void vista_plan_take_directions(vista_plan_space *space, const vista_directions *directions);

/* Fills the options of *decision in, the cheapest first. wanted_m_s: the velocity of each of them. */
void vista_plan_list(const vista_planner *planner, vista_plan_space *space, const vista_plan_state *state,
                     const vista_plan_aim *aim, vista_plan_decision *decision);

/* The velocity that an option leads to. */
void vista_plan_velocity(const vista_plan_option *option, double velocity_m_s[3]);

#endif
