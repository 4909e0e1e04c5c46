/* Rays through triangles, sixteen at a time, by the Embree that lies in a Python package. */
#ifndef VISTA_EVAL_RAYS_H
#define VISTA_EVAL_RAYS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Rays from one point, and how their direction changes over a pixel to the right and down; world. */
typedef struct vista_rays {
  const float *direction; /* [ray][3] */
  float origin_m[3], right[3], down[3];
} vista_rays;

/* Where rays meet a surface. */
typedef struct vista_hits {
  int64_t *ray;
  float *depth_m; /* in units of the ray's direction */
  int32_t *face;
  float *second, *third; /* weights of the face's second and third corner */
} vista_hits;

/* Triangles that rays can meet. */
typedef struct vista_obstructions {
  void *embree, *device, *scene;
} vista_obstructions;

/* Reads corner_m [corners + 2][3], whose last two do not count, and face [faces][3], both of which have to stay.
 * library: path of Embree 4. */
bool vista_rays_open(vista_obstructions *obstructions, const char *library, const float *corner_m, size_t corners,
                     const uint32_t *face, size_t faces);

/* Leaves the library loaded: it keeps something for each thread. */
void vista_rays_close(vista_obstructions *obstructions);

/* Finds the nearest surface that each ray meets, and returns how many meet one. order: of the rays, those first that
 * are near each other; hits: room for all. */
size_t vista_rays_met(const vista_obstructions *obstructions, const vista_rays *rays, const int64_t *order,
                      size_t count, const vista_hits *hits);

/* Takes those points out of `reached` from which something is in the way towards a light. A ray begins above its point
 * along the normal. */
void vista_rays_hide(const vista_obstructions *obstructions, size_t count, const float *point_m, const float *normal,
                     float above_m, const float towards[3], bool *reached);

#endif
