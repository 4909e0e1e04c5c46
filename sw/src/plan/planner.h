/* The planner over what a pipeline has seen, without the detector around it. */
#ifndef VISTA_PLAN_PLANNER_H
#define VISTA_PLAN_PLANNER_H

#include "detector/pipeline_stages.h"
#include "vista/directions.h"
#include "vista/plan.h"

/* Does what vista_planner_decide does. */
vista_status vista_planner_decide_in(vista_planner *planner, const vista_pipeline_stages *seen,
                                     const vista_directions *directions, const vista_plan_state *state,
                                     const vista_plan_goal *goal, vista_plan_decision *decision);

#endif
