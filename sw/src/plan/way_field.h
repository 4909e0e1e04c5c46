/* The field of ways: how long the way to the goal is from each place around the vehicle, past what it has seen.
 *
 * A level grid in the world, which moves with the vehicle, keeps of each cell whether it was seen to be free, whether
 * something ends a direction there, or whether nobody has looked, until the frames show it again. So what is out of view is
 * not forgotten, and a way out of a dead end may lead back to where the vehicle has been. From the goal outwards each cell
 * gets the length of the shortest way (the eikonal equation, by fast sweeping: Zhao, Math. Comp. 74, 2005), where cells
 * near to what stands are longer by a factor, and cells that nobody has seen a little. Beyond the grid the way is
 * straight.
 *
 * It weighs manoeuvres, and never lets one pass: that is asked of the map of space (plan/space.h). */
#ifndef VISTA_PLAN_WAY_FIELD_H
#define VISTA_PLAN_WAY_FIELD_H

#include "plan/space.h"
#include "vista/plan.h"

/* Keeps what the columns of the newest frame show at this height. */
void vista_plan_keep(vista_planner *planner, const vista_plan_space *space, const vista_plan_state *state);

/* Works the ways to a place out. */
void vista_plan_spread(vista_planner *planner, const vista_plan_state *state, const double goal_m[3]);

/* A way to the goal that begins straight. */
typedef struct vista_plan_way {
  double length_m; /* as it is weighed */
  double turn;     /* from where it begins straight to where it goes on: the chord of the angle, 0 to 2 */
} vista_plan_way;

/* The way that begins along a level direction of unit length, for at most this far. */
vista_plan_way vista_plan_way_along(const vista_planner *planner, const double from_m[3], const double level[3],
                                    double most_m);

#endif
