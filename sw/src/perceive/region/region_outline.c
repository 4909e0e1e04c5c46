/* Regions that only their outline tells: a plain wall before a plain sky.
 *
 * The interior of a smooth region cannot be matched, its edges can (paper, section II-D: the boundary decides). What
 * stands on the ground and hides what is behind it has an outline on one upright surface (upright_plane.h), which may
 * be seen at an angle: its left edge, its right edge, its upper edge, and the line where it meets the ground. An edge
 * outside of what is matched tells nothing, for or against, nor does a horizontal upper edge, which has no words.
 *
 * Of background seen between things, at most some of these agree: sky reaches the top of the image, and its lower edge,
 * on whatever is before it, is no foot on the ground. A plain patch of the ground has a foot, but beside it is more
 * ground, and nothing that stands on that foot. */
#include "perceive/region/region_boundary.h"

#include <math.h>

#include "common/bits.h"
#include "common/depth.h"
#include "common/numbers.h"
#include "perceive/cut/seed_step.h"
#include "perceive/region/upright_plane.h"
#include "perceive/scales.h"

/* The share of its foot, and of its upright edges or its upper edge, that has to lie on one upright surface for a
 * region to be a plain wall. */
#define OUTLINE_FRACTION 0.5
#define FOOT_M 0.75 /* the foot of such a region is within this of the ground's plane; at most 6 % of the range */
#define SIDE_BINS 32 /* of the height of the left and the right edge, and of the width of foot and top */
#define EDGE_BINS 8  /* at least of an edge: less of it may be chance */
#define OPEN_FOOT 0.67 /* of the foot of what only one upright edge tells: fields have .63 at most, walls .75 */
#define WHOLE_FOOT 0.8 /* with so much of it, half as much of that edge will do: in noise its words are lost first */
#define SUNK_MAX 0.1 /* of its area, below the foot: cells are coarse */
#define INNER_BLOCKS 4.0 /* in boundary_px: what is smaller is for the most part filled with the words around it */

typedef struct box {
  double min_u, min_v, max_u, max_v;
} box;

typedef enum side { SIDE_LEFT, SIDE_RIGHT, SIDE_TOP, SIDE_FOOT, SIDE_COUNT } side;

/* The place where one arc out of the region crosses its outline. */
typedef struct crossing {
  side side;
  int32_t nodes[2]; /* outer and inner cell */
  double u_px, v_px, length_px;
} crossing;

static crossing cross(const vista_foveation *f, int32_t inner, int32_t outer) {
  const double du = (double)(f->center_u[outer] - f->center_u[inner]);
  const double dv = (double)(f->center_v[outer] - f->center_v[inner]);
  const bool across = fabs(du) > fabs(dv);
  return (crossing){.side = across ? (du < 0.0 ? SIDE_LEFT : SIDE_RIGHT) : (dv < 0.0 ? SIDE_TOP : SIDE_FOOT),
                    .nodes = {outer, inner},
                    .u_px = (double)f->center_u[inner] + 0.5 * du,
                    .v_px = (double)f->center_v[inner] + 0.5 * dv,
                    .length_px = (double)f->size_px[inner]};
}

/* Extent of the region, and the share of its area that has a disparity. */
static double measure_inside(const vista_region_view *w, box *extent) {
  double area = 0.0, matched = 0.0;
  *extent = (box){INFINITY, INFINITY, -INFINITY, -INFINITY};
  for (int32_t m = 0; m < w->member_count; ++m) {
    const int32_t node = w->members[m];
    const double half = 0.5 * (double)w->foveation->size_px[node];
    const double u = (double)w->foveation->center_u[node], v = (double)w->foveation->center_v[node];
    *extent = (box){fmin(extent->min_u, u - half), fmin(extent->min_v, v - half), fmax(extent->max_u, u + half),
                    fmax(extent->max_v, v + half)};
    area += half * half;
    if (w->cells->disparity_px[node] >= 0.0f) matched += half * half;
  }
  return matched / area;
}

/* Those of SIDE_BINS between first and last that a stretch of the outline covers. */
static uint32_t covered(double first, double last, double center, double length) {
  const double scale = SIDE_BINS / (last - first);
  const int from = (int)fmax(floor((center - 0.5 * length - first) * scale + 0.5), 0.0);
  const int to = (int)fmin(floor((center + 0.5 * length - first) * scale + 0.5), SIDE_BINS);
  uint32_t bins = 0;
  for (int b = from; b < to; ++b) bins |= UINT32_C(1) << b;
  return bins;
}

static int bits(uint32_t bins) { return vista_window_count(bins, SIDE_BINS); }

static double above_ground_m(const vista_surfaces *s, const vista_camera *camera, double u_px, double v_px,
                             double disparity_px) {
  return vista_plane_height_m(&s->ground, camera, u_px, v_px, disparity_px);
}

/* How far off the ground's plane a foot may be. */
static double foot_m(const vista_camera *camera, double disparity_px) {
  return (double)vista_limit_m(camera, (float)disparity_px, (float)FOOT_M);
}

static bool upright(side side) { return side == SIDE_LEFT || side == SIDE_RIGHT; }

static uint32_t bins_of(const crossing *at, const box *extent) {
  return upright(at->side) ? covered(extent->min_v, extent->max_v, at->v_px, at->length_px)
                           : covered(extent->min_u, extent->max_u, at->u_px, at->length_px);
}

static bool on_ground(const vista_region_view *w, int32_t node) {
  return w->cells->disparity_px[node] > 0.0f && w->surfaces->horizontal[node];
}

/* ---- which upright surface ---- */

#define POINT_BINS (VISTA_PLAN_POINTS / SIDE_COUNT) /* of a side: what is in one is a point of the plan */

typedef struct point_sums {
  vista_plan_point of[SIDE_COUNT][POINT_BINS];
} point_sums;

static void add_point(const vista_plan *plan, const crossing *at, const box *extent, double disparity_px,
                      point_sums *sums) {
  vista_plan_point one;
  if (!(disparity_px > 0.0) || !vista_plan_place(plan, at->u_px, at->v_px, disparity_px, &one)) return;
  const double along = upright(at->side) ? (at->v_px - extent->min_v) / (extent->max_v - extent->min_v)
                                         : (at->u_px - extent->min_u) / (extent->max_u - extent->min_u);
  vista_plan_point *const sum = &sums->of[at->side][(int)fmin(fmax(along * POINT_BINS, 0.0), POINT_BINS - 1)];
  sum->t += at->length_px * one.t;
  sum->k += at->length_px * one.k;
  sum->ahead_px += at->length_px * one.ahead_px;
  sum->weight += at->length_px;
}

/* The disparity of the ground where the surface meets it: that of the cell there, moved along the plane. Its words
 * reach boundary_px up into what is plain. */
static double ground_px(const vista_region_view *w, const crossing *at) {
  const vista_plane *const ground = &w->surfaces->ground;
  const vista_foveation *const f = w->foveation;
  const int32_t node = at->nodes[0];
  return (double)w->cells->disparity_px[node] + ground->slope_u * (at->u_px - (double)f->center_u[node]) +
         ground->slope_v * (at->v_px + VISTA_BOUNDARY_PX - (double)f->center_v[node]);
}

/* What stands at its sides and on top of it, and the ground below. */
static int32_t find_points(const vista_region_view *w, const vista_plan *plan, const int32_t *label, int32_t own,
                           const box *extent, vista_plan_point *points) {
  const vista_graph *const graph = &w->foveation->graph;
  point_sums sums = {0};
  for (int32_t m = 0; m < w->member_count; ++m) {
    const int32_t i = w->members[m];
    for (int32_t arc = graph->first_arc[i]; arc < graph->first_arc[i + 1]; ++arc) {
      if (label[graph->head[arc]] == own) continue;
      const crossing at = cross(w->foveation, i, graph->head[arc]);
      if (at.side == SIDE_FOOT) {
        if (on_ground(w, at.nodes[0])) add_point(plan, &at, extent, ground_px(w, &at), &sums);
        continue;
      }
      for (int k = 0; k < 2; ++k)
        if (vista_standing(w->cells, w->surfaces, at.nodes[k]))
          add_point(plan, &at, extent, (double)w->cells->disparity_px[at.nodes[k]], &sums);
    }
  }
  int32_t count = 0;
  for (int k = 0; k < SIDE_COUNT; ++k)
    for (int b = 0; b < POINT_BINS; ++b) {
      vista_plan_point point = sums.of[k][b];
      if (!(point.weight > 0.0)) continue;
      point.t /= point.weight;
      point.k /= point.weight;
      point.ahead_px /= point.weight;
      points[count++] = point;
    }
  return count;
}

/* ---- what of the outline agrees with it ---- */

typedef struct agreement {
  /* Bins of each side: */
  uint32_t visible[SIDE_COUNT];    /* that could be matched */
  uint32_t seen[SIDE_COUNT];       /* that lie on the surface */
  uint32_t left_image[SIDE_COUNT]; /* where the region goes on beyond what is matched */
} agreement;

/* How many words of a cell lie on the surface. */
static int32_t words_near(const vista_region_view *w, int32_t node, double disparity_px) {
  const int32_t first = (int32_t)ceil((disparity_px - w->tolerance_px) * VISTA_DISPARITY_SCALE);
  const int32_t last = (int32_t)floor((disparity_px + w->tolerance_px) * VISTA_DISPARITY_SCALE);
  const vista_word_range range = w->cells->range[node];
  if (range.valid == 0 || range.most < first || range.least > last) return 0;
  int32_t count = 0;
  for (int32_t i = w->foveation->first_pixel[node]; i < w->foveation->first_pixel[node + 1]; ++i)
    count += (w->cells->words[i] >= first) & (w->cells->words[i] <= last);
  return count;
}

static agreement compare(const vista_region_view *w, const int32_t *label, int32_t own, const box *extent,
                         const vista_plane *surface) {
  const vista_camera *const camera = w->frame->camera;
  const vista_matched_area *const matched = &w->frame->matched;
  const vista_graph *const graph = &w->foveation->graph;
  const double foot_px = w->tolerance_px + fabs(w->surfaces->ground.slope_v) * VISTA_BOUNDARY_PX;
  agreement found = {0};
  for (int32_t m = 0; m < w->member_count; ++m) {
    const int32_t i = w->members[m];
    const double u = (double)w->foveation->center_u[i], v = (double)w->foveation->center_v[i];
    const double size = (double)w->foveation->size_px[i], half = 0.5 * size;
    const vista_margins margins = vista_matched_margins(matched, vista_plane_at(surface, u, v));
    if (u - half <= margins.left_px) found.left_image[SIDE_LEFT] |= covered(extent->min_v, extent->max_v, v, size);
    if (u + half >= camera->width_px - 1 - margins.other_px)
      found.left_image[SIDE_RIGHT] |= covered(extent->min_v, extent->max_v, v, size);
    for (int32_t arc = graph->first_arc[i]; arc < graph->first_arc[i + 1]; ++arc) {
      if (label[graph->head[arc]] == own) continue;
      const crossing at = cross(w->foveation, i, graph->head[arc]);
      const double here_px = vista_plane_at(surface, at.u_px, at.v_px);
      if (!(here_px > 0.0) || !vista_matched_holds(matched, camera, at.u_px, at.v_px, here_px)) continue;
      const uint32_t bins = bins_of(&at, extent);
      bool agrees = false;
      if (at.side == SIDE_FOOT)
        agrees = on_ground(w, at.nodes[0]) && fabs(ground_px(w, &at) - here_px) <= foot_px &&
                 fabs(above_ground_m(w->surfaces, camera, at.u_px, at.v_px, here_px)) <= foot_m(camera, here_px);
      else {
        if (here_px - vista_plane_disparity_px(&w->surfaces->ground, camera, at.u_px, at.v_px) <= w->tolerance_px)
          continue;
        agrees = words_near(w, at.nodes[0], here_px) + words_near(w, at.nodes[1], here_px) >= at.length_px;
      }
      found.visible[at.side] |= bins;
      if (agrees) found.seen[at.side] |= bins;
    }
  }
  return found;
}

static bool agrees(const agreement *a, side side, double share) {
  const int32_t seen = bits(a->seen[side]);
  return seen >= share * EDGE_BINS && seen >= share * OUTLINE_FRACTION * bits(a->visible[side]);
}

static bool has_left(const agreement *a, side side) {
  return bits(a->left_image[side]) >= OUTLINE_FRACTION * SIDE_BINS;
}

/* It has a foot, and something of it is seen to stand: its upper edge, or all upright edges that are in the image. One
 * such edge may be that of a tree beside a field whose far side is lost in noise. The words of a field end anywhere;
 * the foot of a wall is a line. */
static bool is_wall(const agreement *a) {
  const int32_t foot = bits(a->seen[SIDE_FOOT]), of_foot = bits(a->visible[SIDE_FOOT]);
  if (foot <= OUTLINE_FRACTION * of_foot) return false;
  if (agrees(a, SIDE_TOP, 1.0)) return true;
  if (agrees(a, SIDE_LEFT, 1.0) && agrees(a, SIDE_RIGHT, 1.0)) return true;
  const double share = foot >= WHOLE_FOOT * of_foot ? 0.5 : 1.0;
  const bool open = (agrees(a, SIDE_LEFT, share) && has_left(a, SIDE_RIGHT)) ||
                    (agrees(a, SIDE_RIGHT, share) && has_left(a, SIDE_LEFT));
  return open && foot >= fmax(OPEN_FOOT, OUTLINE_FRACTION) * of_foot;
}

/* Share of the region's area where the surface would be in the ground. */
static double sunk(const vista_region_view *w, const vista_camera *camera, const vista_plane *surface) {
  double area = 0.0, below = 0.0;
  for (int32_t m = 0; m < w->member_count; ++m) {
    const int32_t i = w->members[m];
    const double u = (double)w->foveation->center_u[i], v = (double)w->foveation->center_v[i];
    const double here_px = vista_plane_at(surface, u, v), size = (double)w->foveation->size_px[i];
    area += size * size;
    if (!(here_px > 0.0) || above_ground_m(w->surfaces, camera, u, v, here_px) < -foot_m(camera, here_px))
      below += size * size;
  }
  return below / area;
}

bool vista_region_owns_outline(vista_region_view *w, const int32_t *label, vista_region *region, vista_plane *surface) {
  const vista_camera *const camera = w->frame->camera;
  box extent;
  vista_plan plan;
  vista_plan_line line;
  vista_plan_point points[VISTA_PLAN_POINTS];
  if (!w->surfaces->ground_found || measure_inside(w, &extent) > VISTA_REGION_VALID_MIN_FRACTION) return false;
  const double inner_px = INNER_BLOCKS * VISTA_BOUNDARY_PX;
  if (fmin(extent.max_u - extent.min_u, extent.max_v - extent.min_v) < inner_px) return false;
  if (!vista_plan_of(camera, w->frame->up_camera, &plan)) return false;
  const int32_t count = find_points(w, &plan, label, region->label, &extent, points);
  if (!vista_plan_fit(points, count, VISTA_SURFACE_PX, &line) || line.count < VISTA_SLOPE_POINTS) return false;
  *surface = vista_plan_surface(&plan, &line);
  const double u = 0.5 * (extent.min_u + extent.max_u), v = 0.5 * (extent.min_v + extent.max_v);
  const double middle_px = vista_plane_at(surface, u, v), top_px = vista_plane_at(surface, u, extent.min_v);
  if (!(middle_px > 0.0) || !(top_px > 0.0)) return false;
  w->tolerance_px = vista_region_tolerance_px(camera, middle_px);
  const double least_m = (double)vista_limit_m(camera, (float)middle_px, (float)w->params->min_height_m);
  if (above_ground_m(w->surfaces, camera, u, extent.min_v, top_px) < least_m) return false;
  const agreement found = compare(w, label, region->label, &extent, surface);
  if (!is_wall(&found) || sunk(w, camera, surface) > SUNK_MAX) return false;
  region->plain = true;
  region->disparity_px = middle_px;
  region->slope_u = surface->slope_u;
  region->slope_v = surface->slope_v;
  region->disparity_sigma_px = line.sigma_px;
  /* Words of the ground reach anywhere from 0 to boundary_px up into what is plain. */
  region->foot_sigma_px = fabs(w->surfaces->ground.slope_v) * VISTA_BOUNDARY_PX / VISTA_SQRT_3;
  region->boundary_inliers = (int32_t)line.weight;
  return true;
}
