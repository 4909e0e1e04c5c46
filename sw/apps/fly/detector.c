#include "detector.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

#define LARGE_PAGE_BYTES ((size_t)1 << 21)
#define ALIGNMENT 64
#define SAMPLE_STEP_PX 4    /* as vista.health.checks has them */
#define MIN_CONTRAST 3.0

static size_t padded(size_t bytes, size_t step) { return (bytes + step - 1) / step * step; }

/* ---- memory ---- */

/* Of all levels: images, smoothed ones and words; sets the pointers if there is memory. Returns the bytes. */
static size_t lay_out(detector *d, unsigned char *memory) {
  int32_t width = d->rig->camera.width_px, height = d->rig->camera.height_px;
  size_t used = 0;
  for (int32_t level = 0; level < d->levels; ++level) {
    const size_t pixels = (size_t)width * (size_t)height;
    for (int side = 0; side < 2; ++side) {
      if (memory != NULL) d->images[side][level] = memory + used;
      used += padded(pixels, ALIGNMENT);
      if (level > 0) continue;
      if (memory != NULL) d->smoothed[side] = memory + used;
      used += padded(pixels, ALIGNMENT);
    }
    if (memory != NULL) d->words[level] = (int16_t *)(void *)(memory + used);
    used += padded(pixels * sizeof(int16_t), ALIGNMENT);
    width = vista_frontend_reduced_px(width);
    height = vista_frontend_reduced_px(height);
  }
  return used;
}

static vista_engine_params engine_of(const vista_parameters *parameters) {
  const vista_stereo_params *const s = &parameters->stereo;
  vista_engine_params engine = vista_engine_defaults();
  engine.num_disparities = s->num_disparities;
  engine.block_size = s->block_size;
  engine.prefilter =
      s->prefilter == VISTA_STEREO_PREFILTER_XSOBEL ? VISTA_ENGINE_PREFILTER_XSOBEL : VISTA_ENGINE_PREFILTER_NONE;
  engine.prefilter_cap = s->prefilter_cap;
  engine.texture_threshold = s->texture_threshold;
  engine.uniqueness_ratio = s->uniqueness_ratio;
  engine.lr_max_diff = s->lr_max_diff < 0 ? VISTA_ENGINE_LR_OFF : s->lr_max_diff;
  return engine;
}

bool detector_make(detector *d, const rig *r, const vista_parameters *parameters, problem *p) {
  *d = (detector){.rig = r, .engine = engine_of(parameters), .levels = parameters->stereo.levels};
  d->smooth = parameters->stereo.smooth == VISTA_STEREO_SMOOTH_BINOMIAL3;
  if (parameters->stereo.rectify_rows != r->rectify_rows)
    return problem_say(p, "stereo.rectify_rows", "is %d, the rig was prepared with %d", parameters->stereo.rectify_rows,
                       r->rectify_rows);
  const vista_engine_status fit = vista_engine_validate(&d->engine);
  if (fit != VISTA_ENGINE_OK) return problem_say(p, "[stereo]", "%s", vista_engine_status_text(fit));
  size_t bytes = 0;
  vista_status status = vista_pipeline_bytes(parameters, &r->camera, &bytes);
  if (status != VISTA_OK) return problem_say(p, "rig", "%s", vista_status_text(status));
  d->scratch_bytes =
      padded(vista_engine_scratch_bytes(&d->engine, r->camera.width_px, r->camera.height_px, 1), ALIGNMENT);
  const size_t pictures = lay_out(d, NULL), head = d->scratch_bytes + pictures;
  const size_t all = padded(head + bytes, LARGE_PAGE_BYTES);
  d->memory = aligned_alloc(LARGE_PAGE_BYTES, all);
  if (d->memory == NULL) return problem_say(p, "rig", "out of memory");
#if defined(MADV_HUGEPAGE)
  (void)madvise(d->memory, all, MADV_HUGEPAGE); /* without them it works, too */
#endif
  memset(d->memory, 0, all); /* the pages are there before the first frame */
  d->scratch = d->memory;
  (void)lay_out(d, (unsigned char *)d->memory + d->scratch_bytes);
  status = vista_pipeline_create((unsigned char *)d->memory + head, all - head, parameters, &r->camera, &d->pipeline);
  if (status != VISTA_OK) return problem_say(p, "rig", "%s", vista_status_text(status));
  return aligner_make(&d->aligner, r, parameters, p);
}

void detector_free(detector *d) {
  vista_pipeline_destroy(d->pipeline);
  aligner_free(&d->aligner);
  free(d->memory);
  *d = (detector){0};
}

void detector_forget(detector *d) {
  vista_pipeline_reset(d->pipeline);
  d->placed = false;
}

void detector_reset(detector *d) {
  detector_forget(d);
  aligner_reset(&d->aligner);
}

/* ---- matching ---- */

static bool failed(problem *p, const char *what, const char *text) { return problem_say(p, what, "%s", text); }

/* What is matched of one side and level: the image, or it smoothed. */
static const uint8_t *matched(detector *d, int side, int32_t level, int32_t width, int32_t height) {
  if (!d->smooth) return d->images[side][level];
  const vista_frontend_image image = {d->images[side][level], width, height, width};
  const vista_engine_status status = vista_frontend_smooth(&image, d->smoothed[side], width, VISTA_ENGINE_ISA_AUTO);
  return status == VISTA_ENGINE_OK ? d->smoothed[side] : NULL;
}

static vista_engine_status match_level(detector *d, int32_t level, int32_t width, int32_t height) {
  const vista_engine_images images = {
      matched(d, 0, level, width, height), matched(d, 1, level, width, height), width, height, width, width};
  if (images.left == NULL || images.right == NULL) return VISTA_ENGINE_ERROR_ARGUMENT;
  const vista_engine_output output = {d->words[level], NULL, width, 0};
  vista_engine_status status = vista_engine_compute(&d->engine, &images, &output, d->scratch, d->scratch_bytes);
  if (status != VISTA_ENGINE_OK || level + 1 == d->levels) return status;
  for (int side = 0; side < 2 && status == VISTA_ENGINE_OK; ++side) {
    const vista_frontend_image image = {d->images[side][level], width, height, width};
    status = vista_frontend_reduce(&image, d->images[side][level + 1], vista_frontend_reduced_px(width),
                                   VISTA_ENGINE_ISA_AUTO);
  }
  return status;
}

bool detector_match(detector *d, const shot *s, problem *p) {
  const rig_table right = aligner_table(&d->aligner);
  rig_rectify(d->rig, &d->rig->tables[0], s->left, d->images[0][0]);
  rig_rectify(d->rig, &right, s->right, d->images[1][0]);
  int32_t width = d->rig->camera.width_px, height = d->rig->camera.height_px;
  for (int32_t level = 0; level < d->levels; ++level) {
    const vista_engine_status status = match_level(d, level, width, height);
    if (status != VISTA_ENGINE_OK) return failed(p, "engine", vista_engine_status_text(status));
    width = vista_frontend_reduced_px(width);
    height = vista_frontend_reduced_px(height);
  }
  return true;
}

/* ---- health: what the library is not told of ---- */

/* Standard deviation of every fourth pixel of every fourth row. */
static double contrast(const uint8_t *image, int32_t width, int32_t height) {
  double count = 0.0, sum = 0.0, squares = 0.0;
  for (int32_t v = 0; v < height; v += SAMPLE_STEP_PX)
    for (int32_t u = 0; u < width; u += SAMPLE_STEP_PX) {
      const double grey = image[(ptrdiff_t)v * width + u];
      count += 1.0;
      sum += grey;
      squares += grey * grey;
    }
  return sqrt(fmax(0.0, squares / count - sum / count * (sum / count)));
}

static void add_of_library(vista_line_health *h, const vista_health *health) {
  vista_line_health found;
  vista_line_health_of(health, &found);
  for (int32_t k = 0; k < found.reason_count; ++k) vista_line_health_add(h, found.state, found.reasons[k]);
}

/* The checks of vista.health that need no features, in their order, then the library's own. */
static void check(const detector *d, const shot *s, const placement *where, detection *found) {
  const int32_t width = d->rig->camera.width_px, height = d->rig->camera.height_px;
  vista_line_health *const h = &found->health;
  *h = (vista_line_health){.state = VISTA_HEALTH_HEALTHY};
  if (d->rig->findings & RIG_BASELINE_IMPLAUSIBLE)
    vista_line_health_add(h, VISTA_HEALTH_DEGRADED, "baseline_implausible");
  if (d->rig->findings & RIG_CALIBRATION_MISFIT) vista_line_health_add(h, VISTA_HEALTH_DEGRADED, "calibration_misfit");
  if (contrast(s->left, width, height) < MIN_CONTRAST || contrast(s->right, width, height) < MIN_CONTRAST)
    vista_line_health_add(h, VISTA_HEALTH_BLIND, "no_contrast");
  else if (memcmp(s->left, s->right, (size_t)width * (size_t)height) == 0)
    vista_line_health_add(h, VISTA_HEALTH_BLIND, "images_identical");
  vista_health of_cameras = {0};
  vista_alignment_judge(&d->aligner.found, &of_cameras);
  add_of_library(h, &of_cameras);
  if (!where->has_pose && !d->placed) vista_line_health_add(h, VISTA_HEALTH_DEGRADED, "motion_unknown");
  add_of_library(h, &found->result.health);
}

bool detector_judge(detector *d, const shot *s, const placement *where, detection *found, problem *p) {
  int32_t width = d->rig->camera.width_px, height = d->rig->camera.height_px;
  vista_frame frame = {
      .image = {d->images[0][0], width, height, width},
      .disparity = {d->words[0], width, height, width},
      .pose = where->has_pose ? &where->pose : NULL,
      .up_world = where->has_up ? where->up_world : NULL,
      .velocity_m_s = where->has_velocity ? where->velocity_m_s : NULL,
      .t_ns = s->t_ns,
  };
  for (int32_t level = 1; level < d->levels; ++level) {
    width = vista_frontend_reduced_px(width);
    height = vista_frontend_reduced_px(height);
    frame.coarser[level - 1] = (vista_disparity_image){d->words[level], width, height, width};
  }
  vista_status status = aligner_take(&d->aligner, d->images[0][0], d->images[1][0], s->t_ns);
  if (status == VISTA_OK) status = vista_pipeline_process(d->pipeline, &frame, &found->result);
  if (status == VISTA_OK) status = vista_pipeline_directions(d->pipeline, &found->directions);
  if (status != VISTA_OK) return failed(p, "frame", vista_status_text(status));
  d->placed = d->placed || where->has_pose;
  check(d, s, where, found);
  return true;
}
