#include "perceive/cells/foveation.h"

#include <math.h>
#include <stdbool.h>
#include <stddef.h>

#include "common/parameters_check.h"
#include "common/word_blocks.h"

/* A cell whose inscribed circle is narrower than a pixel's diagonal may hold no pixel centre at all. */
#define POINT_SIZE_PX 1.5

static const double two_pi = 6.283185307179586;

/* Ring and sector of a point; ring -1 is the hub. */
static int32_t grid_cell(const vista_foveation *g, double u_px, double v_px) {
  const double du = u_px - g->center_u_px, dv = v_px - g->center_v_px;
  const double rho = hypot(du, dv);
  if (rho < g->rho_0_px) return -1;
  const double step = two_pi / g->sector_count;
  double theta = atan2(dv, du);
  if (theta < 0.0) theta += two_pi;
  int32_t ring = (int32_t)floor(log(rho / g->rho_0_px) / step);
  int32_t sector = (int32_t)floor(theta / step);
  if (ring >= g->ring_count) ring = g->ring_count - 1;
  if (sector >= g->sector_count) sector = 0; /* theta rounded up to 2 pi */
  return ring * g->sector_count + sector;
}

/* The geometry, without the arrays. */
static vista_foveation grid_of(const vista_foveation_params *params, const vista_fovea *fovea) {
  const double center_u_px = fovea->center_u_px, center_v_px = fovea->center_v_px;
  const double far_u = fmax(center_u_px, fovea->width_px - 1 - center_u_px);
  const double far_v = fmax(center_v_px, fovea->height_px - 1 - center_v_px);
  const double step = two_pi / params->sector_count;
  const double rings = floor(log(fmax(hypot(far_u, far_v) / params->rho_0_px, 1.0)) / step) + 1.0;
  return (vista_foveation){.width_px = fovea->width_px,
                           .height_px = fovea->height_px,
                           .ring_count = (int32_t)rings,
                           .sector_count = params->sector_count,
                           .max_nodes = (int32_t)rings * params->sector_count + 1,
                           .center_u_px = center_u_px,
                           .center_v_px = center_v_px,
                           .rho_0_px = params->rho_0_px};
}

static double ring_radius_px(const vista_foveation *g, double ring) {
  return g->rho_0_px * exp(ring * two_pi / g->sector_count);
}

static bool inside(int32_t width_px, int32_t height_px, double u_px, double v_px) {
  return u_px >= 0.0 && v_px >= 0.0 && u_px <= width_px - 1 && v_px <= height_px - 1;
}

/* Bound on the pixels of one cell: the hub or an outermost cell, a pixel of margin all round. */
static int32_t max_footprint_px(const vista_foveation *g) {
  const double outer = ring_radius_px(g, g->ring_count) * two_pi / g->sector_count + 2.0;
  const double hub = 2.0 * g->rho_0_px + 2.0;
  return (int32_t)fmin(fmax(outer * outer, hub * hub) + 4.0, (double)g->width_px * g->height_px + 4.0);
}

/* A row crosses every ring's circle, and that of the hub, at most twice, and the rays of half the sectors once. */
static int32_t max_runs(const vista_foveation *g) {
  const int32_t crossings = 2 * (g->ring_count + 1) + g->sector_count / 2 + 2;
  return (crossings < g->width_px ? crossings + 1 : g->width_px) * g->height_px;
}

/* Most pixels share the cell of the one before. Whether one surely does is a few products with the borders of that
 * cell, where grid_cell takes three transcendental functions. What is near a border is left to grid_cell: both
 * agree. */
#define MOST_RINGS 512 /* of 256 sectors around a hub of a pixel there are 382 in the largest image */
#define NEAR 1e-6      /* of the radius, relative; from a ray, pixels */

typedef struct borders {
  double rho2[MOST_RINGS + 1];                              /* squared radii between the rings */
  double ray_u[VISTA_MOST_SECTORS + 1], ray_v[VISTA_MOST_SECTORS + 1]; /* directions between the sectors */
} borders;

static void find_borders(const vista_foveation *g, borders *b) {
  for (int32_t ring = 0; ring <= g->ring_count; ++ring)
    b->rho2[ring] = ring_radius_px(g, ring) * ring_radius_px(g, ring);
  for (int32_t sector = 0; sector <= g->sector_count; ++sector) {
    b->ray_u[sector] = cos(sector * two_pi / g->sector_count);
    b->ray_v[sector] = sin(sector * two_pi / g->sector_count);
  }
}

static bool surely_inside(const borders *b, int32_t ring, int32_t sector, double du, double dv) {
  const double rho2 = du * du + dv * dv;
  /* NOLINTBEGIN(clang-analyzer-core.UndefinedBinaryOperatorResult,clang-analyzer-security.ArrayBound): a cell has
   * borders on all its sides */
  if (ring < 0) return rho2 < b->rho2[0] * (1.0 - NEAR);
  return rho2 > b->rho2[ring] * (1.0 + NEAR) && rho2 < b->rho2[ring + 1] * (1.0 - NEAR) &&
         b->ray_u[sector] * dv - b->ray_v[sector] * du > NEAR &&
         b->ray_v[sector + 1] * du - b->ray_u[sector + 1] * dv > NEAR;
  /* NOLINTEND(clang-analyzer-core.UndefinedBinaryOperatorResult,clang-analyzer-security.ArrayBound) */
}

/* Numbers the cells that hold a pixel or have their centre inside the image. */
static void number_nodes(vista_foveation *f) {
  const int32_t grid_count = f->ring_count * f->sector_count;
  borders b;
  find_borders(f, &b);
  int32_t cell = -1, ring = -1, sector = 0;
  for (int32_t v = 0; v < f->height_px; ++v) {
    int32_t *const row = f->cell_of_pixel + (ptrdiff_t)v * f->width_px;
    for (int32_t u = 0; u < f->width_px; ++u) {
      if (!surely_inside(&b, ring, sector, u - f->center_u_px, v - f->center_v_px)) {
        cell = grid_cell(f, u, v);
        ring = cell < 0 ? -1 : cell / f->sector_count;
        sector = cell < 0 ? 0 : cell % f->sector_count;
        if (cell >= 0) f->node_of_grid[cell] = 1;
      }
      row[u] = cell;
    }
  }
  f->center_u[0] = (float)f->center_u_px;
  f->center_v[0] = (float)f->center_v_px;
  f->size_px[0] = (float)(2.0 * f->rho_0_px);
  f->node_count = 1;
  f->point_count = 0;
  const double step = two_pi / f->sector_count;
  for (cell = 0; cell < grid_count; ++cell) {
    const double rho = ring_radius_px(f, cell / f->sector_count + 0.5);
    const double theta = (cell % f->sector_count + 0.5) * step;
    const double u = f->center_u_px + rho * cos(theta), v = f->center_v_px + rho * sin(theta);
    const bool exists = f->node_of_grid[cell] == 1 || inside(f->width_px, f->height_px, u, v);
    f->node_of_grid[cell] = exists ? f->node_count : -1;
    if (!exists) continue;
    f->center_u[f->node_count] = (float)u;
    f->center_v[f->node_count] = (float)v;
    f->size_px[f->node_count] = (float)(rho * step);
    if (rho * step < POINT_SIZE_PX) f->point_count = f->node_count;
    f->node_count++;
  }
}

/* False: there are more than fit, which the geometry rules out. */
static bool sort_runs(vista_foveation *f) {
  for (int pass = 0; pass < 2; ++pass) { /* counting sort by node: count, then place */
    for (int32_t v = 0; v < f->height_px; ++v) {
      for (int32_t u = 0; u < f->width_px;) {
        int32_t *const row = f->cell_of_pixel + (size_t)v * (size_t)f->width_px;
        const int32_t node = pass == 0 ? (row[u] < 0 ? 0 : f->node_of_grid[row[u]]) : row[u];
        int32_t end = u;
        const int32_t same = row[u];
        while (end < f->width_px && row[end] == same) {
          if (pass == 0) row[end] = node;
          end++;
        }
        if (pass == 0) {
          f->first_run[node + 1]++;
          f->pixel_count[node] += end - u;
        } else {
          f->runs[f->first_run[node]++] = (vista_run){u, v, end - u};
        }
        u = end;
      }
    }
    if (pass == 0)
      for (int32_t i = 0; i < f->node_count; ++i) f->first_run[i + 1] += f->first_run[i];
    if (pass == 0 && f->first_run[f->node_count] > max_runs(f)) return false;
  }
  for (int32_t i = f->node_count; i > 0; --i) f->first_run[i] = f->first_run[i - 1];
  f->first_run[0] = 0;
  return true;
}

static void list_pixels(vista_foveation *f) {
  int32_t pixel = 0;
  for (int32_t node = 0; node < f->node_count; ++node) {
    f->first_pixel[node] = pixel;
    for (int32_t r = f->first_run[node]; r < f->first_run[node + 1]; ++r) {
      for (int32_t i = 0; i < f->runs[r].length_px; ++i, ++pixel) {
        f->pixel_u[pixel] = (int16_t)(f->runs[r].u_px + i);
        f->pixel_v[pixel] = (int16_t)f->runs[r].v_px;
      }
    }
  }
  f->first_pixel[f->node_count] = pixel;
}

/* The runs of a cell come in the order of their rows, so the next one of a cell is the next of its list. */
static void list_rows(vista_foveation *f) {
  int32_t run = 0, first_u = 0;
  for (int32_t v = 0; v < f->height_px; ++v, first_u = 0) {
    const int32_t *const row = f->cell_of_pixel + (ptrdiff_t)v * f->width_px;
    for (int32_t u = 0; u < f->width_px; ++u) {
      if (u + 1 < f->width_px && row[u + 1] == row[u]) continue;
      f->end_in_rows[run] = v * f->width_px + u + 1;
      f->listed_in_rows[run] = f->first_pixel[row[u]];
      f->first_pixel[row[u]] += u + 1 - first_u;
      f->node_in_rows[run++] = row[u];
      first_u = u + 1;
    }
  }
  for (int32_t node = f->node_count; node > 0; --node) f->first_pixel[node] = f->first_pixel[node - 1];
  f->first_pixel[0] = 0;
}

static int32_t list_edges(const vista_foveation *f, int32_t *edges) {
  int32_t count = 0;
  const int32_t sectors = f->sector_count, *const node_of_grid = f->node_of_grid;
  for (int32_t ring = 0; ring < f->ring_count; ++ring) {
    for (int32_t sector = 0; sector < sectors; ++sector) {
      const int32_t node = node_of_grid[ring * sectors + sector];
      if (node < 0) continue;
      const int32_t neighbours[2] = {
          ring == 0 ? 0 : node_of_grid[(ring - 1) * sectors + sector],
          node_of_grid[ring * sectors + (sector + 1) % sectors],
      };
      for (int k = 0; k < 2; ++k) {
        if (neighbours[k] < 0) continue;
        edges[2 * count] = neighbours[k];
        edges[2 * count + 1] = node;
        count++;
      }
    }
  }
  return count;
}

bool vista_foveation_handles(int32_t width_px, int32_t height_px) {
  return width_px >= VISTA_LEAST_IMAGE_PX && height_px >= VISTA_LEAST_IMAGE_PX && width_px <= VISTA_MOST_IMAGE_PX &&
         height_px <= VISTA_MOST_IMAGE_PX;
}

vista_status vista_foveation_layout(vista_foveation *foveation, vista_arena *arena,
                                    const vista_foveation_params *params, const vista_fovea *fovea) {
  const int32_t width_px = fovea->width_px, height_px = fovea->height_px;
  if (VISTA_CHECK_SECTION(foveation, params) != VISTA_OK) return VISTA_ERROR_RANGE;
  if (!vista_foveation_handles(width_px, height_px)) return VISTA_ERROR_SIZE;
  if (!inside(width_px, height_px, fovea->center_u_px, fovea->center_v_px)) return VISTA_ERROR_RANGE;
  vista_foveation *const f = foveation;
  *f = grid_of(params, fovea);
  if (f->ring_count > MOST_RINGS || f->sector_count > VISTA_MOST_SECTORS) return VISTA_ERROR_RANGE;

  const size_t pixels = (size_t)width_px * (size_t)height_px, nodes = (size_t)f->max_nodes, runs = (size_t)max_runs(f);
  const int32_t max_edges = 2 * f->max_nodes;
  f->max_footprint_px = max_footprint_px(f);
  f->cell_of_pixel = vista_arena_take(arena, pixels, sizeof(int32_t));
  f->node_of_grid = vista_arena_take(arena, nodes, sizeof(int32_t));
  f->first_run = vista_arena_take(arena, nodes + 1, sizeof(int32_t));
  f->pixel_count = vista_arena_take(arena, nodes, sizeof(int32_t));
  f->first_pixel = vista_arena_take(arena, nodes + 1, sizeof(int32_t));
  f->pixel_u = vista_arena_take(arena, pixels + VISTA_WORD_BLOCK, sizeof(int16_t));
  f->pixel_v = vista_arena_take(arena, pixels + VISTA_WORD_BLOCK, sizeof(int16_t));
  f->end_in_rows = vista_arena_take(arena, runs, sizeof(int32_t));
  f->node_in_rows = vista_arena_take(arena, runs, sizeof(int32_t));
  f->listed_in_rows = vista_arena_take(arena, runs, sizeof(int32_t));
  f->runs = vista_arena_take(arena, runs, sizeof(vista_run));
  f->center_u = vista_arena_take(arena, nodes, sizeof(float));
  f->center_v = vista_arena_take(arena, nodes, sizeof(float));
  f->size_px = vista_arena_take(arena, nodes, sizeof(float));
  f->arc_distance_px = vista_arena_take(arena, 2 * (size_t)max_edges, sizeof(float));
  int32_t *const edges = vista_arena_take(arena, 2 * (size_t)max_edges, sizeof(int32_t));
  if (arena->base == NULL) return vista_graph_build(&f->graph, arena, f->max_nodes, NULL, max_edges);
  if (arena->used > arena->size) return VISTA_ERROR_MEMORY;

  number_nodes(f);
  if (!sort_runs(f)) return VISTA_ERROR_MEMORY;
  list_pixels(f);
  list_rows(f);
  const int32_t edge_count = list_edges(f, edges);
  const vista_status status = vista_graph_build(&f->graph, arena, f->node_count, edges, edge_count);
  if (status != VISTA_OK) return status;
  for (int32_t i = 0; i < f->node_count; ++i) {
    for (int32_t arc = f->graph.first_arc[i]; arc < f->graph.first_arc[i + 1]; ++arc) {
      const int32_t j = f->graph.head[arc];
      f->arc_distance_px[arc] = hypotf(f->center_u[i] - f->center_u[j], f->center_v[i] - f->center_v[j]);
    }
  }
  return VISTA_OK;
}
