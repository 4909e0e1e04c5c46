#include "perceive/region/region.h"

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "common/depth.h"
#include "common/grouping.h"
#include "common/word_blocks.h"
#include "perceive/region/region_boundary.h"
#include "perceive/scales.h"

#define STANDING_MIN_FRACTION 0.3 /* a region of which less stands min_height_m above the ground lies on it */

static const char *const verdict_names[VISTA_REGION_VERDICT_COUNT] = {
    [VISTA_REGION_ACCEPTED] = "ACCEPTED",
    [VISTA_REGION_UNKNOWN] = "UNKNOWN",
    [VISTA_REGION_TOO_FEW_PIXELS] = "TOO_FEW_PIXELS",
    [VISTA_REGION_INCONSISTENT] = "INCONSISTENT",
    [VISTA_REGION_HORIZONTAL] = "HORIZONTAL",
    [VISTA_REGION_TOO_FAR] = "TOO_FAR",
    [VISTA_REGION_TOO_SMALL] = "TOO_SMALL",
};

const char *vista_region_verdict_name(vista_region_verdict verdict) {
  return (unsigned)verdict < VISTA_REGION_VERDICT_COUNT ? verdict_names[verdict] : "INVALID";
}

vista_status vista_regions_layout(vista_regions *regions, vista_arena *arena, const vista_foveation *foveation) {
  const size_t nodes = (size_t)foveation->max_nodes;
  regions->items = vista_arena_take(arena, nodes, sizeof(vista_region));
  regions->first_member = vista_arena_take(arena, nodes + 1, sizeof(int32_t));
  regions->members = vista_arena_take(arena, nodes, sizeof(int32_t));
  regions->queue = vista_arena_take(arena, nodes, sizeof(int32_t));
  regions->boundary = vista_arena_take(arena, nodes, sizeof(uint8_t));
  regions->depth_px = vista_arena_take(arena, nodes, sizeof(float));
  for (int32_t k = 0; k < vista_team_workers(regions->team); ++k) {
    regions->pixels[k] = vista_arena_take(
        arena, (size_t)foveation->width_px * (size_t)foveation->height_px + VISTA_WORD_BLOCK, sizeof(int16_t));
    regions->bins[k] = vista_arena_take(arena, 2 * VISTA_ALL_WORDS, sizeof(uint32_t));
  }
  return arena->base != NULL && arena->used > arena->size ? VISTA_ERROR_MEMORY : VISTA_OK;
}

/* Nodes with an edge that leaves their region, and those of the region within reach of one. */
static void mark_boundary(const vista_foveation *foveation, const int32_t *label, double reach_px,
                          vista_regions *regions) {
  const vista_graph *const graph = &foveation->graph;
  int32_t *const queue = regions->queue;
  int32_t count = 0;
  for (int32_t i = 0; i < graph->node_count; ++i) {
    bool leaves = false;
    for (int32_t arc = graph->first_arc[i]; arc < graph->first_arc[i + 1]; ++arc)
      leaves |= label[graph->head[arc]] != label[i];
    regions->boundary[i] = leaves && label[i] >= 0;
    regions->depth_px[i] = 0.0f;
    if (regions->boundary[i]) queue[count++] = i;
  }
  for (int32_t next = 0; next < count; ++next) {
    const int32_t i = queue[next];
    for (int32_t arc = graph->first_arc[i]; arc < graph->first_arc[i + 1]; ++arc) {
      const int32_t j = graph->head[arc];
      const float depth_px = regions->depth_px[i] + foveation->arc_distance_px[arc];
      if (regions->boundary[j] || label[j] != label[i] || depth_px > (float)reach_px) continue;
      regions->boundary[j] = 1;
      regions->depth_px[j] = depth_px;
      queue[count++] = j;
    }
  }
}

/* Matching widens every thing by boundary_px at each side: a mast below a panel weighs several times what it has. Of
 * long regions only their inner pixels count, unless few are left. */
#define LONG_BLOCKS 20.0
#define MIN_INNER_SHARE 0.2
#define OWN_SHARE 0.5 /* of the fewest inliers of a boundary, that the own pixels are at least */

/* No more than the smallest obstacle has at that range: far things are small, and soon seen better or refuted. */
static double fewest_inliers(const vista_region_params *params, const vista_camera *camera, double disparity_px) {
  const double smallest_px = params->min_size_m * disparity_px / camera->baseline_m;
  return fmin(VISTA_HALF_BLOCK_PX2, smallest_px * smallest_px);
}

/* What only the own pixels tell. Cheap tests come first: this is measured of what passed them. */
static vista_region_verdict measure_own_pixels(const vista_region_view *w, const vista_plane *surface,
                                               vista_region *region) {
  const vista_camera *const camera = w->frame->camera;
  vista_region_find_pixels(w, surface, region);
  const double fewest = OWN_SHARE * fewest_inliers(w->params, camera, region->disparity_px);
  if (region->pixel_count < fewest) return VISTA_REGION_TOO_FEW_PIXELS;
  const double longer_px = 4.0 * sqrt(fmax(region->cov_uu_px2, region->cov_vv_px2));
  if (longer_px > LONG_BLOCKS * VISTA_BOUNDARY_PX) {
    const vista_region all = *region;
    vista_region_keep_inner_pixels(w, surface, region);
    if (region->pixel_count < MIN_INNER_SHARE * all.pixel_count) *region = all;
  }
  region->disparity_px = vista_plane_at(surface, region->mean_u_px, region->mean_v_px);
  if (region->disparity_px < w->params->min_disparity_px) return VISTA_REGION_TOO_FAR;
  const double larger_px = 4.0 * sqrt(fmax(region->cov_uu_px2, region->cov_vv_px2));
  const float smallest_m = vista_limit_m(camera, (float)region->disparity_px, (float)w->params->min_size_m);
  if (larger_px * camera->baseline_m / region->disparity_px < (double)smallest_m) return VISTA_REGION_TOO_SMALL;
  return VISTA_REGION_ACCEPTED;
}

/* The foot is that of a box with the spread of the pixels, and no lower than any of them: a few that are off do not
 * move it. */
static void find_foot(const vista_surfaces *surfaces, const vista_camera *camera, vista_region *region) {
  if (!surfaces->ground_found) return;
  const double down_px = fmin(region->max_v_px - region->mean_v_px, sqrt(3.0 * region->cov_vv_px2));
  const double aside_px = region->cov_vv_px2 > 0.0 ? region->cov_uv_px2 / region->cov_vv_px2 * down_px : 0.0;
  const double u_px = region->mean_u_px + aside_px, v_px = region->mean_v_px + down_px;
  const double own_px = region->disparity_px + region->slope_u * aside_px + region->slope_v * down_px;
  region->foot_seen = own_px > 0.0;
  if (region->foot_seen) region->foot_share = vista_plane_share_above(&surfaces->ground, camera, u_px, v_px, own_px);
}

static vista_region empty_region(int32_t label, int32_t node_count) {
  return (vista_region){
      .label = label, .node_count = node_count, .inclination_deg = NAN, .standing_fraction = NAN, .top_fraction = NAN};
}

/* Weighs what the region's words say. */
static vista_region_verdict measure(vista_region_view *w, bool seeded, vista_region *region) {
  const vista_camera *const camera = w->frame->camera;
  vista_plane surface;
  if (!vista_region_measure_boundary(w, region, &surface)) return VISTA_REGION_UNKNOWN;
  const vista_region_params *const p = w->params;
  vista_region_weigh(w, seeded, region);
  if (region->valid_fraction < VISTA_REGION_VALID_MIN_FRACTION) return VISTA_REGION_UNKNOWN;
  if (region->boundary_inliers < fewest_inliers(p, camera, region->disparity_px)) return VISTA_REGION_TOO_FEW_PIXELS;
  const bool leans = region->inclination_deg > VISTA_HORIZONTAL_DEG;
  if (region->standing_fraction < STANDING_MIN_FRACTION || (leans && !w->surfaces->ground_found))
    return VISTA_REGION_HORIZONTAL;
  if (region->evidence.sum < 0.0)
    return region->evidence.lean < 0.0 ? VISTA_REGION_HORIZONTAL : VISTA_REGION_INCONSISTENT;
  return measure_own_pixels(w, &surface, region);
}

/* A region without disparities inside may be plain: only its outline tells. */
static vista_region_verdict measure_outline(vista_region_view *w, const int32_t *label, vista_region *region) {
  vista_plane surface;
  *region = empty_region(region->label, region->node_count);
  if (!vista_region_owns_outline(w, label, region, &surface) ||
      region->boundary_inliers < fewest_inliers(w->params, w->frame->camera, region->disparity_px))
    return VISTA_REGION_UNKNOWN;
  return measure_own_pixels(w, &surface, region);
}

typedef struct job {
  const vista_frame_view *frame;
  const vista_cells *cells;
  const vista_surfaces *surfaces;
  const vista_partition *partition;
  vista_regions *regions;
} job;

static void prepare_part(void *context, int32_t part, int32_t worker) {
  (void)worker;
  const job *const j = context;
  if (part == 0)
    mark_boundary(j->frame->foveation, j->partition->region_of_cell, VISTA_BOUNDARY_PX, j->regions);
  else
    vista_group(j->partition->region_of_cell, NULL, j->frame->foveation->node_count, j->regions->count,
                j->regions->first_member, j->regions->members);
}

static void judge_part(void *context, int32_t part, int32_t worker) {
  const job *const j = context;
  vista_regions *const regions = j->regions;
  const int32_t k = part, first = regions->first_member[k], count = regions->first_member[k + 1] - first;
  vista_region_view w = {.frame = j->frame,
                         .foveation = j->frame->foveation,
                         .params = &j->frame->params->region,
                         .cells = j->cells,
                         .surfaces = j->surfaces,
                         .region_of_listed = j->partition->drawn->listed,
                         .boundary = regions->boundary,
                         .mixed = j->partition->drawn->border,
                         .bins = regions->bins[worker],
                         .pixels = regions->pixels[worker],
                         .members = regions->members + first,
                         .member_count = count};
  vista_region *const region = &regions->items[k];
  *region = empty_region(k, count);
  if (count == 0)
    region->verdict = VISTA_REGION_UNKNOWN;
  else {
    const bool seeded = k < j->partition->obstacle_count;
    region->verdict = measure(&w, seeded, region);
    if (!seeded && (region->verdict == VISTA_REGION_UNKNOWN || region->verdict == VISTA_REGION_TOO_FEW_PIXELS))
      region->verdict = measure_outline(&w, j->partition->region_of_cell, region);
  }
  if (region->verdict == VISTA_REGION_ACCEPTED) find_foot(j->surfaces, j->frame->camera, region);
}

void vista_regions_compute(const vista_frame_view *frame, const vista_cells *cells, const vista_surfaces *surfaces,
                           const vista_partition *partition, vista_regions *regions) {
  regions->count = partition->region_count;
  regions->accepted_count = 0;
  job j = {frame, cells, surfaces, partition, regions};
  vista_team_share(regions->team, prepare_part, &j, 2);
  vista_team_share(regions->team, judge_part, &j, regions->count);
  for (int32_t k = 0; k < regions->count; ++k)
    regions->accepted_count += regions->items[k].verdict == VISTA_REGION_ACCEPTED;
}
