#include "vista/detector.h"

#include <string.h>

#include "common/arena.h"
#include "common/clock.h"
#include "common/parameters_check.h"
#include "detector/findings.h"
#include "detector/levels.h"
#include "detector/pipeline_stages.h"
#include "health/watch.h"
#include "vista/correction.h"
#include "vista/frontend.h"

/* How far the pair in work has come. */
typedef enum progress { PROGRESS_NONE = 0, PROGRESS_TAKEN, PROGRESS_MATCHED, PROGRESS_JUDGED } progress;

struct vista_detector {
  vista_rig rig;
  vista_detector_options options;
  vista_parameters parameters;
  vista_levels levels;
  vista_correction *correction; /* null: it is not asked for */
  vista_alignment *alignment; /* looks at the rows where they are not corrected; null: nor can they be looked at */
  vista_watch *watch; /* null: stills, which follow on nothing */
  double words_differ; /* share of the words from elsewhere that are not those of the images */
  vista_pipeline *pipeline;
  uint8_t *before[2]; /* raw images of the pair before; null: each pair is new */
  int64_t t_ns;       /* of the pair in work, or of the one before */
  bool began;         /* there is a pair before */
  bool placed;        /* a frame had a pose since the last reset */
  vista_detector_seen seen; /* of the last frame that was judged */
  progress progress;
  bool has_left, has_right;
  vista_pair_view view;
  char alignment_text[VISTA_FINDING_TEXT];
  double rectify_ms, match_ms;
};

/* ---- memory ---- */

typedef struct room {
  void *correction, *alignment, *pipeline;
  size_t correction_bytes, alignment_bytes, pipeline_bytes;
} room;

static vista_right_rectification right_of(const vista_rig *rig) {
  return (vista_right_rectification){.raw = rig->right,
                                     .grid = rig->tables[1].grid,
                                     .columns = vista_frontend_grid_points(rig->camera.width_px),
                                     .rows = vista_frontend_grid_points(rig->camera.height_px)};
}

/* Stills have no time to agree in, neither on a turn nor on an obstacle. */
static vista_parameters fitted(const vista_parameters *parameters, const vista_detector_options *options) {
  vista_parameters own = vista_parameters_own(parameters);
  if (!options->stills) return own;
  own.tracker.confirm_hits = own.tracker.confirm_window = 1;
  own.alignment.correct = VISTA_ALIGNMENT_CORRECT_OFF;
  return own;
}

static bool corrects(const vista_detector *d) { return d->parameters.alignment.correct == VISTA_ALIGNMENT_CORRECT_ON; }

static vista_status lay_out(vista_detector *d, vista_arena *arena, room *r) {
  const vista_camera *const camera = &d->rig.camera;
  const vista_right_rectification right = right_of(&d->rig);
  if (d->parameters.stereo.rectify_rows != d->rig.rectify_rows) return VISTA_ERROR_RANGE;
  vista_status status = vista_pipeline_bytes(&d->parameters, camera, &r->pipeline_bytes);
  if (status == VISTA_OK && corrects(d))
    status = vista_correction_bytes(&d->parameters, camera, &right, &r->correction_bytes);
  else if (status == VISTA_OK && vista_alignment_bytes(&d->parameters, camera, &r->alignment_bytes) != VISTA_OK)
    r->alignment_bytes = 0; /* images that are too small for it */
  if (status == VISTA_OK) status = vista_levels_layout(&d->levels, arena, &d->parameters.stereo, camera);
  if (status != VISTA_OK) return status;
  for (int side = 0; side < 2 && !d->options.every_pair && !d->options.stills; ++side)
    d->before[side] = vista_arena_take(arena, (size_t)camera->width_px * (size_t)camera->height_px, 1);
  if (!d->options.stills) {
    d->watch = vista_arena_take(arena, 1, sizeof *d->watch);
    vista_watch counted;
    vista_watch_layout(d->watch != NULL ? d->watch : &counted, arena, camera,
                       d->parameters.obstacle_map.collision_radius_m);
  }
  r->alignment = vista_arena_take(arena, r->alignment_bytes, 1);
  r->correction = vista_arena_take(arena, r->correction_bytes, 1);
  r->pipeline = vista_arena_take(arena, r->pipeline_bytes, 1);
  return arena->base == NULL || arena->used <= arena->size ? VISTA_OK : VISTA_ERROR_MEMORY;
}

vista_status vista_detector_bytes(const vista_parameters *parameters, const vista_rig *rig,
                                  const vista_detector_options *options, size_t *bytes) {
  if (parameters == NULL || rig == NULL || options == NULL || bytes == NULL) return VISTA_ERROR_ARGUMENT;
  vista_status status = vista_parameters_check(parameters, NULL); /* before they are fitted */
  if (status != VISTA_OK) return status;
  vista_detector trial = {.rig = *rig, .options = *options, .parameters = fitted(parameters, options)};
  vista_arena arena = {0};
  room r = {0};
  (void)vista_arena_take(&arena, 1, sizeof trial);
  status = lay_out(&trial, &arena, &r);
  *bytes = arena.used + VISTA_ARENA_ALIGNMENT; /* the caller's memory need not be aligned */
  return status;
}

vista_status vista_detector_create(void *memory, size_t bytes, const vista_parameters *parameters, const vista_rig *rig,
                                   const vista_detector_options *options, vista_detector **detector) {
  if (memory == NULL || parameters == NULL || rig == NULL || options == NULL || detector == NULL)
    return VISTA_ERROR_ARGUMENT;
  vista_status status = vista_parameters_check(parameters, NULL);
  if (status != VISTA_OK) return status;
  vista_arena arena = {.base = memory, .size = bytes};
  room r = {0};
  vista_detector *const d = vista_arena_take(&arena, 1, sizeof *d);
  if (d == NULL) return VISTA_ERROR_MEMORY;
  d->rig = *rig;
  d->options = *options;
  d->parameters = fitted(parameters, options);
  status = lay_out(d, &arena, &r);
  const vista_right_rectification right = right_of(rig);
  if (status == VISTA_OK && corrects(d))
    status =
        vista_correction_create(r.correction, r.correction_bytes, &d->parameters, &rig->camera, &right, &d->correction);
  if (status == VISTA_OK && r.alignment_bytes > 0)
    status = vista_alignment_create(r.alignment, r.alignment_bytes, &d->parameters, &rig->camera, &d->alignment);
  if (status == VISTA_OK)
    status = vista_pipeline_create(r.pipeline, r.pipeline_bytes, &d->parameters, &rig->camera, &d->pipeline);
  if (status == VISTA_OK) *detector = d;
  return status;
}

void vista_detector_destroy(vista_detector *d) {
  if (d != NULL) vista_pipeline_destroy(d->pipeline);
}

void vista_detector_forget(vista_detector *d) {
  vista_pipeline_reset(d->pipeline);
  if (d->watch != NULL) vista_watch_begin_anew(d->watch);
  d->placed = false;
}

/* What was seen before says nothing of what comes. */
static void look_anew(vista_detector *d) {
  if (d->watch != NULL) vista_watch_reset(d->watch);
  if (d->alignment != NULL) vista_alignment_reset(d->alignment);
}

void vista_detector_reset(vista_detector *d) {
  vista_detector_forget(d);
  look_anew(d);
  d->levels.turn = 0;
  d->began = false;
  if (d->correction != NULL) vista_correction_reset(d->correction);
}

/* ---- a pair is taken ---- */

static bool has_size(const vista_detector *d, const vista_image *image) {
  const vista_camera *const camera = &d->rig.camera;
  return image->width_px == camera->width_px && image->height_px == camera->height_px &&
         image->stride >= camera->width_px;
}

static vista_image kept(const vista_detector *d, const uint8_t *pixels) {
  const vista_camera *const camera = &d->rig.camera;
  return (vista_image){pixels, camera->width_px, camera->height_px, camera->width_px};
}

/* Bit for bit: the noise of a camera that works sees to it that no two images are alike. Where the pair before had no
 * image, what is kept is that of an older one. */
static bool shows_the_same(const vista_detector *d, const vista_detector_pair *pair) {
  const vista_image left = kept(d, d->before[0]), right = kept(d, d->before[1]);
  return pair->left.data != NULL && d->has_left && vista_same_image(&left, &pair->left) &&
         (pair->right.data == NULL || (d->has_right && vista_same_image(&right, &pair->right)));
}

static vista_novelty novelty_of(const vista_detector *d, const vista_detector_pair *pair) {
  if (!d->began || d->options.stills) return VISTA_PAIR_NEW;
  if (pair->restarts || pair->t_ns < d->t_ns) return VISTA_PAIR_RESTARTED;
  if (d->options.every_pair) return VISTA_PAIR_NEW;
  return pair->t_ns == d->t_ns || shows_the_same(d, pair) ? VISTA_PAIR_REPEATED : VISTA_PAIR_NEW;
}

static vista_status keep(const vista_detector *d, const vista_image *image, uint8_t *target) {
  return vista_rectify(&d->rig.camera, &(vista_right_table){0}, image, target);
}

static vista_status rectify(vista_detector *d, const vista_detector_pair *pair) {
  const vista_right_table as_it_is = {0};
  const vista_right_table left = pair->rectified ? as_it_is : d->rig.tables[0];
  const vista_right_table right = pair->rectified ? as_it_is : vista_detector_right_table(d);
  if (!d->has_left) return VISTA_OK;
  const vista_status status = vista_rectify(&d->rig.camera, &left, &pair->left, d->levels.images[0][0]);
  if (status != VISTA_OK || !d->has_right) return status;
  return vista_rectify(&d->rig.camera, &right, &pair->right, d->levels.images[1][0]);
}

vista_status vista_detector_take(vista_detector *d, const vista_detector_pair *pair, vista_novelty *novelty) {
  if (d == NULL || pair == NULL || novelty == NULL) return VISTA_ERROR_ARGUMENT;
  const vista_image *const sides[2] = {&pair->left, &pair->right};
  const bool has_left = sides[0]->data != NULL, has_right = sides[1]->data != NULL;
  if (!has_left && (has_right || sides[0]->width_px != 0 || sides[0]->height_px != 0)) return VISTA_ERROR_ARGUMENT;
  for (int side = 0; side < 2; ++side)
    if (sides[side]->data != NULL && !has_size(d, sides[side])) return VISTA_ERROR_SIZE;
  d->progress = PROGRESS_NONE;
  *novelty = novelty_of(d, pair);
  if (*novelty == VISTA_PAIR_REPEATED) return VISTA_OK;
  if (*novelty == VISTA_PAIR_RESTARTED) vista_detector_reset(d);
  if (*novelty == VISTA_PAIR_RESTARTED && !pair->restarts && d->watch != NULL) vista_watch_time_went_back(d->watch);
  d->began = true;
  d->t_ns = pair->t_ns;
  d->has_left = has_left;
  d->has_right = has_right;
  vista_status status = VISTA_OK;
  if (d->before[0] != NULL && has_left) status = keep(d, &pair->left, d->before[0]);
  if (d->before[1] != NULL && has_right && status == VISTA_OK) status = keep(d, &pair->right, d->before[1]);
  const double start_ms = vista_clock_ms();
  if (status == VISTA_OK) status = rectify(d, pair);
  if (status != VISTA_OK) return status;
  d->rectify_ms = vista_clock_ms() - start_ms;
  vista_pair_look(&d->view, &pair->left, &pair->right);
  d->progress = PROGRESS_TAKEN;
  return VISTA_OK;
}

/* ---- it is matched ---- */

vista_status vista_detector_match(vista_detector *d, const vista_disparity_image *words) {
  if (d == NULL || d->progress == PROGRESS_NONE || (words == NULL && !d->has_right)) return VISTA_ERROR_ARGUMENT;
  const double start_ms = vista_clock_ms();
  const vista_status status = words != NULL ? vista_levels_take(&d->levels, words) : vista_levels_match(&d->levels);
  d->match_ms = vista_clock_ms() - start_ms;
  d->words_differ = 0.0;
  if (words != NULL && status == VISTA_OK && d->has_right && !d->options.other_words)
    d->words_differ = vista_levels_differ(&d->levels);
  d->progress = status == VISTA_OK ? PROGRESS_MATCHED : PROGRESS_TAKEN;
  return status;
}

vista_detector_matched vista_detector_matched_pair(const vista_detector *d) {
  vista_detector_matched matched = {.levels = d->levels.count};
  matched.left = kept(d, d->has_left ? d->levels.images[0][0] : NULL);
  matched.right = kept(d, d->has_right ? d->levels.images[1][0] : NULL);
  for (int32_t level = 0; level < d->levels.count && d->progress >= PROGRESS_MATCHED; ++level)
    matched.words[level] = vista_levels_words(&d->levels, level);
  return matched;
}

/* ---- and judged ---- */

vista_right_table vista_detector_right_table(const vista_detector *d) {
  const vista_right_table calibrated = d->rig.tables[1];
  if (d->correction == NULL) return calibrated;
  const vista_right_table turned = vista_correction_table(d->correction);
  return turned.whole != NULL || turned.grid != NULL ? turned : calibrated;
}

/* Whether the hardware that the rig was made for has a line buffer for the table. */
static bool fits(const vista_detector *d) {
  const vista_right_table table = vista_correction_table(d->correction);
  const vista_frontend_offset *const grid = (const vista_frontend_offset *)(const void *)table.grid;
  const vista_camera *const camera = &d->rig.camera;
  return grid == NULL || vista_frontend_row_beyond(grid, camera->width_px, camera->height_px, d->rig.rectify_rows) < 0;
}

static vista_status align(vista_detector *d, vista_detector_result *result) {
  if ((d->correction == NULL && d->alignment == NULL) || !d->has_right) return VISTA_OK;
  const double start_ms = vista_clock_ms();
  const vista_image left = kept(d, d->levels.images[0][0]), right = kept(d, d->levels.images[1][0]);
  static const vista_turn none = {0};
  const vista_status status =
      d->correction != NULL ? vista_correction_update(d->correction, &left, &right, d->t_ns, &result->alignment)
                            : vista_alignment_update(d->alignment, &left, &right, d->t_ns, &none, &result->alignment);
  if (status != VISTA_OK) return status;
  if (d->correction == NULL) {
    result->alignment.correction = none;
    result->alignment.changed = false;
    if (result->alignment.state == VISTA_ALIGNMENT_BEYOND) result->alignment.state = VISTA_ALIGNMENT_MEASURED;
  } else if (result->alignment.changed && !fits(d)) {
    vista_correction_refuse(d->correction, &result->alignment);
  }
  result->alignment_ms = vista_clock_ms() - start_ms;
  return VISTA_OK;
}

static vista_status process(vista_detector *d, const vista_detector_place *place, vista_detector_result *result) {
  vista_frame frame = {.image = d->has_left ? kept(d, d->levels.images[0][0]) : (vista_image){0},
                       .disparity = vista_levels_words(&d->levels, 0),
                       .pose = place->pose,
                       .up_world = place->up_world,
                       .velocity_m_s = place->velocity_m_s,
                       .stationary = place->stationary,
                       .t_ns = d->t_ns};
  for (int32_t level = 1; level < d->levels.count; ++level)
    frame.coarser[level - 1] = vista_levels_words(&d->levels, level);
  if (place->anew || d->options.stills) vista_pipeline_reset(d->pipeline);
  if (place->anew && d->watch != NULL) vista_watch_begin_anew(d->watch);
  const vista_status status = vista_pipeline_process(d->pipeline, &frame, &result->result);
  return status == VISTA_OK ? vista_pipeline_directions(d->pipeline, &result->directions) : status;
}

/* What this pair shows against those before, and what its engine says against the one in C. */
static uint32_t watch(vista_detector *d, vista_detector_result *result) {
  if (d->watch == NULL) return 0;
  const double start_ms = vista_clock_ms();
  const vista_detector_matched pair = vista_detector_matched_pair(d);
  vista_watched found;
  const double noise = vista_pipeline_look(d->pipeline).frame->noise.sigma;
  vista_watch_pair(d->watch, &pair.left, &pair.right, noise, &result->result, d->t_ns, &found);
  if (!vista_watch_words(d->watch, d->words_differ > 0.0)) found.reasons |= UINT32_C(1) << VISTA_HEALTH_WORDS_DIFFER;
  if (result->alignment.unexplained) found.reasons |= UINT32_C(1) << VISTA_HEALTH_MOMENTS_DIFFER;
  result->watch_ms = vista_clock_ms() - start_ms;
  return found.reasons;
}

vista_status vista_detector_judge(vista_detector *d, const vista_detector_place *place, vista_detector_result *result) {
  if (d == NULL || place == NULL || result == NULL || d->progress != PROGRESS_MATCHED) return VISTA_ERROR_ARGUMENT;
  *result = (vista_detector_result){.rectify_ms = d->rectify_ms, .match_ms = d->match_ms};
  d->progress = PROGRESS_JUDGED;
  vista_status status = align(d, result);
  if (status == VISTA_OK) status = process(d, place, result);
  if (status != VISTA_OK) return status;
  d->seen = (vista_detector_seen){d->pipeline, result->directions};
  d->placed = d->placed || place->pose != NULL;
  const uint32_t watched = watch(d, result);
  const bool alone = d->options.stills || (d->options.motion_watched && d->has_left);
  vista_findings_of(&(vista_frame_facts){.rig = &d->rig,
                                         .view = &d->view,
                                         .motion_unknown = !d->placed && !alone,
                                         .began_anew = place->anew && !d->options.stills,
                                         .watched = watched,
                                         .text = d->alignment_text},
                    result);
  return VISTA_OK;
}

vista_status vista_detector_process(vista_detector *d, const vista_detector_pair *pair,
                                    const vista_detector_place *place, vista_novelty *novelty,
                                    vista_detector_result *result) {
  vista_status status = vista_detector_take(d, pair, novelty);
  if (status != VISTA_OK || *novelty == VISTA_PAIR_REPEATED) return status;
  status = vista_detector_match(d, NULL);
  return status == VISTA_OK ? vista_detector_judge(d, place, result) : status;
}

vista_status vista_detector_write_line(const vista_detector_result *result, int64_t frame, int64_t t_ns,
                                       bool all_tracks, char *text, size_t capacity, size_t *length) {
  if (result == NULL) return VISTA_ERROR_ARGUMENT;
  return vista_line_write(&result->result, &result->directions, &result->health, frame, t_ns, all_tracks, text,
                          capacity, length);
}

const vista_detector_seen *vista_detector_look(const vista_detector *d) { return &d->seen; }
