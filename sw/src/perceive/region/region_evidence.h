/* What the words under a region say about it, internal to libvista. */
#ifndef VISTA_SRC_REGION_EVIDENCE_H
#define VISTA_SRC_REGION_EVIDENCE_H

#include <stdbool.h>

#include "perceive/region/region.h"
#include "perceive/region/region_boundary.h"

/* Fills region->evidence in: the log-odds that each piece contributes. The boundary must have been measured. */
void vista_region_weigh(const vista_region_view *view, bool seeded, vista_region *region);

#endif
