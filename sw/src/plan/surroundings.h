/* What is kept of the surroundings when it is out of view, or too near to be matched.
 *
 * A grid of cubes with sides of half a radius moves with the vehicle. Each frame tells of the cubes in its view that
 * something is matched in them, or that all of them is seen through: from where the full resolution would match what
 * stands there, or from nearer, if something is matched behind. For some seconds a cube is what the last frames agree on.
 * What stands is let go of only where the full resolution would match it: from nearer, a pole is seen past. */
#ifndef VISTA_PLAN_SURROUNDINGS_H
#define VISTA_PLAN_SURROUNDINGS_H

#include <stdbool.h>

#include "plan/space.h"

/* From here on the full resolution matches. */
double vista_plan_matched_from_m(const vista_frame_view *frame);

/* Takes the newest frame of the map, once, and that the vehicle stands where it is; and lists what stands by now. */
void vista_plan_take_surroundings(vista_plan_space *space);

/* How far from a place something stands that the middle of the straight way there is nearer to than the vehicle is, within
 * so far; INFINITY: nothing. */
double vista_plan_stands_within(const vista_plan_space *space, const double point_m[3], double within_m);

/* Whether all that is so near to a place was seen to be free. */
bool vista_plan_was_free(const vista_plan_space *space, const double point_m[3], double within_m);

/* Whether the vehicle was near to a place. */
bool vista_plan_stood_at(const vista_plan_space *space, const double point_m[3]);

#endif
