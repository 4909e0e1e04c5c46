/* The exact place of a tile of the left image in the right one. Internal to libvista. */
#ifndef VISTA_SRC_ALIGNMENT_PLACE_H
#define VISTA_SRC_ALIGNMENT_PLACE_H

#include <stdbool.h>

#include "align/row_matches.h"

#define VISTA_TILE 8                      /* side of a tile at a quarter of the size */
#define VISTA_PLACE_SIDE (2 * VISTA_TILE) /* at half the size */

/* Pixels of half the size. */
typedef struct vista_place {
  int32_t u0, v0; /* first pixel of the tile in the left image */
  float du, dv;   /* from there to the right image */
  float sigma_v;  /* of dv */
} vista_place;

/* Refines a place that is right within 2 pixels. False: it does not converge, leaves the image, or does not look
 * alike. */
bool vista_place_refine(const vista_level *left, const vista_level *right, vista_place *place);

#endif
