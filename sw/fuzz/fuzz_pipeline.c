/* The detector on parameters, cameras, images, words, poses and times of any kind: no error of memory or arithmetic, all
 * that leaves it is finite and within its range, and the same frames give the same again after a reset and with another
 * number of threads. Frames go into the pipeline itself, or through the whole detector, with a planner behind it. */
#include <math.h>
#include <sanitizer/asan_interface.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include "input.h"
#include "plan/space.h"
#include "scene.h"
#include "vista/plan.h"
#include "vista/vista.h"

#define FRAMES_MAX 12
#define PERIOD_NS 100000000
#define WIDTH_MOST_PX 320
#define HEIGHT_MOST_PX 240
#define OBSTACLES_MOST (256 + 3) /* tracks, and one of each kind without a track */
#define OFTEN 4 /* every so many frames what is asked for after a frame is asked for, which takes time of its own */

/* What an input asks for besides its frames: the bits of one byte. */
enum {
  MODE_COMPARE = 3, /* 0: the same again after a reset; 2: the same with another number of threads */
  MODE_DETECTOR = 4, /* through the detector; the other bits are for that alone */
  MODE_EVERY_PAIR = 8,
  MODE_STILLS = 16,
  MODE_OTHER_WORDS = 32,
  MODE_MATCHES = 64, /* the engine matches, and the words are not used */
  MODE_PLANS = 128
};

static int64_t frames, refused; /* that the pipeline processed, and that it did not take */

__attribute__((destructor)) static void tell(void) {
  fprintf(stderr, "stat::frames: %lld\nstat::frames_refused: %lld\n", (long long)frames, (long long)refused);
}

typedef struct craft {
  vista_parameters parameters;
  vista_camera camera;
  uint8_t mode;
  vista_pipeline *pipeline;
  vista_detector *detector; /* null: the pipeline by itself */
  vista_planner *planner;
} craft;

/* The memory of the craft, which is one at a time. New memory has to be cleared by the system, page by page, each time.
 * What of it a craft does not need is forbidden to it. */
static void *room(size_t bytes) {
  static void *memory;
  static size_t capacity;
  if (bytes > capacity) {
    free(memory);
    memory = fuzz_allocate(bytes);
    capacity = bytes;
  }
  ASAN_UNPOISON_MEMORY_REGION(memory, bytes);
  ASAN_POISON_MEMORY_REGION((char *)memory + bytes, capacity - bytes);
  return memory;
}

static bool create_pipeline(craft *c) {
  size_t bytes;
  if (vista_pipeline_bytes(&c->parameters, &c->camera, &bytes) != VISTA_OK) return false;
  if (vista_pipeline_create(room(bytes), bytes, &c->parameters, &c->camera, &c->pipeline) != VISTA_OK) abort();
  return true;
}

static bool create_detector(craft *c) {
  static vista_planner planner;
  const vista_camera *const camera = &c->camera;
  const vista_rig rig = {.camera = *camera,
                         .rectify_rows = c->parameters.stereo.rectify_rows,
                         .left_from_rectified = {1, 0, 0, 0, 1, 0, 0, 0, 1},
                         .right = {.focal_u_px = camera->focal_px,
                                   .focal_v_px = camera->focal_px,
                                   .center_u_px = camera->center_u_px,
                                   .center_v_px = camera->center_v_px,
                                   .rectified_from_raw = {1, 0, 0, 0, 1, 0, 0, 0, 1}}};
  const vista_detector_options options = {.every_pair = c->mode & MODE_EVERY_PAIR,
                                          .stills = c->mode & MODE_STILLS,
                                          .other_words = c->mode & MODE_OTHER_WORDS};
  size_t bytes;
  if (vista_detector_bytes(&c->parameters, &rig, &options, &bytes) != VISTA_OK) return false;
  if (vista_detector_create(room(bytes), bytes, &c->parameters, &rig, &options, &c->detector) != VISTA_OK) abort();
  if (c->mode & MODE_PLANS) {
    c->planner = &planner;
    if (vista_planner_start(c->planner, &c->parameters) != VISTA_OK) abort();
  }
  return true;
}

static bool create(craft *c) { return c->mode & MODE_DETECTOR ? create_detector(c) : create_pipeline(c); }

static void end(const craft *c) { /* a second thread uses the memory */
  vista_pipeline_destroy(c->pipeline);
  vista_detector_destroy(c->detector);
}

static void reset(const craft *c) {
  if (c->pipeline != NULL) vista_pipeline_reset(c->pipeline);
  if (c->detector != NULL) vista_detector_reset(c->detector);
  if (c->planner != NULL) vista_planner_reset(c->planner);
}

/* Within the range of each parameter, from one end to the other, or any number. */
static vista_parameters read_parameters(fuzz_input *input) {
  vista_parameters parameters = vista_parameters_default();
  (void)vista_parameters_set(&parameters, "foveation.sector_count", 32); /* a few hundred cells: many runs a second */
  for (int32_t changes = fuzz_byte(input) % 16; changes > 0; --changes) {
    const vista_parameter *const p = vista_parameter_info(fuzz_byte(input) % vista_parameter_count());
    const int32_t share = fuzz_between(input, 0, 65535);
    double value = p->min + (p->max - p->min) * share / 65534.0;
    if (p->type != VISTA_PARAMETER_FLOAT) value = round(value);
    if (share == 65535) value = fuzz_double(input);
    (void)vista_parameters_set(&parameters, p->name, value);
  }
  return parameters;
}

static vista_camera read_camera(fuzz_input *input) {
  const uint8_t any = fuzz_byte(input); /* a bit for each number that may be absurd */
  const int32_t width = fuzz_between(input, 16, WIDTH_MOST_PX), height = fuzz_between(input, 16, HEIGHT_MOST_PX);
  vista_camera camera = {width, height, 60.0 + fuzz_byte(input), width / 2.0, height / 2.0, 0.5};
  if (any & 1) camera.focal_px = fuzz_double(input);
  if (any & 2) camera.center_u_px = fuzz_double(input);
  if (any & 4) camera.center_v_px = fuzz_double(input);
  if (any & 8) camera.baseline_m = fuzz_double(input);
  if (any & 16) camera.center_u_px += fuzz_int32(input) / 65536.0;
  if (any & 32) camera.center_v_px += fuzz_int32(input) / 65536.0;
  return camera;
}

/* ---- one frame ---- */

typedef struct scene { /* what draws a frame */
  uint8_t image, words;
  uint32_t seed;
  int32_t near_disparity; /* words of the thing in the middle */
  int32_t far_disparity;
} scene;

enum { IMAGE_WORLD = 4, WORDS_WORLD = 5, WORDS_TORN = 6 };

static scene read_scene(fuzz_input *input) {
  scene s = {fuzz_byte(input) % 5, fuzz_byte(input) % 7, (uint32_t)fuzz_int32(input) | 1, 0, 0};
  s.near_disparity = fuzz_between(input, -32, 1100);
  s.far_disparity = fuzz_between(input, -32, 300);
  return s;
}

static uint8_t grey(const scene *s, fuzz_input *input, bool thing, uint32_t noise) {
  switch (s->image) {
    case 0:
      return (uint8_t)(thing ? 60 : 160);
    case 1:
      return (uint8_t)((thing ? 60 : 140) + noise % 40);
    case 2:
      return (uint8_t)noise;
    default:
      return fuzz_byte(input);
  }
}

/* here: of the world at that pixel. */
static int16_t word(const scene *s, fuzz_input *input, bool thing, uint32_t noise, double down, int16_t here) {
  const int32_t plain = thing ? s->near_disparity : s->far_disparity;
  switch (s->words) {
    case 0:
      return (int16_t)plain;
    case 1:
      return (int16_t)((thing ? plain : (int32_t)(plain * down)) + (int32_t)(noise % 5));
    case 2:
      return (int16_t)(noise % 8 == 0 ? VISTA_DISPARITY_INVALID : plain);
    case 3:
      return (int16_t)noise;
    case WORDS_WORLD:
      return here;
    case WORDS_TORN:
      return (int16_t)(noise % 8 == 0 || here < 0 ? VISTA_DISPARITY_INVALID : here + (int32_t)(noise / 8 % 7) - 3);
    default:
      return (int16_t)(16 * fuzz_byte(input) - 16 * (fuzz_byte(input) % 8));
  }
}

/* What a frame is made of, in memory of exactly its size. */
typedef struct shot {
  uint8_t *left, *right; /* right: null but for the detector */
  int16_t *words[1 + VISTA_COARSER_LEVELS];
  int32_t width_px[1 + VISTA_COARSER_LEVELS], height_px[1 + VISTA_COARSER_LEVELS];
} shot;

/* The words over again as those of coarser levels. */
static void halve(shot *s) {
  for (int k = 1; k <= VISTA_COARSER_LEVELS; ++k) {
    const int32_t width = s->width_px[k] = (s->width_px[k - 1] + 1) / 2;
    s->height_px[k] = (s->height_px[k - 1] + 1) / 2;
    s->words[k] = fuzz_allocate((size_t)width * (size_t)s->height_px[k] * sizeof(int16_t));
    for (int32_t v = 0; v < s->height_px[k]; ++v)
      for (int32_t u = 0; u < width; ++u) {
        const int16_t finer = s->words[k - 1][2 * v * s->width_px[k - 1] + 2 * u];
        s->words[k][v * width + u] = (int16_t)(finer < 0 ? finer : finer / 2);
      }
  }
}

static shot draw(const scene *s, fuzz_input *input, const craft *c, int32_t number, vista_pose *pose) {
  const vista_camera *const camera = &c->camera;
  const int32_t width = camera->width_px, height = camera->height_px;
  const size_t pixels = (size_t)width * (size_t)height;
  const bool shown = s->image == IMAGE_WORLD, worldly = shown || s->words == WORDS_WORLD || s->words == WORDS_TORN;
  shot made = {.left = fuzz_allocate(pixels), .width_px = {width}, .height_px = {height}};
  made.words[0] = fuzz_allocate(pixels * sizeof(int16_t));
  if (c->detector != NULL) made.right = fuzz_allocate(pixels);
  *pose = (vista_pose){{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0.0, 0.0, 0.5 * number}};
  if (worldly) {
    const fuzz_world world = fuzz_world_of(s->seed);
    *pose = fuzz_world_pose(&world, number);
    fuzz_world_draw(&world, number, pose, camera, 0.0, made.left, made.words[0]);
    if (shown && made.right != NULL)
      fuzz_world_draw(&world, number, pose, camera, camera->baseline_m, made.right, NULL);
  }
  uint32_t state = s->seed;
  for (int32_t v = 0; v < height; ++v)
    for (int32_t u = 0; u < width; ++u) {
      const uint32_t noise = fuzz_random(&state) >> 8;
      const bool thing = abs(2 * u - width) < width / 2 && abs(2 * v - height) < height - 8;
      const int32_t at = v * width + u;
      if (!shown) made.left[at] = grey(s, input, thing, noise);
      made.words[0][at] = word(s, input, thing, noise, v / (double)height, worldly ? made.words[0][at] : 0);
    }
  if (!shown && made.right != NULL) /* nearer than all words by nothing, and shifted by those of the far */
    for (size_t k = 0; k < pixels; ++k) made.right[k] = made.left[(k + (size_t)(s->far_disparity + 32) / 16) % pixels];
  halve(&made);
  return made;
}

static void drop(const shot *s) {
  for (int k = 0; k <= VISTA_COARSER_LEVELS; ++k) free(s->words[k]);
  free(s->right);
  free(s->left);
}

/* ---- what leaves ---- */

static void check(bool holds) {
  if (!holds) abort();
}

static void check_finite(const double *numbers, int32_t count) {
  for (int32_t i = 0; i < count; ++i) check(isfinite(numbers[i]));
}

static void check_unit(const double *vector) {
  check(fabs(vector[0] * vector[0] + vector[1] * vector[1] + vector[2] * vector[2] - 1.0) < 2e-3);
}

static void check_covariance(const double *c) {
  check_finite(c, 9);
  for (int i = 0; i < 3; ++i) check(c[4 * i] >= 0.0);
}

static void check_obstacle(const vista_obstacle *o) {
  check(o->kind >= 0 && o->kind < VISTA_OBSTACLE_KIND_COUNT && o->world >= 0 && o->world < VISTA_WORLD_VERDICT_COUNT);
  check((o->kind == VISTA_OBSTACLE_THING) == (o->id > 0) && o->id >= VISTA_ID_PLACE && o->age_frames >= 0);
  check_finite(o->position_m, 3);
  check_covariance(o->covariance_m2);
  check(isfinite(o->distance_m) && o->distance_m >= 0.0);
  check_finite(o->extent_m, 2);
  check(o->extent_m[0] >= 0.0 && o->extent_m[1] >= 0.0);
  const vista_ellipse *const e = &o->ellipse;
  check(isfinite(e->center_u_px) && isfinite(e->center_v_px) && isfinite(e->axis_a_px));
  check(e->axis_b_px >= 0.0 && e->axis_a_px >= e->axis_b_px && e->angle_deg > -90.0 && e->angle_deg <= 90.0);
  check(isfinite(o->disparity_px));
}

static void check_motion(const vista_motion *m) {
  check(m->source >= 0 && m->source < VISTA_MOTION_SOURCE_COUNT);
  check_finite(m->pose.rotation, 9);
  check_finite(m->pose.translation_m, 3);
  check_finite(m->velocity_m_s, 3);
  check_finite(m->turn_rate_rad_s, 3);
  check(isfinite(m->speed_m_s) && m->speed_m_s >= 0.0 && isfinite(m->drift_m) && m->drift_m >= 0.0);
  check_unit(m->direction);
}

static void check_result(const craft *c, const vista_result *r) {
  check(r->valid_fraction >= 0.0 && r->valid_fraction <= 1.0);
  check(r->obstacle_count >= 0 && r->accepted_count >= 0 && r->accepted_count <= r->region_count);
  check(r->obstacle_count <= OBSTACLES_MOST && r->region_count <= r->views->cell_count);
  check(r->dropped_tracks >= 0 && r->health.state >= 0 && r->health.state < VISTA_HEALTH_STATE_COUNT);
  check(r->health.reasons >> VISTA_HEALTH_REASON_COUNT == 0);
  check((r->health.state == VISTA_HEALTH_HEALTHY) == (r->health.reasons == 0));
  check(r->health.matched_fraction >= 0.0 && r->health.matched_fraction <= 1.0);
  check(r->health.contrast >= 0.0 && r->health.contrast <= 255.0);
  check_motion(&r->motion);
  for (int32_t i = 0; i < r->obstacle_count; ++i) {
    check_obstacle(vista_result_obstacle(r, i));
    check(i == 0 || r->obstacles[i].distance_m >= r->obstacles[i - 1].distance_m);
  }
  const vista_nearest_collision *const n = &r->nearest_collision;
  check_finite(n->position_m, 3);
  check_covariance(n->covariance_m2);
  check(isfinite(n->distance_m) && n->distance_m >= 0.0);
  check(isnan(n->time_to_collision_s) || (isfinite(n->time_to_collision_s) && n->time_to_collision_s >= 0.0));
  const double p = r->collision_probability;
  check(n->valid ? isnan(p) || (p >= 0.0 && p <= 1.0) : isnan(p));
  check(r->path_seen_m >= 0.0 && r->path_seen_m <= c->parameters.obstacle_map.collision_length_m);
  const vista_views *const views = r->views;
  for (int32_t k = 0; k < views->cell_count; ++k) {
    check(views->cell_intensity[k] >= 0.0F && views->cell_intensity[k] <= 255.0F);
    check(isfinite(views->cell_disparity_px[k]) && views->region_of_cell[k] < views->region_count);
  }
}

static void check_directions(const craft *c, const vista_directions *d) {
  check_unit(d->up_camera);
  for (int k = 0; k < VISTA_DIRECTIONS; ++k) {
    check(d->free_m[k] >= 0.0F && (double)d->free_m[k] <= 1.0001 * c->parameters.obstacle_map.collision_length_m);
    check(d->blocked_m[k] >= 0.0F && isfinite(d->blocked_m[k]));
  }
}

static void check_setpoint(const vista_plan_setpoint *s) {
  check_finite(s->position_m, 3);
  check_finite(s->velocity_m_s, 3);
  check_finite(s->acceleration_m_s2, 3);
  check_unit(s->heading);
  check(isfinite(s->yaw_rate_rad_s));
}

static void check_decision(const vista_plan_decision *d) {
  check(d->action >= 0 && d->action < VISTA_PLAN_ACTION_COUNT);
  check(d->point_count >= 1 && d->point_count <= VISTA_PLAN_MOST_POINTS && d->circle_from < d->point_count);
  check(d->option_count >= 0 && d->option_count <= VISTA_PLAN_MOST_OPTIONS && d->chosen < d->option_count);
  check(d->looks >= 0 && d->looks <= VISTA_PLAN_LOOKS); /* what a decision costs */
  check(isfinite(d->escape_s) && isfinite(d->step_s) && d->step_s > 0.0);
  check_setpoint(&d->setpoint);
  for (int32_t k = 0; k < d->point_count; ++k) check_setpoint(&d->points[k]);
}

static void mix(uint64_t *digest, const void *data, size_t bytes) {
  for (size_t k = 0; k < bytes; ++k) *digest = (*digest ^ ((const uint8_t *)data)[k]) * UINT64_C(1099511628211);
}

/* All that has to be the same again; ids go on counting, and times are those of a clock. */
static void digest_result(uint64_t *digest, const vista_result *r) {
  const int64_t counts[] = {r->obstacle_count,    r->region_count,   r->accepted_count,         r->dropped_tracks,
                            (int)r->health.state, r->health.reasons, r->nearest_collision.valid};
  const double numbers[] = {r->valid_fraction,          r->path_seen_m,
                            r->collision_probability,   r->health.contrast,
                            r->health.matched_fraction, r->nearest_collision.time_to_collision_s};
  mix(digest, counts, sizeof counts);
  mix(digest, numbers, sizeof numbers);
  mix(digest, r->motion.velocity_m_s, sizeof r->motion.velocity_m_s);
  mix(digest, r->nearest_collision.position_m, sizeof r->nearest_collision.position_m);
  mix(digest, r->nearest_collision.covariance_m2, sizeof r->nearest_collision.covariance_m2);
  for (int32_t i = 0; i < r->obstacle_count; ++i) {
    const vista_obstacle *const o = vista_result_obstacle(r, i);
    const int32_t states[] = {o->confirmed,           o->coasting, o->in_blind_zone, (int)o->world, o->age_frames,
                              o->in_collision_volume, (int)o->kind};
    mix(digest, states, sizeof states);
    mix(digest, o->position_m, sizeof o->position_m);
    mix(digest, o->covariance_m2, sizeof o->covariance_m2);
    mix(digest, o->extent_m, sizeof o->extent_m);
    mix(digest, &o->ellipse, sizeof o->ellipse);
  }
}

/* ---- a flight ---- */

typedef struct flight {
  fuzz_input input;
  int64_t t_ns;
  uint64_t digest;
} flight;

static void read_pose(fuzz_input *input, uint8_t kind, vista_pose *pose) {
  if (kind & 1) {
    const double angle = fuzz_between(input, -3142, 3142) / 1000.0;
    const vista_pose at = *pose;
    *pose = (vista_pose){{cos(angle), 0, sin(angle), 0, 1, 0, -sin(angle), 0, cos(angle)}, {0.0, 0.0, 0.0}};
    memcpy(pose->translation_m, at.translation_m, sizeof at.translation_m);
  }
  for (int i = 0; i < 3; ++i) {
    if (kind & 2) pose->translation_m[i] += fuzz_int32(input) / 1000.0;
    if (kind & 4) pose->translation_m[i] = fuzz_double(input);
  }
  if (kind & 8) pose->rotation[fuzz_byte(input) % 9] = fuzz_double(input);
}

static vista_status through_pipeline(const craft *c, const vista_frame *frame, flight *f, int32_t number) {
  vista_result result;
  vista_directions directions;
  const vista_status status = vista_pipeline_process(c->pipeline, frame, &result);
  if (status != VISTA_OK) return status;
  check_result(c, &result);
  digest_result(&f->digest, &result);
  if (number % OFTEN != 0) return VISTA_OK;
  check(vista_pipeline_directions(c->pipeline, &directions) == VISTA_OK);
  check_directions(c, &directions);
  mix(&f->digest, &directions.free_m, sizeof directions.free_m);
  return VISTA_OK;
}

static void check_findings(const vista_detector_result *r, const vista_frame *frame, int32_t number) {
  static char text[VISTA_LINE_BYTES];
  size_t length;
  check(r->finding_count >= 0 && r->finding_count <= VISTA_LINE_REASONS);
  for (int32_t k = 0; k < r->finding_count; ++k) check(r->findings[k].reason != NULL && r->findings[k].text[0] != '\0');
  const double turns[] = {r->alignment.correction.pitch_rad, r->alignment.correction.roll_rad,
                          r->alignment.estimate.pitch_rad, r->alignment.estimate.roll_rad, r->alignment.row_error_px};
  check_finite(turns, 5);
  if (number % OFTEN != 0) return;
  check(vista_detector_write_line(r, number, frame->t_ns, false, text, sizeof text, &length) == VISTA_OK);
  check(length == strlen(text) && strchr(text, '\n') == text + length - 1);
}

/* Flies ahead of where the camera looks, to somewhere that the time tells. */
static void plan(const craft *c, const vista_motion *motion, const double *up, flight *f, int64_t t_ns) {
  static vista_plan_decision decision;
  vista_plan_state state = {.t_ns = t_ns + PERIOD_NS / 2, .position_sigma_m = 0.1};
  vista_plan_goal goal = {.speed_m_s = 8.0, .passed = t_ns / PERIOD_NS % 2};
  for (int i = 0; i < 3; ++i) {
    state.position_m[i] = motion->pose.translation_m[i];
    state.velocity_m_s[i] = motion->velocity_m_s[i];
    state.up[i] = up[i];
    state.heading[i] = motion->pose.rotation[3 * i + 2];
    goal.to_m[i] =
        state.position_m[i] + 40.0 * state.heading[i] + (i == 0 ? (double)(t_ns / PERIOD_NS % 7) - 3.0 : 0.0);
  }
  if (vista_planner_decide(c->planner, c->detector, &state, &goal, &decision) != VISTA_OK) return;
  vista_plan_setpoint setpoint;
  check_decision(&decision);
  vista_plan_at(&decision, 0.37, &setpoint);
  check_setpoint(&setpoint);
  mix(&f->digest, &decision.action, sizeof decision.action);
  mix(&f->digest, decision.setpoint.position_m, sizeof decision.setpoint.position_m);
}

static vista_status through_detector(const craft *c, const shot *s, const vista_frame *frame, flight *f,
                                     int32_t number) {
  static const double level[3] = {0.0, -1.0, 0.0};
  const int32_t width = c->camera.width_px, height = c->camera.height_px;
  vista_detector_pair pair = {.left = frame->image, .t_ns = frame->t_ns};
  if (frame->image.data != NULL) pair.right = (vista_image){s->right, width, height, width};
  const vista_detector_place place = {.pose = frame->pose,
                                      .up_world = frame->up_world,
                                      .velocity_m_s = frame->velocity_m_s,
                                      .stationary = frame->stationary};
  vista_disparity_image words[1 + VISTA_COARSER_LEVELS];
  vista_novelty novelty;
  vista_detector_result result;
  for (int k = 0; k <= VISTA_COARSER_LEVELS; ++k)
    words[k] = (vista_disparity_image){s->words[k], s->width_px[k], s->height_px[k], s->width_px[k]};
  words[0] = frame->disparity;
  vista_status status = vista_detector_take(c->detector, &pair, &novelty);
  if (status != VISTA_OK || novelty == VISTA_PAIR_REPEATED) return status != VISTA_OK ? status : VISTA_ERROR_ORDER;
  status = vista_detector_match(c->detector, c->mode & MODE_MATCHES ? NULL : words);
  if (status == VISTA_OK) status = vista_detector_judge(c->detector, &place, &result);
  if (status != VISTA_OK) {
    vista_detector_forget(c->detector);
    return status;
  }
  check_result(c, &result.result);
  check_directions(c, &result.directions);
  check_findings(&result, frame, number);
  digest_result(&f->digest, &result.result);
  mix(&f->digest, &result.directions.free_m, sizeof result.directions.free_m);
  for (int32_t k = 0; k < result.finding_count; ++k)
    mix(&f->digest, result.findings[k].reason, strlen(result.findings[k].reason));
  if (c->planner != NULL)
    plan(c, &result.result.motion, frame->up_world != NULL ? frame->up_world : level, f, frame->t_ns);
  return VISTA_OK;
}

/* One frame, as the input says: sizes, strides, pose, up and time may be wrong. */
static void fly_frame(const craft *c, flight *f, int32_t number) {
  fuzz_input *const input = &f->input;
  const vista_camera *const camera = &c->camera;
  double up[3] = {0.0, -1.0, 0.0}, velocity[3];
  vista_pose pose;
  const uint8_t flags = fuzz_byte(input), pose_kind = flags & 1 ? fuzz_byte(input) : 0;
  const uint8_t wrong = flags & 2 ? fuzz_byte(input) : 0;
  int64_t step = PERIOD_NS;
  if (flags & 4) fuzz_take(input, &step, sizeof step);
  const scene s = read_scene(input);
  const shot made = draw(&s, input, c, number, &pose);
  read_pose(input, pose_kind, &pose);
  f->t_ns = (int64_t)((uint64_t)f->t_ns + (uint64_t)step);
  vista_frame frame = {
      .image = {made.left, camera->width_px, camera->height_px, camera->width_px},
      .disparity = {made.words[0], camera->width_px, camera->height_px, camera->width_px},
      .pose = flags & 1 ? &pose : NULL,
      .up_world = flags & 8 ? up : NULL,
      .t_ns = f->t_ns,
      .stationary = flags & 64,
  };
  /* Coarser levels: as many as the seed says, the last of a wrong size now and then. */
  for (int32_t k = 0; k < (int32_t)(s.seed >> 1) % (1 + VISTA_COARSER_LEVELS); ++k)
    frame.coarser[k] =
        (vista_disparity_image){made.words[k + 1], made.width_px[k + 1], made.height_px[k + 1], made.width_px[k + 1]};
  if (wrong & 128) frame.coarser[s.seed % VISTA_COARSER_LEVELS].height_px += 1;
  if (wrong & 1) frame.image.stride = fuzz_between(input, 0, camera->width_px) - 8;
  if (wrong & 2) frame.disparity.stride = fuzz_between(input, 0, camera->width_px) - 8;
  if (wrong & 4) frame.image.width_px = fuzz_between(input, 0, camera->width_px);
  if (wrong & 8) frame.disparity.height_px = fuzz_between(input, 0, camera->height_px);
  if (wrong & 16) up[fuzz_byte(input) % 3] = fuzz_double(input);
  if (wrong & 32) frame.image.data = NULL;
  if (wrong & 32 && s.seed & 2) frame.image = (vista_image){0}; /* none came with the words */
  if (wrong & 64) frame.disparity.data = NULL;
  if (flags & 32) {
    for (int i = 0; i < 3; ++i) velocity[i] = wrong & 128 ? fuzz_double(input) : fuzz_between(input, -30, 30);
    frame.velocity_m_s = velocity;
  }
  if (flags & 16) reset(c);
  const vista_status status =
      c->detector != NULL ? through_detector(c, &made, &frame, f, number) : through_pipeline(c, &frame, f, number);
  mix(&f->digest, &status, sizeof status);
  frames += status == VISTA_OK;
  refused += status != VISTA_OK;
  drop(&made);
}

/* Flies all frames of the input, and returns what they gave as one number. */
static uint64_t fly(const craft *c, fuzz_input input) {
  flight f = {.input = input, .digest = 1};
  for (int32_t number = 0; number < FRAMES_MAX && f.input.size > 0; ++number) fly_frame(c, &f, number);
  return f.digest;
}

/* ---- inputs that reach the interior ---- */

/* Writes what the functions above read. */
typedef struct writer {
  uint8_t *data;
  size_t size, capacity;
  uint32_t random;
} writer;

static int32_t any_of(writer *w, int32_t count) { return (int32_t)(fuzz_random(&w->random) >> 8) % count; }

static void put(writer *w, const void *source, size_t bytes) {
  if (w->size + bytes > w->capacity) return;
  memcpy(w->data + w->size, source, bytes);
  w->size += bytes;
}

static void put_byte(writer *w, int32_t value) { put(w, &(uint8_t){(uint8_t)value}, 1); }

static void put_between(writer *w, int32_t low, int32_t value) { put(w, &(uint16_t){(uint16_t)(value - low)}, 2); }

static void put_parameter(writer *w, const char *name, double value) {
  int32_t index = 0;
  while (strcmp(vista_parameter_info(index)->name, name) != 0) ++index;
  const vista_parameter *const p = vista_parameter_info(index);
  put_byte(w, index);
  put_between(w, 0, (int32_t)lrint(65534.0 * (value - p->min) / (p->max - p->min)));
}

/* Settings that suit small images, and a few parameters within their ranges. */
static void write_parameters(writer *w) {
  const int32_t changes = any_of(w, 4), matcher = any_of(w, 8);
  put_byte(w, changes + 7);
  put_parameter(w, "plan.vehicle", any_of(w, 3) == 0);
  put_parameter(w, "alignment.correct", any_of(w, 3) == 0);
  put_parameter(w, "stereo.num_disparities", matcher < 5 ? 16 : matcher < 7 ? 32 : 64);
  put_parameter(w, "stereo.block_size", any_of(w, 3) == 0 ? 11 : 5);
  put_parameter(w, "stereo.levels", 1 + any_of(w, 4));
  put_parameter(w, "words.cluster_px", any_of(w, 4) == 0 ? 150 : 16);
  put_parameter(w, "foveation.sector_count", any_of(w, 4) == 0 ? 64 : 32);
  for (int32_t k = 0; k < changes; ++k) {
    put_byte(w, any_of(w, 256));
    put_between(w, 0, any_of(w, 65535));
  }
}

static void write_camera(writer *w) {
  const int32_t size = any_of(w, 64);
  put_byte(w, any_of(w, 16) == 0 ? any_of(w, 64) : 0);
  put_between(w, 16, size == 0 ? 161 + any_of(w, 160) : size < 7 ? 96 + any_of(w, 65) : 48 + any_of(w, 33));
  put_between(w, 16, size == 0 ? 121 + any_of(w, 120) : size < 7 ? 72 + any_of(w, 49) : 32 + any_of(w, 25));
  put_byte(w, any_of(w, 4) == 0 ? any_of(w, 256) : any_of(w, 60));
}

static int32_t any_mode(writer *w) {
  int32_t mode = any_of(w, 8) == 0 ? 2 * any_of(w, 2) : 1;
  if (any_of(w, 3) == 0) return mode;
  mode |= MODE_DETECTOR;
  if (any_of(w, 4) == 0) mode |= MODE_EVERY_PAIR;
  if (any_of(w, 12) == 0) mode |= MODE_STILLS;
  if (any_of(w, 2) == 0) mode |= MODE_OTHER_WORDS;
  if (any_of(w, 3) == 0) mode |= MODE_MATCHES;
  if (any_of(w, 4) == 0) mode |= MODE_PLANS;
  return mode;
}

/* A camera that can be, a few parameters within their ranges, and frames of one scene that comes nearer: mostly of a
 * world. Now and then a pose jumps, turns or is missing, a time or a size is wrong, or the scene is another one. */
static void write_flight(writer *w) {
  write_camera(w);
  write_parameters(w);
  put_byte(w, any_mode(w));
  const bool calm = any_of(w, 3) == 0; /* nothing is wrong */
  const bool posed = any_of(w, 8) != 0, worldly = any_of(w, 4) != 0;
  int32_t image = worldly && any_of(w, 8) != 0 ? IMAGE_WORLD : any_of(w, 3);
  int32_t words = worldly ? (any_of(w, 3) == 0 ? WORDS_TORN : WORDS_WORLD) : any_of(w, 4);
  const int32_t near = 16 * any_of(w, 60), far = any_of(w, 200), count = 2 + any_of(w, FRAMES_MAX - 1);
  int32_t seed = any_of(w, 1 << 20);
  for (int32_t k = 0; k < count; ++k) {
    const bool odd = !calm && any_of(w, 16) == 0, wrong = !calm && any_of(w, 24) == 0,
               late = !calm && any_of(w, 24) == 0;
    const bool told = posed && (calm || any_of(w, 16) != 0);
    if (!calm && any_of(w, 32) == 0) image = any_of(w, 5), words = any_of(w, 6), seed = any_of(w, 1 << 20);
    put_byte(w, (told                ? 1
                 : any_of(w, 4) == 0 ? 64
                                     : 0) |
                    (wrong ? 2 : 0) | (late ? 4 : 0) | 8 | (!calm && any_of(w, 48) == 0 ? 16 : 0));
    if (told) put_byte(w, odd ? any_of(w, 16) : 0);
    if (wrong) put_byte(w, any_of(w, 256));
    if (late) put(w, &(int64_t){(int64_t)PERIOD_NS * (any_of(w, 40) - 4)}, sizeof(int64_t));
    put_byte(w, image);
    put_byte(w, words);
    put(w, &seed, sizeof seed);
    put_between(w, -32, near + 20 * k);
    put_between(w, -32, far);
    for (int32_t bytes = odd ? any_of(w, 32) : 0; bytes > 0; --bytes) put_byte(w, any_of(w, 256));
  }
}

size_t LLVMFuzzerMutate(uint8_t *data, size_t size, size_t capacity);
size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t size, size_t capacity, unsigned seed);

/* libFuzzer asks it for each new input: half of them are flights, half what it makes of inputs that reached something. */
size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t size, size_t capacity, unsigned seed) {
  if (size > 0 && seed % 2 == 0) return LLVMFuzzerMutate(data, size, capacity);
  writer w = {.data = data, .capacity = capacity, .random = (seed * 2654435761u) | 1};
  write_flight(&w);
  return w.size;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  fuzz_input input = {data, size};
  craft c = {.camera = read_camera(&input)};
  c.parameters = read_parameters(&input);
  c.mode = fuzz_byte(&input);
  craft other = c;
  if (!create(&c)) return 0;
  const uint64_t digest = fly(&c, input);
  if ((c.mode & MODE_COMPARE) == 0) {
    reset(&c);
    check(fly(&c, input) == digest);
  }
  end(&c);
  if ((c.mode & MODE_COMPARE) == 2) {
    other.parameters.host.threads = 3 - other.parameters.host.threads;
    check(create(&other) && fly(&other, input) == digest);
    end(&other);
  }
  return 0;
}
