/* A look at what the stages made of the last frame, for the tests and the evaluation. Internal to libvista: the stages
 * may change at any time. */
#ifndef VISTA_SRC_PIPELINE_STAGES_H
#define VISTA_SRC_PIPELINE_STAGES_H

#include "perceive/cells/affinity.h"
#include "perceive/cells/foveation.h"
#include "perceive/cells/surface.h"
#include "perceive/region/region.h"
#include "vista/pipeline.h"

typedef struct vista_pipeline_stages {
  const vista_foveation *foveation;
  const vista_cells *cells;
  const vista_surfaces *surfaces;
  const vista_affinity *affinity;
  const vista_regions *regions;
  const vista_refinement_params *refinement_params; /* as that frame was refined, against its noise */
  const vista_matched_area *matched;
} vista_pipeline_stages;

vista_pipeline_stages vista_pipeline_look(const vista_pipeline *pipeline);

#endif
