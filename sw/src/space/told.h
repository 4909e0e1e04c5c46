/* What a pixel tells of the space before it: its word, if its region could be judged. */
#ifndef VISTA_TOLD_H
#define VISTA_TOLD_H

#include <stdbool.h>
#include <stdint.h>

#include "perceive/region/region.h"
#include "vista/types.h"

typedef struct vista_told {
  const vista_disparity_image *disparity;
  const int32_t *region_of_pixel; /* height * width, negative: none */
  const vista_regions *regions;
} vista_told;

static inline bool vista_told_is_judged(vista_region_verdict verdict) {
  return verdict == VISTA_REGION_ACCEPTED || verdict == VISTA_REGION_HORIZONTAL || verdict == VISTA_REGION_TOO_FAR ||
         verdict == VISTA_REGION_TOO_SMALL;
}

/* The region of a pixel that tells, else null: without a region or a word, or with a region that was not judged. */
static inline const vista_region *vista_told_region(const vista_told *told, int32_t u, int32_t v) {
  const int32_t number = told->region_of_pixel[v * told->disparity->width_px + u];
  if (number < 0 || number >= told->regions->count) return NULL;
  const vista_region *const region = &told->regions->items[number];
  if (!vista_told_is_judged(region->verdict)) return NULL;
  return told->disparity->data[v * told->disparity->stride + u] > 0 || region->plain ? region : NULL;
}

#endif
