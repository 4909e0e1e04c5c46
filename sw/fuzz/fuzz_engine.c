/* The engine on images and parameters of any kind: no error of memory or arithmetic, every instruction set gives the
 * words of the portable code, and bands of rows together give those of the whole image. */
#include <stdbool.h>
#include <stdio.h>

#include "input.h"
#include "vista/engine.h"

/* Most of a frame; columns: beside those that have no disparity. What sizes depend on, such as a second strip of columns or
 * group of disparities, is met in small frames, which take a hundredth of the time; one input in 512 is of any size. */
typedef struct limits {
  int32_t rows, columns, disparities;
} limits;

static const limits SMALL = {6, 40, 48}, LARGE = {28, 64, 256};
#define SMALL_OF 512

/* Of all bytes: whatever the fuzzer changes, the share of large frames stays. */
static limits read_limits(const fuzz_input *input) {
  uint32_t hash = 2166136261u; /* FNV-1a */
  for (size_t i = 0; i < input->size; ++i) hash = (hash ^ input->data[i]) * 16777619u;
  return (hash >> 16) % SMALL_OF == 0 ? LARGE : SMALL;
}

static int64_t frames; /* whose words were compared and have a disparity */

__attribute__((destructor)) static void tell(void) { fprintf(stderr, "stat::frames: %lld\n", (long long)frames); }

typedef struct frame {
  vista_engine_params params;
  vista_engine_images images;
} frame;

static int32_t valid_or_any(fuzz_input *input, bool any, int32_t low, int32_t step, int32_t count) {
  return any ? fuzz_int32(input) : low + step * fuzz_between(input, 0, count - 1);
}

static vista_engine_params read_params(fuzz_input *input, limits most) {
  const uint8_t any =
      fuzz_byte(input) == 255 ? fuzz_byte(input) : 0; /* a bit for each field that may be out of range */
  const int32_t disparities = valid_or_any(input, any & 1, 16, 16, most.disparities / 16);
  const int32_t block = valid_or_any(input, any & 2, 5, 2, 9);
  const int32_t texture_step = block >= 5 && block <= 21 ? block * block / 8 : 1; /* noise passes at most of these */
  return (vista_engine_params){
      .num_disparities = disparities,
      .block_size = block,
      .prefilter = valid_or_any(input, any & 4, 0, 1, 2),
      .prefilter_cap = valid_or_any(input, any & 8, 1, 1, 63),
      .texture_threshold = valid_or_any(input, any & 16, 0, texture_step, 100),
      .uniqueness_ratio = valid_or_any(input, any & 32, 0, 1, 101),
      .lr_max_diff = valid_or_any(input, any & 64, -1, 1, 300),
      .isa = valid_or_any(input, any & 128, 0, 1, 4),
  };
}

/* What the images show: bytes of the input, noise, noise of two grey levels (many ties), rows of noise with disparities
 * of their own. */
enum { KIND_BYTES, KIND_NOISE, KIND_TWO_LEVELS, KIND_ROWS_APART, KINDS };

typedef struct content {
  int32_t kind;
  int32_t shift, disparities; /* of noise: its disparity is the rest of one by the other, of rows apart row by row */
  int32_t error;              /* grey levels that a pixel may be off in the right image */
  uint32_t seed;
} content;

static void draw(fuzz_input *input, uint8_t *pixels, const vista_engine_images *images, ptrdiff_t stride, content c) {
  for (int32_t v = 0; v < images->height; ++v) {
    uint32_t state = (c.seed + 2654435761u * (uint32_t)v) | 1;
    const int32_t shift = (c.kind == KIND_ROWS_APART ? c.shift * v : c.shift) % c.disparities;
    for (int32_t skipped = 0; skipped < shift; ++skipped) (void)fuzz_random(&state);
    for (int32_t u = 0; u < images->width; ++u) {
      const uint32_t noise = (fuzz_random(&state) >> 8) + (uint32_t)((5 * u + 3 * v) % (c.error + 1));
      uint8_t *const pixel = &pixels[v * stride + u];
      *pixel = c.kind == KIND_BYTES        ? fuzz_byte(input)
               : c.kind == KIND_TWO_LEVELS ? (uint8_t)(noise % 2 * 255)
                                           : (uint8_t)noise;
    }
  }
}

static void compute(const frame *f, int32_t isa, int32_t bands, int16_t *words, uint32_t *smin, uint16_t *confidence) {
  vista_engine_params params = f->params;
  params.isa = isa;
  const int32_t width = f->images.width, height = f->images.height;
  const size_t bytes = vista_engine_scratch_bytes(&params, width, height, 1);
  if (bytes == 0) abort();
  void *const scratch = aligned_alloc(64, bytes);
  if (scratch == NULL || bytes % 64 != 0) abort();
  const vista_engine_output output = {words, smin, width, width, confidence, width};
  for (int32_t band = 0; band < bands; ++band) {
    const int32_t first = height * band / bands, end = height * (band + 1) / bands;
    if (vista_engine_compute_rows(&params, &f->images, &output, first, end, scratch, bytes) != VISTA_ENGINE_OK) abort();
  }
  free(scratch);
}

/* The words of every instruction set, in bands, against those of the portable code. True if one is a disparity. */
static bool compare(const frame *f, int32_t bands) {
  const size_t pixels = (size_t)f->images.width * (size_t)f->images.height;
  int16_t *const expected = fuzz_allocate(pixels * sizeof *expected), *const words =
                                                                          fuzz_allocate(pixels * sizeof *words);
  uint32_t *const expected_smin = fuzz_allocate(pixels * sizeof *expected_smin), *const smin = fuzz_allocate(
                                                                                     pixels * sizeof *smin);
  uint16_t *const expected_confidence = fuzz_allocate(pixels * sizeof *expected_confidence);
  uint16_t *const confidence = fuzz_allocate(pixels * sizeof *confidence);
  compute(f, VISTA_ENGINE_ISA_PORTABLE, 1, expected, expected_smin, expected_confidence);
  for (int32_t isa = VISTA_ENGINE_ISA_PORTABLE; isa <= VISTA_ENGINE_ISA_AVX512; ++isa) {
    if (!vista_engine_isa_available((vista_engine_isa)isa)) continue;
    memset(words, 0x5a, pixels * sizeof *words);
    memset(smin, 0x5a, pixels * sizeof *smin);
    memset(confidence, 0x5a, pixels * sizeof *confidence);
    compute(f, isa, bands, words, smin, confidence);
    if (memcmp(words, expected, pixels * sizeof *words) != 0 ||
        memcmp(smin, expected_smin, pixels * sizeof *smin) != 0 ||
        memcmp(confidence, expected_confidence, pixels * sizeof *confidence) != 0)
      abort();
  }
  bool matched = false;
  for (size_t i = 0; i < pixels; ++i) matched |= expected[i] >= 0;
  free(confidence);
  free(expected_confidence);
  free(smin);
  free(expected_smin);
  free(words);
  free(expected);
  return matched;
}

/* A call that the engine may refuse, with sizes, strides, rows and scratch of any value: what it refuses it does not
 * touch, what it accepts stays inside the memory. */
static void try_anything(fuzz_input *input, frame f, int16_t *words) {
  const uint8_t change = fuzz_byte(input);
  const int32_t width = f.images.width, height = f.images.height;
  vista_engine_output output = {.disparity = words, .disparity_stride = width};
  int32_t first = 0, end = height;
  size_t bytes = vista_engine_scratch_bytes(&f.params, width, height, 1);
  void *const scratch = aligned_alloc(64, bytes + 64);
  if (scratch == NULL) abort();
  if (change & 1) f.images.left_stride = fuzz_byte(input) - 64;
  if (change & 2) f.images.right_stride = fuzz_byte(input) - 64;
  if (change & 4) output.disparity_stride = fuzz_byte(input) - 64;
  if (change & 8) first = fuzz_int32(input);
  if (change & 16) end = fuzz_int32(input);
  if (change & 32) bytes = bytes > 0 ? bytes - 1 : 0;
  if (change & 64) f.images.right = NULL;
  if (change & 128) f.images.width = -width;
  const bool inside =
      f.images.left_stride <= width && f.images.right_stride <= width && output.disparity_stride <= width;
  if (inside) (void)vista_engine_compute_rows(&f.params, &f.images, &output, first, end, scratch, bytes);
  free(scratch);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  fuzz_input input = {data, size};
  const limits most = read_limits(&input);
  frame f = {.params = read_params(&input, most)};
  const bool matched = fuzz_byte(&input) % 8 != 0 && f.params.num_disparities > 0 && f.params.num_disparities <= 256;
  const int32_t around = matched && f.params.block_size >= 5 && f.params.block_size <= 21 ? f.params.block_size - 1 : 0;
  f.images.width = fuzz_between(&input, 1, most.columns) + (matched ? f.params.num_disparities + around : 0);
  f.images.height = fuzz_between(&input, 1, most.rows) + around;
  const int32_t bands = fuzz_between(&input, 1, 4);
  const content shown = {fuzz_byte(&input) % KINDS, fuzz_between(&input, 0, 255),
                         matched ? f.params.num_disparities : 1, fuzz_between(&input, 0, 9),
                         (uint32_t)fuzz_int32(&input)};
  const uint8_t room = fuzz_byte(&input) % 3;
  f.images.left_stride = f.images.width + room;
  f.images.right_stride = f.images.width;
  const size_t rows = (size_t)f.images.height;
  uint8_t *const left = fuzz_allocate(rows * (size_t)f.images.left_stride - room);
  uint8_t *const right = fuzz_allocate(rows * (size_t)f.images.width);
  fuzz_input anything = input;
  draw(&input, left, &f.images, f.images.left_stride, (content){shown.kind, 0, 1, 0, shown.seed});
  draw(&input, right, &f.images, f.images.right_stride, shown);
  f.images.left = left;
  f.images.right = right;
  if (vista_engine_validate(&f.params) == VISTA_ENGINE_OK) frames += compare(&f, bands);
  int16_t *const words = fuzz_allocate(rows * (size_t)f.images.width * sizeof *words);
  try_anything(&anything, f, words);
  free(words);
  free(right);
  free(left);
  return 0;
}
