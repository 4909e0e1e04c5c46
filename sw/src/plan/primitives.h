/* The library of manoeuvres: the trajectory of each, from the state of the vehicle and within its limits.
 *
 * A multirotor is a point that is led to a wanted velocity: with a first order of VELOCITY_S, an acceleration that is
 * limited, and a limited jerk, which stands for the time that it takes to lean. So a new direction is an arc, a lower
 * speed slows down, and the wanted velocity of zero stops. After VISTA_PLAN_COMMIT_S each manoeuvre ends in that. On its
 * way, and where it stands, it sways to both sides of where it looks, by a tenth of a metre: so it leans, and a level wire,
 * which has no disparity while it lies along the rows of the image, crosses them. The sway's 2 m/s^2 and 9 m/s^3 come on
 * top of the limits; it dies out before the end.
 *
 * A fixed wing flies coordinated turns at its speed, with a limited roll rate and bank. Its escape is a climbing turn back
 * to where it came from, and a level circle from there on: most of the turn is out of view, and what stands on the ground
 * may end below it. */
#ifndef VISTA_PLAN_PRIMITIVES_H
#define VISTA_PLAN_PRIMITIVES_H

#include <stdbool.h>

#include "vista/plan.h"

#define VISTA_PLAN_COMMIT_S 0.4 /* that a manoeuvre is flown before its escape begins: some missing frames */
#define VISTA_PLAN_AHEAD_S 0.1  /* from the state to the setpoint of a decision */

/* The distance that a multirotor of this speed needs to stop, the time for leaning included. */
double vista_plan_stop_m(const vista_plan_params *params, double speed_m_s);

/* Who looks at a trajectory while it comes to be, since most are ruled out by their first points: `visit` is called after
 * each point but the first, and stops it with false. ends: it is the last point. */
typedef struct vista_plan_visitor {
  bool (*visit)(void *context, bool ends);
  void *context;
} vista_plan_visitor;

/* Fills the points of *plan in from the state on, with escape_s, step_s and circle_from: a multirotor is led to this
 * velocity, and then to a stop. sways: it sways to both sides, and what the sway at this time adds to position and
 * velocity is taken to be in those of the state. The headings are that of the state. visitor: null where there is none.
 * False: it does not come to an end within the points, or the visitor stopped it. */
bool vista_plan_multirotor(const vista_plan_params *params, const vista_plan_state *state, const double velocity_m_s[3],
                           bool sways, const vista_plan_visitor *visitor, vista_plan_decision *plan);

/* The same of a fixed wing: it turns to a level direction of unit length and climbs at this rate, and then turns back
 * to the left (side 1) or to the right (-1), at its greatest bank and climb, and on into a level circle. At once: the escape
 * alone. The headings are those of its flight. */
typedef struct vista_plan_turning {
  double level[3], climb_m_s;
  int32_t side;
  double commit_s; /* until it turns back */
} vista_plan_turning;

bool vista_plan_fixed_wing(const vista_plan_params *params, const vista_plan_state *state,
                           const vista_plan_turning *turning, const vista_plan_visitor *visitor,
                           vista_plan_decision *plan);

/* Turns the heading of all points towards a level direction of unit length, from that of the state on. */
void vista_plan_turn(const vista_plan_state *state, const double towards[3], vista_plan_decision *plan);

/* The level part of a vector, unit length. False: there is none. */
bool vista_plan_level(const double up[3], const double vector[3], double level[3]);

#endif
