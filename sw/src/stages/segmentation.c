#include "stages/segmentation.h"

#include <math.h>
#include <stdbool.h>
#include <stddef.h>

#include "common/frame.h"
#include "common/parameters_check.h"
#include "common/plane_fit.h"
#include "stages/parts/merge.h"
#include "stages/parts/seed_step.h"

/* Exceeds everything the arcs of a node can carry (flow constraint 2), and sums of two of them still fit the type. */
#define SEED_LINK (INT32_C(1) << 29)
#define NOT_REACHED INT32_MAX

vista_status vista_segmentation_layout(vista_segmentation *segmentation, vista_arena *arena,
                                       const vista_foveation *foveation) {
  if (segmentation == NULL || arena == NULL || foveation == NULL) return VISTA_ERROR_ARGUMENT;
  vista_segmentation *const s = segmentation;
  const size_t nodes = (size_t)foveation->max_nodes;
  s->label = vista_arena_take(arena, nodes, sizeof(int32_t));
  s->source_capacity = vista_arena_take(arena, nodes, sizeof(int32_t));
  s->sink_capacity = vista_arena_take(arena, nodes, sizeof(int32_t));
  s->subset = vista_arena_take(arena, nodes, sizeof(int32_t));
  s->steps = vista_arena_take(arena, nodes, sizeof(int32_t));
  s->carried_px = vista_arena_take(arena, nodes, sizeof(float));
  s->source_side = vista_arena_take(arena, nodes, sizeof(uint8_t));
  s->capacity = vista_arena_take(arena, (size_t)foveation->graph.arc_count, sizeof(int32_t));
  const vista_status merging = vista_merge_layout(foveation, arena, &s->merge);
  if (merging != VISTA_OK) return merging;
  const vista_status status = vista_seeds_layout(&s->seeds, arena, foveation);
  if (status != VISTA_OK) return status;
  return vista_maxflow_layout(&s->maxflow, &foveation->graph, arena);
}

/* What a cut reads; bundled because every step of it needs the same. */
typedef struct view {
  const vista_foveation *foveation;
  const vista_segmentation_params *params;
  const vista_cells *cells;
  const vista_surfaces *surfaces;
  const vista_affinity *affinity;
  double flow_scale;
} view;

/* Data term of a free cell: pull towards T while an obstacle seed is cut out. */
static int32_t sink_link(const view *w, const vista_seeds *seeds, int32_t seed, int32_t node) {
  if (seeds->max_disparity_px[seed] < 0.0f) return 0; /* the rest has no disparity to disagree with */
  if (w->surfaces->horizontal[node]) return (int32_t)(w->params->horizontal_link * w->flow_scale);
  const float d = w->cells->disparity_px[node];
  if (d < 0.0f) return (int32_t)(w->params->unknown_link * w->flow_scale);
  const float beyond = fmaxf(d - seeds->max_disparity_px[seed], seeds->min_disparity_px[seed] - d);
  return (int32_t)(w->params->mismatch_link * w->flow_scale * (double)fminf(fmaxf(beyond, 0.0f), 4.0f));
}

/* Breadth first from the seed: its members, the free cells within reach, and the cells of other seeds that touch
 * them. Cells further away can only be on T's side. Returns the size of the subset. */
static int32_t gather(const view *w, vista_segmentation *s, int32_t seed) {
  const vista_graph *const graph = &w->foveation->graph;
  const vista_seeds *const seeds = &s->seeds;
  int32_t count = 0;
  for (int32_t m = seeds->first_member[seed]; m < seeds->first_member[seed + 1]; ++m) {
    const int32_t node = seeds->members[m];
    if (s->label[node] >= 0) continue;
    s->source_capacity[node] = seeds->shell[node] ? 0 : SEED_LINK;
    s->sink_capacity[node] = 0;
    s->steps[node] = 0;
    s->subset[count++] = node;
  }
  for (int32_t next = 0; next < count; ++next) {
    const int32_t node = s->subset[next];
    const bool seed_of_other = s->sink_capacity[node] == SEED_LINK;
    if (seed_of_other || s->steps[node] >= w->params->reach) continue;
    for (int32_t arc = graph->first_arc[node]; arc < graph->first_arc[node + 1]; ++arc) {
      const int32_t other = graph->head[arc];
      if (s->label[other] >= 0 || s->steps[other] != NOT_REACHED) continue;
      const bool last = s->steps[node] + 1 >= w->params->reach;
      s->steps[other] = s->steps[node] + 1;
      s->source_capacity[other] = 0;
      s->sink_capacity[other] =
          seeds->seed_of_node[other] != VISTA_NO_SEED || last ? SEED_LINK : sink_link(w, seeds, seed, other);
      s->subset[count++] = other;
    }
  }
  return count;
}

/* One isolating cut; the source side becomes region `label`. */
static vista_status cut_out(const view *w, vista_segmentation *s, int32_t seed, int32_t label) {
  const int32_t count = gather(w, s, seed);
  const vista_maxflow_problem problem = {s->capacity, s->source_capacity, s->sink_capacity, s->subset, count};
  int64_t value;
  const vista_status status = vista_maxflow_solve(&s->maxflow, &problem, s->source_side, NULL, &value);
  if (status != VISTA_OK) return status;
  for (int32_t k = 0; k < count; ++k) {
    const int32_t node = s->subset[k];
    s->steps[node] = NOT_REACHED;
    if (s->source_side[node]) s->label[node] = label;
  }
  s->cut_count++;
  s->cut_nodes += count;
  return VISTA_OK;
}

static void choose_capacities(const view *w, vista_segmentation *s) {
  const vista_graph *const graph = &w->foveation->graph;
  for (int32_t i = 0; i < graph->node_count; ++i) {
    for (int32_t arc = graph->first_arc[i]; arc < graph->first_arc[i + 1]; ++arc) {
      const bool uncertain = s->seeds.shell[i] || s->seeds.shell[graph->head[arc]];
      s->capacity[arc] = uncertain ? w->affinity->intensity_capacity[arc] : w->affinity->capacity[arc];
    }
  }
}

static vista_status cut_all(const view *w, vista_segmentation *s) {
  choose_capacities(w, s);
  for (int32_t seed = 0; seed < s->seeds.count; ++seed) {
    const vista_status status = cut_out(w, s, seed, s->region_count);
    if (status != VISTA_OK) return status;
    s->region_count++;
  }
  return VISTA_OK;
}

#define FOOT_PX 1.0 /* or FOOT_SHARE of the disparity: how far below its foot a thing may seem to reach */
#define FOOT_SHARE 0.05

/* Whether a cell touches one of its region that stands: the foot of a thing, which its ground hides in the words. */
static bool at_foot(const view *w, const int32_t *label, int32_t node) {
  const vista_graph *const graph = &w->foveation->graph;
  for (int32_t arc = graph->first_arc[node]; arc < graph->first_arc[node + 1]; ++arc)
    if (label[graph->head[arc]] == label[node] && vista_standing(w->cells, w->surfaces, graph->head[arc])) return true;
  return false;
}

/* What a region has of the ground leaves it: cells that lie on it, but for its foot, and cells without a disparity
 * that are seen below where a thing as far as the nearest known cell of the region meets the ground. */
static void split_off_ground(const view *w, const vista_camera *camera, vista_segmentation *s) {
  const vista_foveation *const f = w->foveation;
  float *const carried_px = s->carried_px;
  const vista_plane plane = {w->surfaces->ground_px, w->surfaces->ground_slope_u, w->surfaces->ground_slope_v};
  int32_t count = 0;
  for (int32_t i = 0; i < f->node_count; ++i) {
    if (s->label[i] >= 0 && w->surfaces->horizontal[i] && !at_foot(w, s->label, i)) s->label[i] = VISTA_NO_LABEL;
    carried_px[i] = s->label[i] >= 0 ? w->cells->disparity_px[i] : -1.0f;
    if (carried_px[i] >= 0.0f) s->subset[count++] = i;
  }
  if (!w->surfaces->ground_found) return;
  for (int32_t next = 0; next < count; ++next) {
    const int32_t i = s->subset[next];
    for (int32_t arc = f->graph.first_arc[i]; arc < f->graph.first_arc[i + 1]; ++arc) {
      const int32_t j = f->graph.head[arc];
      if (carried_px[j] >= 0.0f || s->label[j] != s->label[i]) continue;
      carried_px[j] = carried_px[i];
      s->subset[count++] = j;
    }
  }
  for (int32_t i = 0; i < f->node_count; ++i) {
    if (s->label[i] < 0 || w->cells->disparity_px[i] >= 0.0f || carried_px[i] < 0.0f) continue;
    const double ground =
        vista_plane_disparity_px(&plane, camera, (double)f->center_u[i], (double)f->center_v[i]);
    if (ground > (double)carried_px[i] + fmax(FOOT_PX, FOOT_SHARE * ground)) s->label[i] = VISTA_NO_LABEL;
  }
}

vista_status vista_segment(const vista_foveation *foveation, const vista_parameters *params, const vista_camera *camera,
                           const vista_cells *cells, const vista_surfaces *surfaces, const vista_affinity *affinity,
                           vista_segmentation *segmentation) {
  if (foveation == NULL || params == NULL || camera == NULL || cells == NULL || surfaces == NULL || affinity == NULL ||
      segmentation == NULL)
    return VISTA_ERROR_ARGUMENT;
  vista_status status = VISTA_CHECK_SECTION(segmentation, &params->segmentation);
  if (status == VISTA_OK) status = VISTA_CHECK_SECTION(affinity, &params->affinity);
  if (status == VISTA_OK) status = vista_frame_check_camera(camera);
  if (status != VISTA_OK) return status;
  vista_segmentation *const s = segmentation;
  const view w = {foveation, &params->segmentation, cells, surfaces, affinity, params->affinity.flow_scale};
  for (int32_t i = 0; i < foveation->node_count; ++i) {
    s->label[i] = VISTA_NO_LABEL;
    s->steps[i] = NOT_REACHED;
  }
  s->region_count = s->cut_count = s->cut_nodes = 0;

  status = vista_seeds_of_obstacles(foveation, w.params, camera, cells, surfaces, &s->seeds);
  if (status == VISTA_OK) status = cut_all(&w, s);
  if (status == VISTA_OK)
    s->region_count = vista_merge_regions(s->merge, foveation, w.params, camera, cells, s->label, s->region_count);
  s->obstacle_count = s->region_count;
  split_off_ground(&w, camera, s);
  if (status == VISTA_OK) status = vista_seeds_of_rest(foveation, w.params, affinity, surfaces, s->label, &s->seeds);
  if (status == VISTA_OK) status = cut_all(&w, s);
  return status;
}
