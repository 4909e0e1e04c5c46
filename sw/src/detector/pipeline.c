#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include "common/clock.h"
#include "common/frame.h"
#include "common/image_noise.h"
#include "common/parameters_check.h"
#include "common/team.h"
#include "detector/pipeline_stages.h"
#include "follow/motion.h"
#include "follow/tracker.h"
#include "health/health.h"
#include "perceive/cells/affinity.h"
#include "perceive/cells/surface.h"
#include "perceive/cut/refinement.h"
#include "perceive/cut/segmentation.h"
#include "perceive/line/thin.h"
#include "perceive/line/thin_reconstruction.h"
#include "perceive/region/footing.h"
#include "perceive/region/reconstruction.h"
#include "perceive/terrain/terrain.h"
#include "perceive/words/blind_zone.h"
#include "perceive/words/row_edges.h"
#include "perceive/words/words.h"
#include "space/collision_volume.h"
#include "space/free_directions.h"
#include "space/obstacle_map.h"
#include "space/path_places.h"
#include "space/space_map.h"
#include "vista/pipeline.h"

#define MAX_TRACKS 256
/* The time of the association grows with the cube of these numbers. Ordinary frames have at most 86 of both kinds. */
#define MAX_REGIONS 96
#define MAX_DETECTIONS (MAX_REGIONS + VISTA_THIN_MAX)

/* No header ever had fewer: what an older caller knows of. */
#define FRAME_FEWEST_BYTES (offsetof(vista_frame, t_ns) + sizeof(int64_t))
#define RESULT_FEWEST_BYTES offsetof(vista_result, motion)

typedef enum stage {
  STAGE_MOTION,
  STAGE_NOISE,
  STAGE_WORDS,
  STAGE_FOVEATION,
  STAGE_HEALTH,
  STAGE_SURFACE,
  STAGE_AFFINITY,
  STAGE_SEGMENTATION,
  STAGE_REFINEMENT,
  STAGE_REGIONS,
  STAGE_THIN,
  STAGE_RECONSTRUCTION,
  STAGE_TRACKING,
  STAGE_BLIND_ZONE,
  STAGE_TERRAIN,
  STAGE_SPACE,
  STAGE_MAP,
  STAGE_FOOTING,
  STAGE_COUNT
} stage;

struct vista_pipeline {
  vista_team team;
  vista_parameters parameters;
  vista_camera camera;
  vista_frame_view frame; /* the last one, without its images */
  vista_motion_state motion_state;
  vista_words words;
  vista_foveation foveation;
  vista_cells cells;
  vista_surfaces surfaces;
  vista_affinity affinity;
  vista_segmentation segmentation;
  vista_refinement refinement;
  vista_regions regions;
  vista_thin *thin;
  vista_detections detections;
  vista_tracker *tracker;
  vista_blind_zone blind_zone;
  vista_terrain terrain;
  vista_space_map space;
  vista_path_places places; /* of the last frame */
  vista_obstacle_map *map;
  vista_region_verdict *verdicts; /* a region */
  vista_views views;
  double stage_ms[STAGE_COUNT], host_ms;
  bool processed;
};

static vista_status first_error(const vista_status *statuses, int count) {
  for (int i = 0; i < count; ++i)
    if (statuses[i] != VISTA_OK) return statuses[i];
  return VISTA_OK;
}

static vista_status layout(vista_pipeline *p, vista_arena *arena) {
  const vista_parameters *const q = &p->parameters;
  const vista_camera *const c = &p->camera;
  const vista_fovea middle = {c->width_px, c->height_px, 0.5 * (c->width_px - 1), 0.5 * (c->height_px - 1)};
  vista_status status = vista_foveation_layout(&p->foveation, arena, &q->foveation, &middle);
  if (status != VISTA_OK) return status;
  status = vista_team_layout(q->host.threads, arena, &p->team);
  if (status != VISTA_OK) return status;
  p->words.team = p->cells.team = p->regions.team = p->refinement.team = &p->team;
  p->detections.items = vista_arena_take(arena, MAX_DETECTIONS, sizeof(vista_detection));
  p->verdicts = vista_arena_take(arena, (size_t)p->foveation.max_nodes, sizeof(vista_region_verdict));
  const vista_status statuses[] = {
      vista_words_layout(&p->words, arena, c->width_px, c->height_px),
      vista_cells_layout(&p->cells, arena, &p->foveation),
      vista_surfaces_layout(&p->surfaces, arena, &p->foveation),
      vista_affinity_layout(&p->affinity, arena, &p->foveation),
      vista_segmentation_layout(&p->segmentation, arena, &p->foveation),
      vista_refinement_layout(&p->refinement, arena, &p->foveation),
      vista_regions_layout(&p->regions, arena, &p->foveation),
      vista_thin_layout(&p->thin, arena, c->width_px, c->height_px),
      vista_tracker_layout(MAX_TRACKS, MAX_DETECTIONS, arena, &p->tracker),
      vista_terrain_layout(&p->terrain, arena, &p->foveation),
      vista_space_map_layout(&p->space, arena, c),
      vista_obstacle_map_layout(MAX_TRACKS, arena, &p->map),
  };
  status = first_error(statuses, sizeof statuses / sizeof statuses[0]);
  if (status == VISTA_OK && arena->base != NULL && arena->used > arena->size) status = VISTA_ERROR_MEMORY;
  return status;
}

static vista_status check(const vista_parameters *parameters, const vista_camera *camera) {
  const vista_status status = vista_parameters_check(parameters, NULL);
  if (status != VISTA_OK) return status;
  const bool has_size = camera->width_px > 0 && camera->height_px > 0; /* named first: the centre depends on it */
  if (has_size && !vista_foveation_handles(camera->width_px, camera->height_px)) return VISTA_ERROR_SIZE;
  return vista_frame_check_camera(camera);
}

vista_status vista_pipeline_bytes(const vista_parameters *parameters, const vista_camera *camera, size_t *bytes) {
  if (parameters == NULL || camera == NULL || bytes == NULL) return VISTA_ERROR_ARGUMENT;
  vista_status status = check(parameters, camera);
  if (status != VISTA_OK) return status;
  vista_pipeline trial = {.parameters = vista_parameters_own(parameters), .camera = *camera};
  vista_arena arena = {0};
  (void)vista_arena_take(&arena, 1, sizeof trial);
  status = layout(&trial, &arena);
  *bytes = arena.used + VISTA_ARENA_ALIGNMENT; /* the caller's memory need not be aligned */
  return status;
}

vista_status vista_pipeline_create(void *memory, size_t bytes, const vista_parameters *parameters,
                                   const vista_camera *camera, vista_pipeline **pipeline) {
  if (memory == NULL || parameters == NULL || camera == NULL || pipeline == NULL) return VISTA_ERROR_ARGUMENT;
  const vista_status status = check(parameters, camera);
  if (status != VISTA_OK) return status;
  vista_arena arena = {.base = memory, .size = bytes};
  vista_pipeline *const p = vista_arena_take(&arena, 1, sizeof *p);
  if (p == NULL) return VISTA_ERROR_MEMORY;
  p->parameters = vista_parameters_own(parameters);
  p->camera = *camera;
  vista_status made = layout(p, &arena);
  if (made == VISTA_OK) made = vista_team_start(&p->team);
  if (made != VISTA_OK) return made;
  p->views = (vista_views){.width_px = camera->width_px,
                           .height_px = camera->height_px,
                           .cell_count = p->foveation.node_count,
                           .cell_of_pixel = p->foveation.cell_of_pixel,
                           .cell_intensity = p->cells.intensity,
                           .cell_disparity_px = p->cells.disparity_px,
                           .region_of_cell = p->segmentation.label,
                           .region_of_pixel = p->refinement.label,
                           .verdict_of_region = p->verdicts,
                           .words = p->words.image.data};
  *pipeline = p;
  return VISTA_OK;
}

void vista_pipeline_destroy(vista_pipeline *pipeline) {
  if (pipeline != NULL) vista_team_stop(&pipeline->team);
}

void vista_pipeline_reset(vista_pipeline *pipeline) {
  vista_tracker_reset(pipeline->tracker);
  vista_space_map_reset(&pipeline->space);
  vista_obstacle_map_reset(pipeline->map);
  pipeline->motion_state = (vista_motion_state){0};
  pipeline->blind_zone = (vista_blind_zone){0};
  vista_terrain_reset(&pipeline->terrain);
}

static vista_status check_up(const double up_world[3]) {
  double square = 0.0;
  for (int i = 0; i < 3; ++i) square += up_world[i] * up_world[i];
  if (!isfinite(square)) return VISTA_ERROR_NUMBER;
  return fabs(square - 1.0) < 1e-3 ? VISTA_OK : VISTA_ERROR_RANGE;
}

/* Checks a frame before anything changes. Time, pose and velocity are judged by the first stage, which comes next. */
static vista_status check_frame(const vista_pipeline *p, const vista_frame *frame) {
  int32_t levels;
  const bool seen = frame->image.data != NULL || frame->image.width_px != 0 || frame->image.height_px != 0;
  vista_status status =
      seen ? vista_frame_check_image(&frame->image, p->camera.width_px, p->camera.height_px) : VISTA_OK;
  if (status == VISTA_OK) status = vista_words_count_levels(&p->words, &frame->disparity, frame->coarser, &levels);
  return status == VISTA_OK && frame->up_world != NULL ? check_up(frame->up_world) : status;
}

/* What one frame leads to on its way through the stages. */
typedef struct passage {
  const vista_frame *given;
  vista_motion_state motion_state; /* the pipeline's, once the frame has passed */
  vista_frame_view frame;
  vista_health health;
  double valid_fraction;
  vista_collision_volume volume;
  int64_t dropped_before; /* tracks, in earlier frames */
  double path_seen_m, collision_probability;
  bool crowded; /* regions that were accepted are not followed */
} passage;

/* ---- the stages ---- */

static vista_status begin(vista_pipeline *p, passage *way) {
  const vista_status status =
      vista_pipeline_begin(&p->parameters, &p->camera, way->given, &way->motion_state, &way->frame);
  way->frame.foveation = &p->foveation;
  way->frame.words = p->words.image;
  return status;
}

static vista_status measure_noise(vista_pipeline *p, passage *way) {
  (void)p;
  return vista_image_noise_measure(&way->frame.image, &way->frame.noise);
}

static vista_status combine_words(vista_pipeline *p, passage *way) {
  vista_words_combine(&way->frame, &p->words);
  return VISTA_OK;
}

static vista_status foveate(vista_pipeline *p, passage *way) {
  vista_foveate(&way->frame, &p->cells);
  return VISTA_OK;
}

static vista_status judge_health(vista_pipeline *p, passage *way) {
  vista_health_judge(&way->frame, &p->cells, &way->health, &way->valid_fraction);
  return VISTA_OK;
}

static vista_status find_surfaces(vista_pipeline *p, passage *way) {
  vista_surfaces_compute(&way->frame, &p->cells, &p->surfaces);
  return VISTA_OK;
}

static vista_status compare_cells(vista_pipeline *p, passage *way) {
  vista_affinity_compute(&way->frame, &p->cells, &p->affinity);
  return VISTA_OK;
}

static vista_status segment(vista_pipeline *p, passage *way) {
  return vista_segment(&way->frame, &p->cells, &p->surfaces, &p->affinity, &p->segmentation);
}

static vista_status refine(vista_pipeline *p, passage *way) {
  vista_refine(&way->frame, &p->cells, p->segmentation.label, &p->refinement);
  return VISTA_OK;
}

static vista_status judge_regions(vista_pipeline *p, passage *way) {
  const vista_segmentation *const s = &p->segmentation;
  const vista_partition partition = {s->label, s->region_count, s->obstacle_count, &p->refinement};
  vista_regions_compute(&way->frame, &p->cells, &p->surfaces, &partition, &p->regions);
  vista_row_edges_judge(&way->frame, &p->cells, &p->regions);
  way->volume = vista_collision_volume_around(&way->frame);
  vista_collision_volume_count(&way->frame, &way->volume, &p->cells, &p->regions);
  return VISTA_OK;
}

static vista_status find_thin_things(vista_pipeline *p, passage *way) {
  vista_thin_search(&way->frame, &p->surfaces, p->thin);
  return VISTA_OK;
}

static vista_status reconstruct(vista_pipeline *p, passage *way) {
  p->detections.capacity = MAX_REGIONS;
  vista_status status = vista_reconstruct_regions(&way->frame, p->regions.items, p->regions.count, &p->detections);
  way->crowded = status == VISTA_ERROR_CAPACITY; /* the nearest are kept */
  if (status != VISTA_OK && !way->crowded) return status;
  p->detections.capacity = MAX_DETECTIONS;
  const vista_thin_lines lines = vista_thin_found(p->thin);
  return vista_thin_reconstruct(&way->frame, &lines, &way->volume, p->regions.count, &p->detections);
}

static vista_status track(vista_pipeline *p, passage *way) {
  if (way->frame.motion.restarted) vista_tracker_reset(p->tracker);
  way->dropped_before = vista_tracker_dropped(p->tracker);
  return vista_tracker_update(p->tracker, &way->frame, &p->detections);
}

static vista_status watch_blind_zone(vista_pipeline *p, passage *way) {
  vista_blind_zone_update(&way->frame, &p->blind_zone);
  return VISTA_OK;
}

static vista_status find_terrain(vista_pipeline *p, passage *way) {
  vista_terrain_update(&way->frame, &p->cells, &p->terrain);
  return VISTA_OK;
}

static vista_status look_along_path(vista_pipeline *p, passage *way) {
  if (way->frame.motion.restarted) vista_space_map_reset(&p->space);
  const vista_thin_lines lines = vista_thin_found(p->thin);
  vista_space_map_add(&p->space, &way->frame, &p->surfaces, &lines);
  vista_path_places_look(&way->frame, &p->space, &p->places);
  return VISTA_OK;
}

/* How likely something is where the nearest collision is. The places of the last frames say nothing of what moves, nor of
 * what is too near to match. */
static double collision_probability(const vista_pipeline *p) {
  const vista_nearest_collision nearest = vista_obstacle_map_nearest(p->map);
  int32_t count;
  const vista_obstacle *const obstacles = vista_obstacle_map_obstacles(p->map, &count);
  if (!nearest.valid) return NAN;
  for (int32_t i = 0; i < count; ++i) {
    const vista_obstacle *const o = &obstacles[i];
    if (o->id == nearest.id && (o->kind == VISTA_OBSTACLE_TOO_NEAR || o->world == VISTA_WORLD_MOVES)) return NAN;
  }
  return vista_path_places_probability(&p->places, nearest.distance_m);
}

static vista_status make_map(vista_pipeline *p, passage *way) {
  vista_map_input input = {
      .terrain = &p->terrain, .blind_zone = &p->blind_zone, .space = &p->space, .places = &p->places};
  input.tracks = vista_tracker_tracks(p->tracker, &input.track_count);
  vista_obstacle_map_update(p->map, &way->frame, &input);
  way->path_seen_m = vista_obstacle_map_free_m(p->map);
  way->collision_probability = collision_probability(p);
  return VISTA_OK;
}

static vista_status clear_footing(vista_pipeline *p, passage *way) {
  vista_footing_clear(&way->frame, &p->surfaces, &p->regions, &p->refinement);
  return VISTA_OK;
}

static const struct {
  const char *name;
  vista_status (*run)(vista_pipeline *p, passage *way);
} stages[STAGE_COUNT] = {
    [STAGE_MOTION] = {"motion", begin},
    [STAGE_NOISE] = {"noise", measure_noise},
    [STAGE_WORDS] = {"words", combine_words},
    [STAGE_FOVEATION] = {"foveation", foveate},
    [STAGE_HEALTH] = {"health", judge_health},
    [STAGE_SURFACE] = {"surface", find_surfaces},
    [STAGE_AFFINITY] = {"affinity", compare_cells},
    [STAGE_SEGMENTATION] = {"segmentation", segment},
    [STAGE_REFINEMENT] = {"refinement", refine},
    [STAGE_REGIONS] = {"regions", judge_regions},
    [STAGE_THIN] = {"thin", find_thin_things},
    [STAGE_RECONSTRUCTION] = {"reconstruction", reconstruct},
    [STAGE_TRACKING] = {"tracking", track},
    [STAGE_BLIND_ZONE] = {"blind_zone", watch_blind_zone},
    [STAGE_TERRAIN] = {"terrain", find_terrain},
    [STAGE_SPACE] = {"space", look_along_path},
    [STAGE_MAP] = {"map", make_map},
    [STAGE_FOOTING] = {"footing", clear_footing},
};

int32_t vista_stage_count(void) { return STAGE_COUNT; }

const char *vista_stage_name(int32_t stage) {
  return stage >= 0 && stage < STAGE_COUNT ? stages[stage].name : "unknown";
}

/* ---- their order ---- */

#define LANES 2
#define LANE_STAGES 4

/* Stages that are done one after the other. */
typedef struct lane {
  int count;
  stage stages[LANE_STAGES];
} lane;

/* The steps of a frame. No lane of a step touches what the other lane writes, so two threads may do them at once. In a
 * step of one lane the stages may share their own work between the threads. */
static const lane schedule[][LANES] = {
    {{4, {STAGE_MOTION, STAGE_NOISE, STAGE_WORDS, STAGE_FOVEATION}}},
    {{1, {STAGE_SURFACE}}, {2, {STAGE_AFFINITY, STAGE_HEALTH}}},
    {{1, {STAGE_SEGMENTATION}}, {4, {STAGE_THIN, STAGE_BLIND_ZONE, STAGE_TERRAIN, STAGE_SPACE}}},
    {{2, {STAGE_REFINEMENT, STAGE_REGIONS}}},
    {{3, {STAGE_RECONSTRUCTION, STAGE_TRACKING, STAGE_MAP}}, {1, {STAGE_FOOTING}}},
};

typedef struct work {
  vista_pipeline *pipeline;
  passage *way;
  const lane *lanes;
  vista_status statuses[LANES];
  double stage_ms[STAGE_COUNT];
} work;

static void run_lane(void *context, int32_t part, int32_t worker) {
  (void)worker;
  work *const w = context;
  const lane *const l = &w->lanes[part];
  double last_ms = vista_clock_ms();
  w->statuses[part] = VISTA_OK;
  for (int k = 0; k < l->count && w->statuses[part] == VISTA_OK; ++k) {
    w->statuses[part] = stages[l->stages[k]].run(w->pipeline, w->way);
    const double now_ms = vista_clock_ms();
    w->stage_ms[l->stages[k]] = now_ms - last_ms;
    last_ms = now_ms;
  }
}

static vista_status run_stages(vista_pipeline *p, passage *way) {
  work w = {.pipeline = p, .way = way};
  const double start_ms = vista_clock_ms();
  p->processed = false;
  for (size_t k = 0; k < sizeof schedule / sizeof schedule[0]; ++k) {
    w.lanes = schedule[k];
    vista_team_share(&p->team, run_lane, &w, w.lanes[1].count > 0 ? LANES : 1);
    const vista_status status = first_error(w.statuses, LANES);
    if (status != VISTA_OK) return status;
  }
  p->host_ms = vista_clock_ms() - start_ms;
  memcpy(p->stage_ms, w.stage_ms, sizeof p->stage_ms);
  p->motion_state = way->motion_state;
  p->frame = way->frame;
  p->frame.image = (vista_image){0};
  memset(p->frame.levels, 0, sizeof p->frame.levels);
  p->processed = true;
  p->views.region_count = p->regions.count;
  for (int32_t k = 0; k < p->regions.count; ++k) p->verdicts[k] = p->regions.items[k].verdict;
  return VISTA_OK;
}

vista_status vista_pipeline_process_sized(vista_pipeline *pipeline, const vista_frame *frame, size_t frame_bytes,
                                          vista_result *result, size_t result_bytes) {
  if (pipeline == NULL || frame == NULL || result == NULL) return VISTA_ERROR_ARGUMENT;
  if (frame_bytes < FRAME_FEWEST_BYTES || result_bytes < RESULT_FEWEST_BYTES) return VISTA_ERROR_SIZE;
  vista_pipeline *const p = pipeline;
  vista_frame f = {0};
  memcpy(&f, frame, frame_bytes < sizeof f ? frame_bytes : sizeof f);
  vista_status status = check_frame(p, &f);
  passage way = {.given = &f, .motion_state = p->motion_state};
  if (status == VISTA_OK) status = run_stages(p, &way);
  if (status != VISTA_OK) return status;
  const int64_t dropped = vista_tracker_dropped(p->tracker) - way.dropped_before;
  if (way.crowded || dropped > 0) vista_health_add(&way.health, VISTA_HEALTH_CROWDED);
  vista_result r = {.obstacle_bytes = sizeof(vista_obstacle),
                    .nearest_collision = vista_obstacle_map_nearest(p->map),
                    .motion = way.frame.motion,
                    .health = way.health,
                    .valid_fraction = way.valid_fraction,
                    .region_count = p->regions.count,
                    .accepted_count = p->regions.accepted_count,
                    .dropped_tracks = dropped,
                    .stage_count = STAGE_COUNT,
                    .stage_ms = p->stage_ms,
                    .host_ms = p->host_ms,
                    .views = &p->views,
                    .path_seen_m = way.path_seen_m,
                    .collision_probability = way.collision_probability};
  r.obstacles = vista_obstacle_map_obstacles(p->map, &r.obstacle_count);
  memset(result, 0, result_bytes);
  memcpy(result, &r, result_bytes < sizeof r ? result_bytes : sizeof r);
  return VISTA_OK;
}

vista_status vista_pipeline_directions(const vista_pipeline *pipeline, vista_directions *directions) {
  if (pipeline == NULL || directions == NULL) return VISTA_ERROR_ARGUMENT;
  const vista_pipeline *const p = pipeline;
  *directions = (vista_directions){.up_camera = {0.0, -1.0, 0.0}};
  if (!p->processed) return VISTA_OK;
  int32_t count;
  const vista_obstacle *const obstacles = vista_obstacle_map_obstacles(p->map, &count);
  vista_free_directions(&p->frame, &p->space, obstacles, vista_obstacle_map_faces(p->map), count, directions);
  return VISTA_OK;
}

vista_pipeline_stages vista_pipeline_look(const vista_pipeline *pipeline) {
  const vista_pipeline *const p = pipeline;
  vista_pipeline_stages stages = {.frame = &p->frame,
                                  .cells = &p->cells,
                                  .surfaces = &p->surfaces,
                                  .affinity = &p->affinity,
                                  .regions = &p->regions,
                                  .places = &p->places,
                                  .space = &p->space};
  stages.tracks = vista_tracker_tracks(p->tracker, &stages.track_count);
  stages.obstacles = vista_obstacle_map_obstacles(p->map, &stages.obstacle_count);
  stages.faces = vista_obstacle_map_faces(p->map);
  return stages;
}
