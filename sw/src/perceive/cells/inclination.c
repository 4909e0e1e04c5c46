/* The inclination of the surface under each cell, ring by ring. */
#include "perceive/cells/surface.h"

#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include "common/wide_vectors.h"

/* Cells at least this far apart are compared, so that the noise of a disparity does not tilt the surface. */
#define LEVER_PX 8.0
#define CHUNK 32        /* cells of a ring that are treated at once */
#define LEAST_CELLS 5.0 /* that a plane is fitted to */
#define UNKNOWN (-1.0f)

/* Values of cells on the grid: a row a ring, its ends repeated beyond either end, so that the neighbours of the cells
 * of a ring lie in rows, too. Where there is no cell a value is UNKNOWN. */
struct vista_inclination {
  int32_t margin, stride; /* of a row */
  float *center_u, *center_v, *value;
};

/* Sums of a fit to each cell of a chunk. */
typedef struct fits {
  double weight[CHUNK], u[CHUNK], v[CHUNK], d[CHUNK], uu[CHUNK], uv[CHUNK], vv[CHUNK], ud[CHUNK], vd[CHUNK];
} fits;

static float *row_of(const vista_inclination *w, float *grid, int32_t ring) {
  return grid + (ptrdiff_t)ring * w->stride + w->margin;
}

static void fill_grid(const vista_inclination *w, const vista_foveation *f, const float *value, float *grid) {
  const int32_t sectors = f->sector_count;
  for (int32_t ring = 0; ring < f->ring_count; ++ring) {
    const int32_t *const nodes = f->node_of_grid + ring * sectors;
    float *const row = row_of(w, grid, ring);
    for (int32_t s = 0; s < sectors; ++s) row[s] = nodes[s] >= 0 ? value[nodes[s]] : UNKNOWN;
    memcpy(row - w->margin, row + sectors - w->margin, (size_t)w->margin * sizeof *row);
    memcpy(row + sectors, row, (size_t)w->margin * sizeof *row);
  }
}

vista_status vista_inclination_layout(const vista_foveation *foveation, vista_arena *arena,
                                      vista_inclination **inclination) {
  *inclination = NULL;
  const int32_t margin = foveation->sector_count / 8, stride = foveation->sector_count + 2 * margin;
  const size_t places = (size_t)foveation->ring_count * (size_t)stride;
  vista_inclination *const made = vista_arena_take(arena, 1, sizeof *made);
  const vista_inclination parts = {.margin = margin,
                                   .stride = stride,
                                   .center_u = vista_arena_take(arena, places, sizeof(float)),
                                   .center_v = vista_arena_take(arena, places, sizeof(float)),
                                   .value = vista_arena_take(arena, places, sizeof(float))};
  if (arena->base == NULL) return VISTA_OK;
  if (arena->used > arena->size) return VISTA_ERROR_MEMORY;
  *made = parts;
  fill_grid(made, foveation, foveation->center_u, made->center_u);
  fill_grid(made, foveation, foveation->center_v, made->center_v);
  *inclination = made;
  return VISTA_OK;
}

/* A row of cells, and that of their neighbours. */
typedef struct rows {
  const float *u, *v, *d;
} rows;

/* What vista_plane_fit_add does, for a neighbour of each cell of a chunk; without a disparity it adds zeros. */
VISTA_WIDE_VECTORS static void add_neighbours(const rows *cell, const rows *neighbour, int32_t count,
                                              fits *restrict sums) {
  const float *restrict const u = cell->u, *restrict const v = cell->v, *restrict const d = cell->d;
  const float *restrict const near_u = neighbour->u, *restrict const near_v = neighbour->v,
                              *restrict const near_d = neighbour->d;
  for (int32_t s = 0; s < count; ++s) {
    const double weight = near_d[s] >= 0.0f ? 1.0 : 0.0;
    const double du = (double)(near_u[s] - u[s]), dv = (double)(near_v[s] - v[s]), dd = (double)(near_d[s] - d[s]);
    const double weighted_u = weight * du, weighted_v = weight * dv;
    sums->weight[s] += weight;
    sums->u[s] += weighted_u;
    sums->v[s] += weighted_v;
    sums->d[s] += weight * dd;
    sums->uu[s] += weighted_u * du;
    sums->uv[s] += weighted_u * dv;
    sums->vv[s] += weighted_v * dv;
    sums->ud[s] += weighted_u * dd;
    sums->vd[s] += weighted_v * dd;
  }
}

/* What vista_plane_fit_solve and vista_plane_inclination_deg do, up to the sine; negative: no plane. */
VISTA_WIDE_VECTORS static void solve(const rows *cell, int32_t count, const vista_camera *camera, const double up[3],
                                     const fits *restrict sums, double *restrict sine) {
  const double center_u = camera->center_u_px, center_v = camera->center_v_px, focal = camera->focal_px;
  const double up_0 = up[0], up_1 = up[1], up_2 = up[2];
  for (int32_t s = 0; s < count; ++s) {
    const double weight = sums->weight[s];
    const double u = sums->u[s] / weight, v = sums->v[s] / weight, d = sums->d[s] / weight;
    const double uu = sums->uu[s] / weight - u * u, uv = sums->uv[s] / weight - u * v;
    const double vv = sums->vv[s] / weight - v * v;
    const double ud = sums->ud[s] / weight - u * d, vd = sums->vd[s] / weight - v * d;
    const double determinant = uu * vv - uv * uv;
    const double slope_u = (ud * vv - vd * uv) / determinant, slope_v = (vd * uu - ud * uv) / determinant;
    const double offset = d - slope_u * u - slope_v * v + (double)cell->d[s];
    const double at_center =
        offset - slope_u * ((double)cell->u[s] - center_u) - slope_v * ((double)cell->v[s] - center_v);
    const double n_2 = at_center / focal;
    const double norm = sqrt(slope_u * slope_u + slope_v * slope_v + n_2 * n_2);
    const double along = fabs(slope_u * up_0 + slope_v * up_1 + n_2 * up_2) / norm;
    const double bounded = along < 1.0 ? along : 1.0;
    const double spans = determinant > 1e-6 * (uu * vv + 1e-12) ? bounded : -1.0;
    const double enough = weight >= LEAST_CELLS ? spans : -1.0;
    sine[s] = norm > 0.0 ? enough : -1.0;
  }
}

static rows rows_of(const vista_inclination *w, int32_t ring, int32_t sector) {
  return (rows){row_of(w, w->center_u, ring) + sector, row_of(w, w->center_v, ring) + sector,
                row_of(w, w->value, ring) + sector};
}

/* The cells `first` .. `first` + count - 1 of a ring. */
static void measure_chunk(vista_inclination *w, const vista_foveation *f, int32_t ring, int32_t first, int32_t count,
                          int32_t steps, const vista_camera *camera, const double up[3], float *inclination_deg) {
  const int32_t *const nodes = f->node_of_grid + ring * f->sector_count + first;
  const rows cell = rows_of(w, ring, first);
  fits sums = {0};
  for (int32_t r = ring - steps; r <= ring + steps; r += steps) {
    if (r < 0 || r >= f->ring_count) continue;
    for (int32_t shift = -steps; shift <= steps; shift += steps) {
      const rows neighbour = rows_of(w, r, first + shift);
      add_neighbours(&cell, &neighbour, count, &sums);
    }
  }
  double sine[CHUNK];
  solve(&cell, count, camera, up, &sums, sine);
  for (int32_t s = 0; s < count; ++s)
    if (nodes[s] >= 0)
      inclination_deg[nodes[s]] =
          cell.d[s] >= 0.0f && sine[s] >= 0.0 ? (float)(asin(sine[s]) * VISTA_DEGREES_PER_RADIAN) : UNKNOWN;
}

void vista_inclination_measure(vista_inclination *w, const vista_frame_view *frame, const vista_cells *cells,
                               float *inclination_deg) {
  const vista_foveation *const f = frame->foveation;
  fill_grid(w, f, cells->disparity_px, w->value);
  for (int32_t ring = 0; ring < f->ring_count; ++ring) {
    float size_px = 0.0f; /* the same of all cells of the ring */
    for (int32_t s = 0; s < f->sector_count && size_px == 0.0f; ++s)
      if (f->node_of_grid[ring * f->sector_count + s] >= 0)
        size_px = f->size_px[f->node_of_grid[ring * f->sector_count + s]];
    if (size_px == 0.0f) continue;
    const double lever = ceil(LEVER_PX / (double)size_px);
    const int32_t steps = lever > w->margin ? w->margin : (int32_t)lever;
    for (int32_t first = 0; first < f->sector_count; first += CHUNK) {
      const int32_t left = f->sector_count - first;
      measure_chunk(w, f, ring, first, left < CHUNK ? left : CHUNK, steps, frame->camera, frame->up_camera,
                    inclination_deg);
    }
  }
}
