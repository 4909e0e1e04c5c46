/* Asks the map of space whether a trajectory is free, as wide as the vehicle.
 *
 * Places stand along it as far apart as the map can tell them apart, each a ball of the collision radius and twice the
 * error of the position. What the last frames show of a place is weighed as on the flight path (path_places.h), with the
 * confirmed obstacles that reach into it; and the newest frame that has it in view has to see through it, too. What
 * fewer than four frames have in view has just come into view: it is not free by what they see, but may be known not to
 * be. What is out of view is free if all within half a radius was seen to be free in the last seconds
 * (plan/surroundings.h). So the vehicle can go back where it came from, and turn its camera to other ways. What is out of
 * view, or too near to be matched at full resolution, is not free where something was matched nearby: from near only a
 * small ball fits into the view, and what is beside it has left. What stands is in the way of a place only if the middle of
 * the straight way there is nearer to it than the vehicle is: so the vehicle gets away from what is nearer than the radius,
 * and not through it. What moves by itself is where it will be at that time.
 *
 * The turn of a fixed wing is wider than the view. What is out of view on it counts as free, and so does what is hidden,
 * from 1.5 s ahead on. If hidden places ruled it out, even those of its first right angle alone, the aircraft would always
 * turn away from what hides something, as from its route behind the corner of a house, to where it has seen less. */
#ifndef VISTA_PLAN_SPACE_H
#define VISTA_PLAN_SPACE_H

#include <stdbool.h>
#include <stdint.h>

#include "detector/pipeline_stages.h"
#include "vista/directions.h"
#include "vista/plan.h"

/* Places that are asked for at most, each time: for manoeuvres that sway, for those that do not, for what was committed to,
 * and once more where something is in its way. */
#define VISTA_PLAN_LOOKS 324

/* What is known of a place, for whoever wants to fly there. */
typedef struct vista_plan_place {
  vista_plan_ruling ruling; /* VISTA_PLAN_CHOSEN: it is free */
  int32_t obstacle_id;
  bool occupied; /* rather than unknown */
  bool stood;    /* nobody sees it, but the vehicle was near to it */
} vista_plan_place;

typedef struct vista_plan_looked {
  double point_m[3];
  vista_plan_place place;
} vista_plan_looked;

/* A confirmed obstacle that places are held against. */
typedef struct vista_plan_thing {
  int32_t index;
  double deep_m;    /* half the depth of what stands for it */
  float near_m2;    /* if it stands: what is farther from it is not at it; squared, */
  double start2_m2; /* and how far the vehicle is from it */
} vista_plan_thing;

#define VISTA_PLAN_THINGS 4100

/* What is asked in a decision. */
typedef struct vista_plan_space {
  vista_pipeline_stages seen;
  vista_directions directions;
  int32_t blocked_count;
  double blocked_m[VISTA_DIRECTIONS][2]; /* what ends a column: ahead of the camera and to its right, level */
  vista_planner *planner; /* who keeps what was seen */
  int64_t t_ns;           /* of the state, */
  double start_m[3];      /* and where the vehicle is */
  double radius_m; /* of the balls */
  double off_m;    /* from the vehicle to where its trajectories begin */
  double late_s;   /* from the frame to the state */
  int32_t still_count, thing_count; /* what stands, and then what moves */
  vista_plan_thing things[VISTA_PLAN_THINGS];
  int32_t standing_count; /* cubes of the surroundings in which something stands, */
  uint16_t standing[VISTA_PLAN_CUBE_COUNT]; /* and where the planner keeps them */
  int32_t looks;
  vista_plan_looked looked[VISTA_PLAN_LOOKS];
} vista_plan_space;

/* Lists the obstacles. */
void vista_plan_take_obstacles(vista_plan_space *space);

/* What is known of a place, so long after the state. */
vista_plan_place vista_plan_look(vista_plan_space *space, const double point_m[3], double after_s);

/* A look along the trajectory of an option, up to the first place that is not free. */
typedef struct vista_plan_walk {
  vista_plan_space *space;
  vista_plan_decision *plan; /* its points; escape_seen: all of the escape was seen to be free */
  vista_plan_option *option; /* gets its ruling at that place */
  bool occupied_alone; /* what is unknown does not count */
  int32_t next; /* point, from 1 on: those before it were looked at */
  double last_m[3]; /* place that was looked at */
} vista_plan_walk;

/* Looks on, up to the last point that there is by now. ends: the trajectory ends there. True: all of it is free. */
bool vista_plan_walk_on(vista_plan_walk *walk, bool ends);

/* Looks along a whole trajectory. */
bool vista_plan_check(vista_plan_space *space, vista_plan_decision *plan, bool occupied_alone,
                      vista_plan_option *option);

#endif
