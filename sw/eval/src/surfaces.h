/* What rays find where they meet triangles: the innermost loop of the renderer of flights. */
#ifndef VISTA_EVAL_SURFACES_H
#define VISTA_EVAL_SURFACES_H

#include <stddef.h>
#include <stdint.h>

#include "rays.h"

#define VISTA_NO_MAP (-1)

/* Triangles in the world, and their albedo: at their corners, or in a map with all its halvings. */
typedef struct vista_surfaces {
  const int32_t *corner;       /* [face][3] */
  const float *corner_albedo;  /* [corner] */
  const float *face_normal;    /* [face][3] unit */
  const int32_t *row;          /* [face] of those with a map, or VISTA_NO_MAP */
  const int32_t *map;          /* [row] */
  const float *slope;          /* [row][2][3] of the place in the map, a metre */
  const float *offset;         /* [row][2] */
  const float *corner_normals; /* [row][3][3]; 0: the face is flat */
  const int32_t *size;         /* [map][level][2] columns, rows */
  const int64_t *start;        /* [map][level] in texels */
  const float *texels;
  int32_t levels;
} vista_surfaces;

/* What is there: the point, the normal towards the viewer, the albedo averaged over the pixel, and the albedo without
 * any map. */
typedef struct vista_matter {
  float *point_m, *normal; /* [hit][3] */
  float *albedo, *plain;   /* [hit] */
} vista_matter;

void vista_surfaces_look(const vista_surfaces *surfaces, const vista_rays *rays, size_t count, const vista_hits *hits,
                         const vista_matter *matter);

#endif
