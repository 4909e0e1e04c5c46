#include "detector/pipeline_stages.h"
#include "perceive/cut/refinement.h"
#include "perceive/region/footing.h"

vista_status vista_pipeline_draw_partition(const vista_pipeline *pipeline, const int32_t *region_of_cell,
                                           vista_arena *arena, vista_judged_partition *drawn) {
  const vista_pipeline_stages last = vista_pipeline_look(pipeline);
  vista_refinement refinement = {0};
  const vista_status status = vista_refinement_layout(&refinement, arena, last.frame->foveation);
  if (status != VISTA_OK || arena->base == NULL) return status;
  vista_refine(last.frame, last.cells, region_of_cell, &refinement);
  *drawn = (vista_judged_partition){.region_of_pixel = refinement.label};
  return VISTA_OK;
}

vista_status vista_pipeline_judge_partition(const vista_pipeline *pipeline, const int32_t *region_of_cell,
                                            int32_t region_count, vista_arena *arena, vista_judged_partition *judged) {
  const vista_pipeline_stages last = vista_pipeline_look(pipeline);
  vista_refinement refinement = {0};
  vista_status status = vista_refinement_layout(&refinement, arena, last.frame->foveation);
  vista_regions *const regions = vista_arena_take(arena, 1, sizeof *regions);
  vista_regions laid_out = {0};
  if (status == VISTA_OK) status = vista_regions_layout(&laid_out, arena, last.frame->foveation);
  if (status != VISTA_OK || arena->base == NULL) return status;
  *regions = laid_out;
  vista_refine(last.frame, last.cells, region_of_cell, &refinement);
  const vista_partition partition = {region_of_cell, region_count, region_count, &refinement};
  vista_regions_compute(last.frame, last.cells, last.surfaces, &partition, regions);
  vista_footing_clear(last.frame, last.surfaces, regions, &refinement);
  *judged = (vista_judged_partition){refinement.label, regions};
  return VISTA_OK;
}
