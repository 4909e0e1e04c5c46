#include "surfaces.h"

#include <math.h>
#include <stdbool.h>

enum { TAPS = 4 };           /* along the longer axis of a footprint */
static const float FLATTEST =
    1e-4f; /* cosine between a ray and a normal: surfaces count as no more slanted than that */

static float dot(const float a[3], const float b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static float length_of(float x, float y) { return sqrtf(x * x + y * y); }

static float at_least(float value, float least) { return value > least ? value : least; }

static float within(float value, float most) { return value < 0.0f ? 0.0f : value > most ? most : value; }

/* Interpolates between the middles of texels; beyond the outermost ones the albedo stays as it is there. */
static float interpolated(const vista_surfaces *s, int32_t level_of_map, const float place[2]) {
  const int32_t columns = s->size[2 * level_of_map], rows = s->size[2 * level_of_map + 1];
  const float column = within(place[0] * (float)columns - 0.5f, (float)(columns - 1));
  const float row = within(place[1] * (float)rows - 0.5f, (float)(rows - 1));
  const int32_t first_column = (int32_t)column, first_row = (int32_t)row;
  const float right = column - (float)first_column, below = row - (float)first_row;
  const int32_t next = first_column + 1 < columns ? 1 : 0;
  const float *upper = s->texels + s->start[level_of_map] + (int64_t)first_row * columns + first_column;
  const float *lower = first_row + 1 < rows ? upper + columns : upper;
  const float above = upper[0] * (1.0f - right) + upper[next] * right;
  return above * (1.0f - below) + (lower[0] * (1.0f - right) + lower[next] * right) * below;
}

/* Averages the map over a pixel, whose sides are `du` and `dv` in shares of its size. */
static float read_map(const vista_surfaces *s, int32_t map, const float place[2], const float du[2],
                      const float dv[2]) {
  const int32_t whole = map * s->levels;
  const float columns = (float)s->size[2 * whole], rows = (float)s->size[2 * whole + 1];
  const float u_texels = length_of(du[0] * columns, du[1] * rows), v_texels = length_of(dv[0] * columns, dv[1] * rows);
  const bool along_u = u_texels > v_texels;
  const float longer = along_u ? u_texels : v_texels, shorter = along_u ? v_texels : u_texels;
  if (!(longer > 1.0f)) return interpolated(s, whole, place);
  const float texels = at_least(at_least(shorter, longer / (float)TAPS), 1.0f);
  const int32_t halvings = (int32_t)rintf(log2f(texels));
  const int32_t level = whole + (halvings < s->levels - 1 ? halvings : s->levels - 1);
  const float *step = along_u ? du : dv;
  float sum = 0.0f;
  for (int tap = 0; tap < TAPS; ++tap) {
    const float along = ((float)tap + 0.5f) / (float)TAPS - 0.5f;
    sum += interpolated(s, level, (float[2]){place[0] + along * step[0], place[1] + along * step[1]});
  }
  return sum / (float)TAPS;
}

/* How much the place in the map changes over a vector in the world. */
static void moved(const float slope[6], const float by_m[3], float place[2]) {
  place[0] = dot(slope, by_m);
  place[1] = dot(slope + 3, by_m);
}

/* How far the point that a ray meets moves in its plane when the ray turns by `side`. */
static void footprint(const float side[3], const float ray[3], const float normal[3], float depth_m, float moves_m[3]) {
  const float cosine = dot(normal, ray);
  const float turn = dot(normal, side) / (fabsf(cosine) < FLATTEST ? FLATTEST : cosine);
  for (int axis = 0; axis < 3; ++axis) moves_m[axis] = depth_m * (side[axis] - ray[axis] * turn);
}

/* Replaces the normal of a face by that of the round thing that it is a part of, if it is. */
static void bend(const float corners[9], float second, float third, float normal[3]) {
  float bent[3];
  for (int axis = 0; axis < 3; ++axis) {
    const float first = corners[axis];
    bent[axis] = first + second * (corners[3 + axis] - first) + third * (corners[6 + axis] - first);
  }
  const float length = sqrtf(dot(bent, bent));
  if (!(length > 0.0f)) return;
  for (int axis = 0; axis < 3; ++axis) normal[axis] = bent[axis] / length;
}

static float mapped_albedo(const vista_surfaces *s, int32_t row, const vista_rays *rays, const float ray[3],
                           const float normal[3], const float point_m[3], float depth_m) {
  const float *slope = s->slope + 6 * (int64_t)row;
  float right_m[3], down_m[3], place[2], du[2], dv[2];
  footprint(rays->right, ray, normal, depth_m, right_m);
  footprint(rays->down, ray, normal, depth_m, down_m);
  moved(slope, right_m, du);
  moved(slope, down_m, dv);
  moved(slope, point_m, place);
  for (int axis = 0; axis < 2; ++axis) place[axis] += s->offset[2 * (int64_t)row + axis];
  return read_map(s, s->map[row], place, du, dv);
}

void vista_surfaces_look(const vista_surfaces *s, const vista_rays *rays, size_t count, const vista_hits *hits,
                         const vista_matter *matter) {
  for (size_t hit = 0; hit < count; ++hit) {
    const int64_t face = hits->face[hit];
    const float *ray = rays->direction + 3 * hits->ray[hit];
    const float depth_m = hits->depth_m[hit];
    const float second = hits->second[hit], third = hits->third[hit];
    float *point_m = matter->point_m + 3 * hit, *normal = matter->normal + 3 * hit;
    for (int axis = 0; axis < 3; ++axis) {
      point_m[axis] = rays->origin_m[axis] + depth_m * ray[axis];
      normal[axis] = s->face_normal[3 * face + axis];
    }
    const int32_t *corner = s->corner + 3 * face;
    const float a = s->corner_albedo[corner[0]], b = s->corner_albedo[corner[1]], c = s->corner_albedo[corner[2]];
    matter->plain[hit] = a + second * (b - a) + third * (c - a);
    const int32_t row = s->row[face];
    if (row == VISTA_NO_MAP) {
      matter->albedo[hit] = matter->plain[hit];
    } else {
      matter->albedo[hit] = mapped_albedo(s, row, rays, ray, normal, point_m, depth_m);
      bend(s->corner_normals + 9 * (int64_t)row, second, third, normal);
    }
    if (dot(normal, ray) > 0.0f)
      for (int axis = 0; axis < 3; ++axis) normal[axis] = -normal[axis];
  }
}
