/* The detector on parameters, cameras, images, words, poses and times of any kind: no error of memory or arithmetic,
 * and whatever it accepted before, after a reset it gives the same for an ordinary flight as a new detector does. */
#include <math.h>
#include <stdbool.h>
#include <stdint.h>

#include "input.h"
#include "vista/vista.h"

#define FRAMES_MAX 5
#define PERIOD_NS 100000000

typedef struct detector {
  void *memory;
  vista_pipeline *pipeline;
} detector;

static detector create(const vista_parameters *parameters, const vista_camera *camera) {
  size_t bytes;
  detector d = {NULL, NULL};
  if (vista_pipeline_bytes(parameters, camera, &bytes) != VISTA_OK) return d;
  d.memory = fuzz_allocate(bytes);
  if (vista_pipeline_create(d.memory, bytes, parameters, camera, &d.pipeline) != VISTA_OK) abort();
  return d;
}

static void end(const detector *d) {
  vista_pipeline_destroy(d->pipeline); /* its second thread uses the memory */
  free(d->memory);
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
  const int32_t width = fuzz_between(input, 16, 80), height = fuzz_between(input, 16, 56);
  vista_camera camera = {width, height, 60.0 + fuzz_byte(input), width / 2.0, height / 2.0, 0.5};
  if (any & 1) camera.focal_px = fuzz_double(input);
  if (any & 2) camera.center_u_px = fuzz_double(input);
  if (any & 4) camera.center_v_px = fuzz_double(input);
  if (any & 8) camera.baseline_m = fuzz_double(input);
  if (any & 16) camera.center_u_px += fuzz_int32(input) / 65536.0;
  if (any & 32) camera.center_v_px += fuzz_int32(input) / 65536.0;
  return camera;
}

typedef struct scene { /* what draws a frame */
  uint8_t image, words;
  uint32_t seed;
  int32_t near_disparity; /* words of the thing in the middle */
  int32_t far_disparity;
} scene;

static scene read_scene(fuzz_input *input) {
  scene s = {fuzz_byte(input) % 4, fuzz_byte(input) % 5, (uint32_t)fuzz_int32(input) | 1, 0, 0};
  s.near_disparity = fuzz_between(input, -32, 1100);
  s.far_disparity = fuzz_between(input, -32, 300);
  return s;
}

static void draw(const scene *s, fuzz_input *input, const vista_camera *camera, uint8_t *image, int16_t *words) {
  uint32_t state = s->seed;
  const int32_t width = camera->width_px, height = camera->height_px;
  for (int32_t v = 0; v < height; ++v)
    for (int32_t u = 0; u < width; ++u) {
      const uint32_t noise = fuzz_random(&state) >> 8;
      const bool thing = abs(2 * u - width) < width / 2 && abs(2 * v - height) < height - 8;
      const int32_t at = v * width + u;
      switch (s->image) {
        case 0:
          image[at] = (uint8_t)(thing ? 60 : 160);
          break;
        case 1:
          image[at] = (uint8_t)((thing ? 60 : 140) + noise % 40);
          break;
        case 2:
          image[at] = (uint8_t)noise;
          break;
        default:
          image[at] = fuzz_byte(input);
      }
      switch (s->words) {
        case 0:
          words[at] = (int16_t)(thing ? s->near_disparity : s->far_disparity);
          break;
        case 1:
          words[at] = (int16_t)((thing ? s->near_disparity : s->far_disparity * v / height) + (int32_t)(noise % 5));
          break;
        case 2:
          words[at] = (int16_t)(noise % 8 == 0 ? VISTA_DISPARITY_INVALID
                                : thing        ? s->near_disparity
                                               : s->far_disparity);
          break;
        case 3:
          words[at] = (int16_t)noise;
          break;
        default:
          words[at] = (int16_t)(16 * fuzz_byte(input) - 16 * (fuzz_byte(input) % 8));
      }
    }
}

static void read_pose(fuzz_input *input, uint8_t kind, double ahead_m, vista_pose *pose) {
  const double angle = kind & 1 ? fuzz_between(input, -3142, 3142) / 1000.0 : 0.0;
  *pose = (vista_pose){{cos(angle), 0, sin(angle), 0, 1, 0, -sin(angle), 0, cos(angle)}, {0.0, 0.0, ahead_m}};
  for (int i = 0; i < 3; ++i) {
    if (kind & 2) pose->translation_m[i] += fuzz_int32(input) / 1000.0;
    if (kind & 4) pose->translation_m[i] = fuzz_double(input);
  }
  if (kind & 8) pose->rotation[fuzz_byte(input) % 9] = fuzz_double(input);
}

static void check_finite(const double *numbers, int32_t count) {
  for (int32_t i = 0; i < count; ++i)
    if (!isfinite(numbers[i])) abort();
}

static void check_result(const vista_result *result) {
  if (!(result->valid_fraction >= 0.0 && result->valid_fraction <= 1.0)) abort();
  if (result->obstacle_count < 0 || result->accepted_count > result->region_count) abort();
  check_finite(result->motion.velocity_m_s, 3);
  check_finite(result->motion.pose.translation_m, 3);
  for (int32_t i = 0; i < result->obstacle_count; ++i) {
    const vista_obstacle *const o = &result->obstacles[i];
    check_finite(o->position_m, 3);
    check_finite(&o->distance_m, 1);
    if (i > 0 && o->distance_m < result->obstacles[i - 1].distance_m) abort();
  }
  if (result->nearest_collision.valid) check_finite(&result->nearest_collision.distance_m, 1);
}

/* One frame in memory of exactly its size, as the input says: sizes, strides, pose, up and time may be wrong. */
static void fly_any(fuzz_input *input, const detector *d, const vista_camera *camera, int64_t *t_ns, int32_t number) {
  const size_t pixels = (size_t)camera->width_px * (size_t)camera->height_px;
  uint8_t *const image = fuzz_allocate(pixels);
  int16_t *const words = fuzz_allocate(2 * pixels);
  double up[3] = {0.0, -1.0, 0.0}, velocity[3];
  vista_pose pose;
  vista_result result;
  const uint8_t flags = fuzz_byte(input), pose_kind = flags & 1 ? fuzz_byte(input) : 0;
  const uint8_t wrong = flags & 2 ? fuzz_byte(input) : 0;
  int64_t step = PERIOD_NS;
  if (flags & 4) fuzz_take(input, &step, sizeof step);
  const scene s = read_scene(input);
  draw(&s, input, camera, image, words);
  read_pose(input, pose_kind, 0.5 * number, &pose);
  *t_ns = (int64_t)((uint64_t)*t_ns + (uint64_t)step);
  vista_frame frame = {
      .image = {image, camera->width_px, camera->height_px, camera->width_px},
      .disparity = {words, camera->width_px, camera->height_px, camera->width_px},
      .pose = flags & 1 ? &pose : NULL,
      .up_world = flags & 8 ? up : NULL,
      .t_ns = *t_ns,
      .stationary = flags & 64,
  };
  /* The words over again as those of coarser levels: as many as the seed says, the last of a wrong size now and then. */
  int32_t width = camera->width_px, height = camera->height_px;
  for (int32_t k = 0; k < (int32_t)(s.seed >> 1) % (1 + VISTA_COARSER_LEVELS); ++k) {
    width = (width + 1) / 2;
    height = (height + 1) / 2;
    frame.coarser[k] = (vista_disparity_image){words, width, height, camera->width_px};
  }
  if (wrong & 128) frame.coarser[s.seed % VISTA_COARSER_LEVELS].height_px += 1;
  if (wrong & 1) frame.image.stride = fuzz_between(input, 0, camera->width_px) - 8;
  if (wrong & 2) frame.disparity.stride = fuzz_between(input, 0, camera->width_px) - 8;
  if (wrong & 4) frame.image.width_px = fuzz_between(input, 0, camera->width_px);
  if (wrong & 8) frame.disparity.height_px = fuzz_between(input, 0, camera->height_px);
  if (wrong & 16) up[fuzz_byte(input) % 3] = fuzz_double(input);
  if (wrong & 32) frame.image.data = NULL;
  if (wrong & 64) frame.disparity.data = NULL;
  if (flags & 32) {
    for (int i = 0; i < 3; ++i) velocity[i] = wrong & 128 ? fuzz_double(input) : fuzz_between(input, -30, 30);
    frame.velocity_m_s = velocity;
  }
  if (flags & 16) vista_pipeline_reset(d->pipeline);
  if (vista_pipeline_process(d->pipeline, &frame, &result) == VISTA_OK) check_result(&result);
  free(words);
  free(image);
}

/* What a short approach to a thing gives, in numbers that do not depend on the ids. */
static uint64_t fly_ordinary(const detector *d, const vista_camera *camera) {
  const size_t pixels = (size_t)camera->width_px * (size_t)camera->height_px;
  uint8_t *const image = fuzz_allocate(pixels);
  int16_t *const words = fuzz_allocate(2 * pixels);
  uint64_t digest = 0;
  for (int32_t number = 0; number < 3; ++number) {
    const scene s = {1, 1, 12345, 200 + 10 * number, 40};
    fuzz_input nothing = {NULL, 0};
    draw(&s, &nothing, camera, image, words);
    const vista_pose pose = {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0.0, 0.0, 0.5 * number}};
    const vista_frame frame = {
        .image = {image, camera->width_px, camera->height_px, camera->width_px},
        .disparity = {words, camera->width_px, camera->height_px, camera->width_px},
        .pose = &pose,
        .t_ns = (int64_t)number * PERIOD_NS,
    };
    vista_result result;
    const vista_status status = vista_pipeline_process(d->pipeline, &frame, &result);
    digest = 31 * digest + (uint64_t)status;
    if (status != VISTA_OK) continue; /* parameters may be such that sums of capacities overflow */
    check_result(&result);
    digest = 31 * digest + (uint64_t)result.region_count;
    for (int32_t i = 0; i < result.obstacle_count; ++i) {
      uint64_t bits;
      memcpy(&bits, &result.obstacles[i].distance_m, sizeof bits);
      digest = 31 * digest + bits;
    }
  }
  free(words);
  free(image);
  return digest;
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

/* A camera that can be, a few parameters within their ranges, and frames of one scene that comes nearer. Now and then a
 * pose jumps or turns, a time or a size is wrong, or the scene is another one. */
static void write_flight(writer *w) {
  put_byte(w, any_of(w, 8) == 0 ? any_of(w, 64) : 0);
  put_between(w, 16, 48 + any_of(w, 33));
  put_between(w, 16, 32 + any_of(w, 25));
  put_byte(w, any_of(w, 256));
  const int32_t changes = any_of(w, 4);
  put_byte(w, changes);
  for (int32_t k = 0; k < changes; ++k) {
    put_byte(w, any_of(w, 256));
    put_between(w, 0, any_of(w, 65535));
  }
  put_byte(w, any_of(w, 8) == 0 ? 0 : 1);
  int32_t image = any_of(w, 3), words = any_of(w, 4), near = 16 * any_of(w, 60), far = any_of(w, 200);
  int32_t seed = any_of(w, 1 << 20);
  for (int32_t k = 0; k < FRAMES_MAX; ++k) {
    const bool odd = any_of(w, 16) == 0, wrong = any_of(w, 16) == 0, late = any_of(w, 16) == 0;
    if (any_of(w, 16) == 0) image = any_of(w, 3), words = any_of(w, 4), seed = any_of(w, 1 << 20);
    put_byte(w, 1 | (wrong ? 2 : 0) | (late ? 4 : 0) | 8 | (any_of(w, 32) == 0 ? 16 : 0));
    put_byte(w, odd ? any_of(w, 16) : 0);
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
  const vista_camera camera = read_camera(&input);
  const vista_parameters parameters = read_parameters(&input);
  const detector d = create(&parameters, &camera);
  if (d.pipeline == NULL) return 0;
  int64_t t_ns = 0;
  const bool compare = fuzz_byte(&input) % 4 == 0;
  for (int32_t number = 0; number < FRAMES_MAX && input.size > 0; ++number) fly_any(&input, &d, &camera, &t_ns, number);
  if (compare) {
    const detector fresh = create(&parameters, &camera);
    vista_pipeline_reset(d.pipeline);
    if (fly_ordinary(&d, &camera) != fly_ordinary(&fresh, &camera)) abort();
    end(&fresh);
  }
  end(&d);
  return 0;
}
