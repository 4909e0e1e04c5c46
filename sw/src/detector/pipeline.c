#include "vista/pipeline.h"

#include <math.h>
#include <stdbool.h>
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
#include "space/free_view.h"
#include "space/obstacle_map.h"
#include "space/path_view.h"

#define MAX_TRACKS 256
#define MAX_DETECTIONS 512

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
  STAGE_MAP,
  STAGE_PATH_VIEW,
  STAGE_FOOTING,
  STAGE_COUNT
} stage;

struct vista_pipeline {
  vista_team team;
  vista_parameters parameters;
  vista_camera camera;
  vista_matched_area matched; /* by the engine, with the levels of the last frame */
  vista_affinity_params affinity_params;     /* of the last frame: thresholds on grey levels against its noise */
  vista_refinement_params refinement_params; /* the same */
  vista_words_params words_params;           /* the same: of the size of chance matches */
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
  vista_detection *detections;
  vista_tracker *tracker;
  vista_blind_zone blind_zone;
  vista_terrain terrain;
  vista_obstacle_map *map;
  vista_region_verdict *verdicts; /* a region */
  vista_views views;
  double stage_ms[STAGE_COUNT], host_ms;
  double up_camera[3]; /* in the last frame */
  bool processed, up_known;
};

static const char *const stage_names[STAGE_COUNT] = {
    [STAGE_MOTION] = "motion",
    [STAGE_NOISE] = "noise",
    [STAGE_WORDS] = "words",
    [STAGE_FOVEATION] = "foveation",
    [STAGE_HEALTH] = "health",
    [STAGE_SURFACE] = "surface",
    [STAGE_AFFINITY] = "affinity",
    [STAGE_SEGMENTATION] = "segmentation",
    [STAGE_REFINEMENT] = "refinement",
    [STAGE_REGIONS] = "regions",
    [STAGE_THIN] = "thin",
    [STAGE_RECONSTRUCTION] = "reconstruction",
    [STAGE_TRACKING] = "tracking",
    [STAGE_BLIND_ZONE] = "blind_zone",
    [STAGE_TERRAIN] = "terrain",
    [STAGE_MAP] = "map",
    [STAGE_PATH_VIEW] = "path_view",
    [STAGE_FOOTING] = "footing",
};

int32_t vista_stage_count(void) { return STAGE_COUNT; }

const char *vista_stage_name(int32_t stage) {
  return stage >= 0 && stage < STAGE_COUNT ? stage_names[stage] : "unknown";
}

static vista_status first_error(const vista_status *statuses, int count) {
  for (int i = 0; i < count; ++i)
    if (statuses[i] != VISTA_OK) return statuses[i];
  return VISTA_OK;
}

static vista_status layout(vista_pipeline *p, vista_arena *arena) {
  const vista_parameters *const q = &p->parameters;
  const vista_camera *const c = &p->camera;
  vista_status status = vista_foveation_layout(&p->foveation, arena, &q->foveation, c->width_px, c->height_px,
                                               0.5 * (c->width_px - 1), 0.5 * (c->height_px - 1));
  if (status != VISTA_OK) return status;
  status = vista_team_layout(q->host.threads, arena, &p->team);
  if (status != VISTA_OK) return status;
  p->words.team = p->cells.team = p->regions.team = p->refinement.team = &p->team;
  p->detections = vista_arena_take(arena, MAX_DETECTIONS, sizeof(vista_detection));
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

static vista_matched_area matched_area(const vista_stereo_params *stereo, int32_t levels) {
  const int32_t radius = (stereo->block_size - 1) / 2;
  return (vista_matched_area){.disparity_max_px = (stereo->num_disparities - 1) << (levels - 1),
                              .margin_left_px = stereo->num_disparities - 1 + radius,
                              .margin_px = radius,
                              .coarser_levels = levels - 1};
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
  p->matched = matched_area(&p->parameters.stereo, 1);
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

/* Before anything changes. Time, pose and velocity are the first stage's to judge, which comes next. */
static vista_status check_frame(const vista_pipeline *p, const vista_frame *frame, int32_t *levels) {
  vista_status status = vista_frame_check_image(&frame->image, p->camera.width_px, p->camera.height_px);
  if (status == VISTA_OK) status = vista_words_count_levels(&p->words, &frame->disparity, frame->coarser, levels);
  return status == VISTA_OK && frame->up_world != NULL ? check_up(frame->up_world) : status;
}

/* Up in camera coordinates: R^T up_world. Without any pose nothing tells how the camera hangs: level, and false. */
static bool up_in_camera(const vista_motion *motion, const double *up_world, double up[3]) {
  static const double level[3] = {0.0, -1.0, 0.0};
  const bool known = up_world != NULL && motion->source != VISTA_MOTION_UNTOLD;
  if (known)
    vista_frame_direction_to_camera(&motion->pose, up_world, up);
  else
    memcpy(up, level, sizeof level);
  return known;
}

/* What one frame leads to on its way through the stages. */
typedef struct passage {
  const vista_frame *frame;
  vista_motion_state motion_state; /* the pipeline's, once the frame has passed */
  vista_motion motion;
  vista_image_noise noise;
  vista_flight_path path; /* flown next */
  vista_collision_volume volume; /* around it */
  vista_health health;
  double valid_fraction;
  double up_camera[3];
  bool up_known;
  double path_seen_m;
  int32_t detection_count;
  int64_t dropped_before; /* tracks, in earlier frames */
} passage;

/* Thresholds on grey levels of the stages that know none of the noise. */
static void set_thresholds(vista_pipeline *p, const vista_image_noise *noise) {
  const vista_parameters *const q = &p->parameters;
  p->affinity_params = q->affinity;
  p->affinity_params.mu_intensity =
      vista_image_noise_threshold(noise, q->affinity.mu_intensity, q->affinity.mu_intensity_noise);
  p->words_params = q->words;
  p->words_params.cluster_px =
      (int32_t)lround(vista_image_noise_threshold(noise, q->words.cluster_px, q->words.cluster_px_noise));
  p->words_params.cluster_far_px =
      (int32_t)lround(vista_image_noise_threshold(noise, q->words.cluster_far_px, q->words.cluster_px_noise));
  p->refinement_params = q->refinement;
  p->refinement_params.sigma_intensity =
      vista_image_noise_threshold(noise, q->refinement.sigma_intensity, q->refinement.sigma_intensity_noise);
}

static vista_status run_stage(vista_pipeline *p, stage stage, passage *way) {
  const vista_parameters *const q = &p->parameters;
  const vista_frame *const frame = way->frame;
  const double *const up = way->up_camera;
  const vista_disparity_image *const words = &p->words.image;
  switch (stage) {
    case STAGE_MOTION: {
      const vista_motion_input input = {frame->pose, frame->velocity_m_s, frame->stationary, frame->t_ns};
      const vista_status status = vista_motion_update(&q->motion, &input, &way->motion_state, &way->motion);
      if (status != VISTA_OK) return status;
      way->up_known = up_in_camera(&way->motion, frame->up_world, way->up_camera);
      way->path = vista_motion_path(&q->motion, &way->motion_state, &way->motion, q->obstacle_map.collision_length_m,
                                    q->obstacle_map.collision_radius_m);
      return VISTA_OK;
    }
    case STAGE_NOISE: {
      const vista_status status = vista_image_noise_measure(&frame->image, &way->noise);
      if (status == VISTA_OK) set_thresholds(p, &way->noise);
      return status;
    }
    case STAGE_WORDS:
      return vista_words_combine(&p->words_params, p->camera.baseline_m, q->stereo.num_disparities, &frame->disparity,
                                 frame->coarser, &p->words);
    case STAGE_FOVEATION:
      return vista_foveate(&p->foveation, &q->foveation, &frame->image, words, &p->cells);
    case STAGE_HEALTH: {
      const vista_ahead ahead = {&p->camera, &way->motion.pose, &way->path, way->up_known ? up : NULL,
                                 q->obstacle_map.collision_radius_m};
      return vista_health_judge(&q->health, &p->foveation, &p->matched, &p->cells, &way->noise, words, &way->motion,
                                &ahead, &way->health, &way->valid_fraction);
    }
    case STAGE_SURFACE:
      return vista_surfaces_compute(&p->foveation, &q->surface, &p->camera, up, &p->cells, &p->surfaces);
    case STAGE_AFFINITY:
      return vista_affinity_compute(&p->foveation, &p->affinity_params, &p->camera, &p->cells, &p->affinity);
    case STAGE_SEGMENTATION:
      return vista_segment(&p->foveation, q, &p->camera, &p->cells, &p->surfaces, &p->affinity, &p->segmentation);
    case STAGE_REFINEMENT:
      return vista_refine(&p->foveation, &p->refinement_params, &p->cells, p->segmentation.label, &p->refinement);
    case STAGE_REGIONS: {
      vista_status status =
          vista_regions_compute(&p->foveation, &q->region, &p->camera, up, q->surface.horizontal_deg, &p->matched,
                                words, &p->cells, &p->surfaces, &p->segmentation, &p->refinement, &p->regions);
      if (status == VISTA_OK)
        status = vista_row_edges_judge(&p->foveation, &q->region, &frame->image, &way->noise, &p->cells, &p->regions);
      if (status != VISTA_OK) return status;
      way->volume = vista_collision_volume_around(&q->obstacle_map, &way->path, &way->motion.pose);
      return vista_collision_volume_count(&p->foveation, &q->region, &p->camera, &way->volume, words, &p->cells,
                                          &p->regions);
    }
    case STAGE_THIN: {
      const vista_surfaces *const s = &p->surfaces;
      const vista_thin_view view = {&frame->image,   &frame->disparity, way->noise, (q->stereo.block_size - 1) / 2,
                                    s->ground_found, s->ground};
      return vista_thin_search(&q->thin, &p->camera, &view, p->thin);
    }
    case STAGE_RECONSTRUCTION: {
      vista_status status =
          vista_reconstruct_regions(p->regions.items, p->regions.count, &p->camera, &p->matched, &q->reconstruction,
                                    p->detections, MAX_DETECTIONS - VISTA_THIN_MAX, &way->detection_count);
      if (status == VISTA_ERROR_CAPACITY) status = VISTA_OK; /* the nearest come first: the far ones are dropped */
      int32_t line_count;
      const vista_thin_line *const lines = vista_thin_lines(p->thin, &line_count);
      if (status == VISTA_OK)
        status = vista_thin_reconstruct(lines, line_count, &p->camera, &way->volume, &q->reconstruction,
                                        p->regions.count, p->detections, MAX_DETECTIONS, &way->detection_count);
      return status;
    }
    case STAGE_TRACKING:
      if (way->motion.restarted) vista_tracker_reset(p->tracker);
      way->dropped_before = vista_tracker_dropped(p->tracker);
      return vista_tracker_update(p->tracker, &q->tracker, &p->camera, &p->matched, &way->motion, frame->t_ns, words,
                                  p->detections, way->detection_count);
    case STAGE_BLIND_ZONE:
      return vista_blind_zone_update(&q->blind_zone, &p->camera, &p->matched, q->obstacle_map.collision_radius_m,
                                     &frame->image, &way->noise, words, &p->blind_zone);
    case STAGE_TERRAIN:
      return vista_terrain_update(&p->terrain, &p->foveation, q, &p->camera, &p->matched, up, &way->motion, &way->path,
                                  frame->t_ns, &p->cells);
    case STAGE_MAP: {
      int32_t count;
      const vista_track *const tracks = vista_tracker_tracks(p->tracker, &count);
      return vista_obstacle_map_update(p->map, &q->obstacle_map, &p->camera, &way->motion, &way->path, &p->blind_zone,
                                       &p->terrain, tracks, count);
    }
    case STAGE_PATH_VIEW:
      return vista_path_view(&q->obstacle_map, &p->camera, &p->matched, &way->path, &way->motion.pose, words,
                             p->refinement.label, &p->regions, &way->path_seen_m);
    case STAGE_FOOTING:
      return vista_footing_clear(&q->region, &p->camera, words, &p->surfaces, &p->regions, &p->refinement);
    case STAGE_COUNT:
      break;
  }
  return VISTA_ERROR_RANGE;
}

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
    {{1, {STAGE_SEGMENTATION}}, {3, {STAGE_THIN, STAGE_BLIND_ZONE, STAGE_TERRAIN}}},
    {{2, {STAGE_REFINEMENT, STAGE_REGIONS}}},
    {{3, {STAGE_RECONSTRUCTION, STAGE_TRACKING, STAGE_MAP}}, {2, {STAGE_PATH_VIEW, STAGE_FOOTING}}},
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
    w->statuses[part] = run_stage(w->pipeline, l->stages[k], w->way);
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
  memcpy(p->up_camera, way->up_camera, sizeof p->up_camera);
  p->up_known = way->up_known;
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
  int32_t levels;
  vista_status status = check_frame(p, &f, &levels);
  if (status == VISTA_OK) p->matched = matched_area(&p->parameters.stereo, levels);
  passage way = {.frame = &f, .motion_state = p->motion_state};
  if (status == VISTA_OK) status = run_stages(p, &way);
  if (status != VISTA_OK) return status;
  vista_result r = {.obstacle_bytes = sizeof(vista_obstacle),
                    .nearest_collision = vista_obstacle_map_nearest(p->map),
                    .motion = way.motion,
                    .health = way.health,
                    .valid_fraction = way.valid_fraction,
                    .region_count = p->regions.count,
                    .accepted_count = p->regions.accepted_count,
                    .dropped_tracks = vista_tracker_dropped(p->tracker) - way.dropped_before,
                    .stage_count = STAGE_COUNT,
                    .stage_ms = p->stage_ms,
                    .host_ms = p->host_ms,
                    .views = &p->views,
                    .path_seen_m = way.path_seen_m};
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
  memcpy(directions->up_camera, p->up_camera, sizeof directions->up_camera);
  directions->up_known = p->up_known;
  return vista_free_view(&p->parameters.obstacle_map, &p->camera, &p->matched, &p->words.image, p->refinement.label,
                         &p->regions, directions);
}

vista_pipeline_stages vista_pipeline_look(const vista_pipeline *pipeline) {
  return (vista_pipeline_stages){&pipeline->foveation, &pipeline->cells,   &pipeline->surfaces,
                                 &pipeline->affinity,  &pipeline->regions, &pipeline->refinement_params,
                                 &pipeline->matched};
}
