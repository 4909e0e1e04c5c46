/* The planner: from what the detector knows of space, and a goal, to the manoeuvre that is flown next.
 *
 *   vista_planner planner;
 *   vista_planner_start(&planner, &parameters);
 *   for each frame, after vista_detector_judge or vista_detector_process:
 *     vista_plan_state state = {.t_ns = ..., .position_m = ..., .velocity_m_s = ..., .up = ..., .heading = ...};
 *     vista_plan_goal goal = {.from_m = ..., .to_m = ..., .speed_m_s = ...};
 *     vista_plan_decision decision;
 *     vista_planner_decide(&planner, detector, &state, &goal, &decision);
 *   as often as the controller asks, until the next decision:
 *     vista_plan_at(&decision, seconds since state.t_ns, &setpoint);
 *
 * A decision is a whole trajectory: a manoeuvre of a fixed library, flown for 0.4 s (multirotor) or for 0.75 to 3 s
 * (fixed wing), and after it an escape, which ends in a stop (multirotor) or in a circle (fixed wing). It is taken
 * only if all of it, the escape included, lies in space that the last frames have seen to be free, as wide as
 * obstacle_map.collision_radius_m and twice the error of the position. So whoever hears no further decision is safe if
 * he flies on by vista_plan_at. A grid of cubes around the vehicle keeps for some seconds what was seen to be free and
 * where something was matched, for what is out of view or too near to be matched; a level grid keeps what was seen for a
 * minute, and tells the shortest way to the goal, which weighs the manoeuvres.
 * Where no manoeuvre passes, the escape of the decision before is flown. A fixed wing escapes by a climbing turn back
 * and a circle, which lead out of what its camera sees: what no frame has in view, and from 1.5 s ahead on what is
 * hidden, counts as free there unless something is known to be in it (escape_seen).
 *
 * World, metres and poses are those of the detector. What is decided depends on the calls alone, not on a clock. */
#ifndef VISTA_PLAN_H
#define VISTA_PLAN_H

#include <stdbool.h>
#include <stdint.h>

#include "vista/api.h"
#include "vista/detector.h"
#include "vista/parameters.h"
#include "vista/status.h"

VISTA_BEGIN

#define VISTA_PLAN_MOST_POINTS 192  /* of a trajectory, at most */
#define VISTA_PLAN_MOST_OPTIONS 240 /* that are weighed in a decision, at most */
#define VISTA_PLAN_CUBES 32 /* of half a radius, along each side of what is kept of the surroundings */
#define VISTA_PLAN_CUBE_COUNT 32768 /* the third power of that */
#define VISTA_PLAN_STOOD 256 /* places where the vehicle was, which are kept, at most */
#define VISTA_PLAN_GRID 96     /* cells of half a radius along each side of the grid of ways */

/* The vehicle at the time of the decision, not at that of the frame. */
typedef struct vista_plan_state {
  int64_t t_ns; /* on the clock of the frames, not before the last of them */
  double position_m[3]; /* of the vehicle's middle */
  double velocity_m_s[3], acceleration_m_s2[3];
  double up[3]; /* against gravity, unit length */
  double heading[3]; /* where the camera looks, unit length; its level part counts */
  double position_sigma_m; /* standard deviation of the position in the world of the frames, each axis */
} vista_plan_state;

/* A place to fly to. A leg of a mission is kept to beside its line; a point by itself has from_m equal to to_m. */
typedef struct vista_plan_goal {
  double from_m[3], to_m[3];
  double speed_m_s; /* to fly at where nothing is in the way; of a fixed wing, its own speed */
  bool passed; /* the goal is flown through at speed, since another leg follows. Otherwise a multirotor stops there */
} vista_plan_goal;

/* What a decision comes to. */
typedef enum vista_plan_action {
  VISTA_PLAN_PROCEEDS = 0, /* the way that is best where nothing is in the way */
  VISTA_PLAN_EVADES, /* another way, or slower, since something rules the best one out, until that is flown again */
  VISTA_PLAN_ESCAPES, /* no manoeuvre passes: it stops at once, or flies what was committed to, to its escape */
  VISTA_PLAN_HOLDS, /* stands or circles, and turns to where a way may be */
  VISTA_PLAN_ARRIVED, /* at the goal */
  VISTA_PLAN_HELPLESS, /* something is in the way of the escape as well: it is flown, or what is free for longer */
  VISTA_PLAN_ACTION_COUNT
} vista_plan_action;

/* The name of an action, in lower case; never null. */
VISTA_API const char *vista_plan_action_name(vista_plan_action action);

/* The manoeuvres of the library. */
typedef enum vista_plan_primitive {
  VISTA_PLAN_STRAIGHT = 0,
  VISTA_PLAN_ARC, /* level, to another direction */
  VISTA_PLAN_CLIMB,
  VISTA_PLAN_DESCENT,
  VISTA_PLAN_STOP,
  VISTA_PLAN_LOITER, /* a circle: what a fixed wing does in place of a stop */
  VISTA_PLAN_PRIMITIVE_COUNT
} vista_plan_primitive;

/* The name of a manoeuvre, in lower case; never null. */
VISTA_API const char *vista_plan_primitive_name(vista_plan_primitive primitive);

/* What became of an option. */
typedef enum vista_plan_ruling {
  VISTA_PLAN_CHOSEN = 0,
  VISTA_PLAN_NOT_ASKED, /* a better one passes, or as many as are asked in a frame were ruled out */
  VISTA_PLAN_BY_OBSTACLE, /* one of the list, obstacle_id */
  VISTA_PLAN_BY_PLACE, /* something is matched there in the last frames, and no obstacle stands for it */
  VISTA_PLAN_BY_UNKNOWN, /* nobody has seen whether it is free there */
  VISTA_PLAN_BY_VIEW, /* none of the last frames has it in view */
  VISTA_PLAN_BY_DYNAMICS, /* the vehicle cannot fly it */
  VISTA_PLAN_RULING_COUNT
} vista_plan_ruling;

/* The name of a ruling, in lower case; never null. */
VISTA_API const char *vista_plan_ruling_name(vista_plan_ruling ruling);

/* One manoeuvre that was weighed. */
typedef struct vista_plan_option {
  vista_plan_primitive primitive;
  vista_plan_ruling ruling;
  double direction[3]; /* that it leads to, unit length, world; zeros for a stop */
  double speed_m_s;
  double cost_s; /* what it takes to the goal, as it is weighed; less is better */
  double free_m; /* how far its direction is free, as it is weighed, */
  vista_plan_ruling ends; /* and what ends that; VISTA_PLAN_CHOSEN: nothing */
  int32_t obstacle_id; /* that rules it out; 0 also where none does */
  double where_m[3], after_s; /* the place that rules it out, and when it would be there */
} vista_plan_option;

/* What the vehicle is told at a moment. */
typedef struct vista_plan_setpoint {
  double position_m[3], velocity_m_s[3], acceleration_m_s2[3];
  double heading[3]; /* level, unit length */
  double yaw_rate_rad_s; /* about `up`, to the left positive */
} vista_plan_setpoint;

/* A decision. */
typedef struct vista_plan_decision {
  vista_plan_action action;
  int64_t t_ns; /* of the state */
  vista_plan_setpoint setpoint; /* vista_plan_at a tenth of a second after t_ns */
  int32_t chosen; /* the option that is flown; -1: an escape or a stop that was committed to before */
  double escape_s; /* after so long, the escape begins */
  bool escape_seen; /* all of the escape was seen to be free; false: a part of the circle was in no view, or hidden */
  double step_s; /* from one point to the next */
  int32_t point_count, circle_from; /* the points from there on are a circle that is flown on; -1: it ends in a stop */
  vista_plan_setpoint points[VISTA_PLAN_MOST_POINTS]; /* the first one at t_ns */
  int32_t option_count, looks; /* looks: places that were asked for, the last time that any were */
  vista_plan_option options[VISTA_PLAN_MOST_OPTIONS]; /* the cheapest first */
} vista_plan_decision;

/* What the planner keeps of a cell of its grid, level, in the world. */
typedef struct vista_plan_cell {
  int32_t x, y; /* which one it is of those that share this memory */
  float height_m; /* of the vehicle, when it was last seen */
  uint8_t kind; /* 0: never seen, 1: free, 2: something ends a direction there */
  int64_t t_ns;
} vista_plan_cell;

/* What the planner keeps of a cube of its surroundings. */
typedef struct vista_plan_cube {
  int32_t at[3]; /* which one it is of those that share this memory */
  float from_corner_m[3]; /* what was matched in it last, mean */
  int64_t t_ns; /* of the last frame that tells of it; 0: none */
} vista_plan_cube;

/* A place where the vehicle was. */
typedef struct vista_plan_stood {
  double point_m[3];
  int64_t t_ns; /* last; 0: never */
} vista_plan_stood;

/* A planner, in memory of the caller: 1.9 MB, too much for most stacks of threads. Its members are the library's own. */
typedef struct vista_planner {
  vista_plan_params params;
  double radius_m;
  bool began, committed, has_level; /* there was a state; `plan` holds the trajectory that is flown; `level` is set */
  int32_t side; /* of the last circle: -1 to the right, 1 to the left, 0 none */
  int64_t t_ns; /* of the last state */
  double wanted[3]; /* velocity that was decided last; at rest, before that, straight on */
  vista_plan_stood stood[VISTA_PLAN_STOOD];
  int32_t last_stood;
  int64_t taken_ns; /* the newest frame that was taken into the surroundings: */
  vista_plan_cube cubes[VISTA_PLAN_CUBE_COUNT];
  int8_t agree[VISTA_PLAN_CUBE_COUNT]; /* frames that agree that it is free; negative: that something stands in it */
  uint8_t matches[VISTA_PLAN_CUBE_COUNT]; /* of one frame, */
  float sums[VISTA_PLAN_CUBE_COUNT][3]; /* and where, from the corner of the cube */
  double level[2][3]; /* axes of the grid */
  int32_t first[2]; /* its first cell in `way` and `length`, */
  float length[VISTA_PLAN_GRID][VISTA_PLAN_GRID]; /* of a way through each cell, in its sides, */
  float way[VISTA_PLAN_GRID + 2]
           [VISTA_PLAN_GRID + 2]; /* and from there to the goal; with a rim that nothing leads through */
  vista_plan_cell cells[VISTA_PLAN_GRID * VISTA_PLAN_GRID];
  vista_plan_decision plan; /* the last one that was committed to */
} vista_planner;

/* Begins without any decision. VISTA_ERROR_RANGE: a parameter. */
VISTA_API vista_status vista_planner_start(vista_planner *planner, const vista_parameters *parameters);

/* Forgets all decisions and where the vehicle was, as at the start of another flight, or when the poses began anew. */
VISTA_API void vista_planner_reset(vista_planner *planner);

/* Decides. The detector has judged the last frame; where it could not, as in a frame that it refused, the frames before
 * count. On an error nothing changes.
 *
 * - VISTA_ERROR_ARGUMENT: a pointer is null, or the detector has not judged any frame.
 * - VISTA_ERROR_NUMBER: a number of the state or of the goal is not finite.
 * - VISTA_ERROR_RANGE: a direction is not of unit length, the heading is upright, the speed is not positive, or a
 *   number is beyond a million metres or metres a second.
 * - VISTA_ERROR_ORDER: the state is older than the one before. */
VISTA_API vista_status vista_planner_decide(vista_planner *planner, const vista_detector *detector,
                                            const vista_plan_state *state, const vista_plan_goal *goal,
                                            vista_plan_decision *decision);

/* What is flown so long after the state of a decision: until its end, then the stop or the circle. */
VISTA_API void vista_plan_at(const vista_plan_decision *decision, double after_s, vista_plan_setpoint *setpoint);

VISTA_END

#endif
