/* Goes through the cells of the planner's grid, so that ways get shorter; internal to the planner.
 *
 * The way from a cell follows from those of its neighbours (Zhao, "A fast sweeping method for eikonal equations", 2005),
 * and each cell of a sweep waits for the one before it and for the one in the row before. So rows are gone through
 * together, each a cell behind the row before: a step takes one cell of each, in vectors, and gives what cell after cell
 * and row after row would. */
#ifndef VISTA_PLAN_WAY_SWEEP_H
#define VISTA_PLAN_WAY_SWEEP_H

#include "vista/plan.h"

#define VISTA_PLAN_WAY_FAR 1e9f /* of a cell from which no way is known */

/* Makes the ways from all cells as short as the lengths of the cells allow, from those that are given: where ways end,
 * and VISTA_PLAN_WAY_FAR elsewhere, the rim included. */
void vista_plan_sweep(vista_planner *planner);

#endif
