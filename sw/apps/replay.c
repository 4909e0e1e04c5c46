/* replay: runs libvista over a recording (vista run --record FILE) without Python: for targets, memory checkers and
 * profilers.
 *
 *   replay RECORDING [--frames N] [--repeat N] [--threads N] [--times FILE.csv]
 *
 * stdout: one JSON line a frame with the obstacles, numbers to the last digit. stderr: times of the stages, of N
 * further runs over the recording. FILE.csv: the same frame by frame, and the processor time of each.
 * Exit status: 0, or 2 with one line on stderr that names what is wrong.
 * Format of a recording: sw/python/vista/recording.py. */
#define _DEFAULT_SOURCE /* madvise */
#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#if defined(__linux__)
#include <sys/mman.h>
#endif

#include "vista/vista.h"

#define MAGIC "VISTAREC"
#define VERSION 4
#define NAME_BYTES 48
#define CHOICE_BYTES 32
#define FRAME_HEAD_BYTES 140 /* t_ns, anew, has_pose, has_up, pose, up_world */

typedef struct recording {
  const char *path;
  FILE *stream;
  vista_camera camera;
  vista_parameters parameters;
  uint32_t coarser_levels;
  size_t words; /* of all levels of a frame */
  long first_frame; /* offset of the first frame */
  long frame_count;
} recording;

typedef struct frame_buffer {
  int64_t t_ns;
  uint32_t anew; /* the host forgets what came before */
  uint32_t has_pose, has_up;
  vista_pose pose;
  double up_world[3];
  uint8_t *left;
  int16_t *words; /* level by level */
} frame_buffer;

/* Columns of the times: the stages, their sum, processor time. */
static int column_host(void) { return vista_stage_count(); }
static int column_count(void) { return vista_stage_count() + 2; }

static const char *column_name(int column) {
  return column < column_host() ? vista_stage_name(column) : column == column_host() ? "host" : "cpu";
}

static int fail(const char *culprit, const char *reason) {
  fprintf(stderr, "replay: %s: %s\n", culprit, reason);
  return 2;
}

static bool read_exactly(FILE *stream, void *target, size_t bytes) { return fread(target, 1, bytes, stream) == bytes; }

static int read_parameters(recording *r, uint32_t count) {
  char message[NAME_BYTES + 32];
  r->parameters = vista_parameters_default();
  for (uint32_t i = 0; i < count; ++i) {
    char name[NAME_BYTES + 1] = {0}, choice[CHOICE_BYTES + 1] = {0};
    double value;
    if (!read_exactly(r->stream, name, NAME_BYTES) || !read_exactly(r->stream, choice, CHOICE_BYTES) ||
        !read_exactly(r->stream, &value, sizeof value))
      return fail(r->path, "cut off in the parameters");
    const vista_status status = choice[0] != '\0' ? vista_parameters_set_choice(&r->parameters, name, choice)
                                                  : vista_parameters_set(&r->parameters, name, value);
    if (status == VISTA_OK) continue;
    for (char *c = name; *c != '\0'; ++c)
      if (!isprint((unsigned char)*c)) *c = '?';
    (void)snprintf(message, sizeof message, "unknown parameter or value: %s", name);
    return fail(r->path, message);
  }
  const char *culprit = NULL;
  if (vista_parameters_check(&r->parameters, &culprit) == VISTA_OK) return 0;
  (void)snprintf(message, sizeof message, "%s is out of range", culprit);
  return fail(r->path, message);
}

static int32_t half(int32_t side_px) { return (side_px + 1) / 2; }

static size_t count_words(const recording *r) {
  int32_t width_px = r->camera.width_px, height_px = r->camera.height_px;
  size_t words = (size_t)width_px * (size_t)height_px;
  for (uint32_t k = 0; k < r->coarser_levels; ++k) {
    width_px = half(width_px);
    height_px = half(height_px);
    words += (size_t)width_px * (size_t)height_px;
  }
  return words;
}

/* Before any memory is asked for: the header may promise images that the file does not hold. */
static int count_frames(recording *r) {
  const long frame_bytes = FRAME_HEAD_BYTES + (long)r->camera.width_px * r->camera.height_px + 2L * (long)r->words;
  r->first_frame = ftell(r->stream);
  if (r->first_frame < 0 || fseek(r->stream, 0, SEEK_END) != 0) return fail(r->path, strerror(errno));
  const long bytes = ftell(r->stream) - r->first_frame;
  r->frame_count = bytes / frame_bytes;
  if (bytes == 0) return fail(r->path, "no frames");
  return bytes % frame_bytes == 0 ? 0 : fail(r->path, "cut off in a frame");
}

static int open_recording(recording *r) {
  char magic[8];
  uint32_t numbers[4]; /* version, width, height, parameter count */
  double camera[4];
  uint32_t coarser_levels;
  r->stream = fopen(r->path, "rb");
  if (r->stream == NULL) return fail(r->path, strerror(errno));
  if (!read_exactly(r->stream, magic, sizeof magic) || memcmp(magic, MAGIC, sizeof magic) != 0)
    return fail(r->path, "not a recording");
  if (!read_exactly(r->stream, numbers, sizeof numbers) || !read_exactly(r->stream, camera, sizeof camera) ||
      !read_exactly(r->stream, &coarser_levels, sizeof coarser_levels))
    return fail(r->path, "cut off in the header");
  if (numbers[0] != VERSION) return fail(r->path, "recorded by another version of vista: record it again");
  if (numbers[1] > VISTA_MOST_IMAGE_PX || numbers[2] > VISTA_MOST_IMAGE_PX)
    return fail(r->path, "images larger than 8192x8192");
  r->camera = (vista_camera){(int32_t)numbers[1], (int32_t)numbers[2], camera[0], camera[1], camera[2], camera[3]};
  if (coarser_levels > VISTA_COARSER_LEVELS) return fail(r->path, "more levels than are handled");
  r->coarser_levels = coarser_levels;
  r->words = count_words(r);
  const int exit_status = read_parameters(r, numbers[3]);
  return exit_status != 0 ? exit_status : count_frames(r);
}

static bool read_frame(const recording *r, frame_buffer *frame) {
  const size_t pixels = (size_t)r->camera.width_px * (size_t)r->camera.height_px;
  return read_exactly(r->stream, &frame->t_ns, sizeof frame->t_ns) &&
         read_exactly(r->stream, &frame->anew, sizeof frame->anew) &&
         read_exactly(r->stream, &frame->has_pose, sizeof frame->has_pose) &&
         read_exactly(r->stream, &frame->has_up, sizeof frame->has_up) &&
         read_exactly(r->stream, frame->pose.rotation, sizeof frame->pose.rotation) &&
         read_exactly(r->stream, frame->pose.translation_m, sizeof frame->pose.translation_m) &&
         read_exactly(r->stream, frame->up_world, sizeof frame->up_world) &&
         read_exactly(r->stream, frame->left, pixels) && read_exactly(r->stream, frame->words, 2 * r->words);
}

static void print_obstacle(const vista_obstacle *o) {
  printf(
      "{\"id\": %d, \"confirmed\": %s, \"age_frames\": %d, \"position_m\": [%.17g, %.17g, %.17g], "
      "\"distance_m\": %.17g, \"extent_m\": [%.17g, %.17g], \"disparity_px\": %.17g, "
      "\"in_collision_volume\": %s}",
      o->id, o->confirmed ? "true" : "false", o->age_frames, o->position_m[0], o->position_m[1], o->position_m[2],
      o->distance_m, o->extent_m[0], o->extent_m[1], o->disparity_px, o->in_collision_volume ? "true" : "false");
}

static void print_nearest(const vista_nearest_collision *nearest) {
  if (!nearest->valid) {
    printf("null");
    return;
  }
  printf("{\"id\": %d, \"distance_m\": %.17g, \"time_to_collision_s\": ", nearest->id, nearest->distance_m);
  if (isfinite(nearest->time_to_collision_s))
    printf("%.17g}", nearest->time_to_collision_s);
  else
    printf("null}");
}

static void print_result(long index, const vista_result *result) {
  printf("{\"frame\": %ld, \"cells\": %d, \"regions\": %d, \"valid_fraction\": %.17g, \"obstacles\": [", index,
         result->views->cell_count, result->region_count, result->valid_fraction);
  for (int32_t i = 0; i < result->obstacle_count; ++i) {
    if (i > 0) printf(", ");
    print_obstacle(vista_result_obstacle(result, i));
  }
  printf("], \"nearest_collision\": ");
  print_nearest(&result->nearest_collision);
  printf(", \"path_seen_m\": %.17g}\n", result->path_seen_m);
}

static int compare_doubles(const void *a, const void *b) {
  const double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

/* times_ms: a row of column_count() a frame. */
static int write_times(const char *path, const double *times_ms, long rows) {
  FILE *const stream = fopen(path, "w");
  if (stream == NULL) return fail(path, strerror(errno));
  for (int column = 0; column < column_count(); ++column)
    fprintf(stream, "%s%s", column_name(column), column + 1 < column_count() ? "," : "\n");
  for (long row = 0; row < rows; ++row)
    for (int column = 0; column < column_count(); ++column)
      fprintf(stream, "%.6f%s", times_ms[row * column_count() + column], column + 1 < column_count() ? "," : "\n");
  const bool written = !ferror(stream);
  return fclose(stream) == 0 && written ? 0 : fail(path, "cannot be written");
}

/* scratch: room for `rows` numbers. */
static void print_times(const double *times_ms, long rows, double *scratch) {
  fprintf(stderr, "%-16s %10s %10s   of %ld frames\n", "stage", "median ms", "p99 ms", rows);
  for (int column = 0; column < column_count(); ++column) {
    for (long row = 0; row < rows; ++row) scratch[row] = times_ms[row * column_count() + column];
    qsort(scratch, (size_t)rows, sizeof *scratch, compare_doubles);
    fprintf(stderr, "%-16s %10.3f %10.3f\n", column_name(column), scratch[rows / 2],
            scratch[(long)ceil(0.99 * (double)rows) - 1]);
  }
}

typedef struct options {
  const char *path, *times;
  long frames, repeat, threads; /* 0: all frames, as many threads as were recorded */
} options;

static bool parse(int argc, char **argv, options *o) {
  *o = (options){.repeat = 1};
  for (int i = 1; i < argc; ++i) {
    const bool times = strcmp(argv[i], "--times") == 0;
    long *const target = strcmp(argv[i], "--frames") == 0    ? &o->frames
                         : strcmp(argv[i], "--repeat") == 0  ? &o->repeat
                         : strcmp(argv[i], "--threads") == 0 ? &o->threads
                                                             : NULL;
    if (!times && target == NULL) {
      if (o->path != NULL || argv[i][0] == '-') return false;
      o->path = argv[i];
      continue;
    }
    if (++i == argc) return false;
    if (times) {
      o->times = argv[i];
      continue;
    }
    char *end = NULL;
    const long number = strtol(argv[i], &end, 10);
    if (*end != '\0' || number < 1 || number > 1000000) return false;
    *target = number;
  }
  return o->path != NULL;
}

typedef struct player {
  const recording *recording;
  void *memory;
  size_t bytes;
  frame_buffer frame;
  long frame_count;
} player;

/* The level that lies behind this one. */
static vista_disparity_image coarser_level(const vista_disparity_image *finer) {
  const int32_t width_px = half(finer->width_px);
  return (vista_disparity_image){finer->data + (ptrdiff_t)finer->width_px * finer->height_px, width_px,
                                 half(finer->height_px), width_px};
}

static vista_status step(const player *p, vista_pipeline *pipeline, vista_result *result) {
  const vista_camera *const camera = &p->recording->camera;
  vista_frame input = {
      .image = {p->frame.left, camera->width_px, camera->height_px, camera->width_px},
      .disparity = {p->frame.words, camera->width_px, camera->height_px, camera->width_px},
      .pose = p->frame.has_pose ? &p->frame.pose : NULL,
      .up_world = p->frame.has_up ? p->frame.up_world : NULL,
      .t_ns = p->frame.t_ns,
  };
  const vista_disparity_image *finer = &input.disparity;
  for (uint32_t k = 0; k < p->recording->coarser_levels; ++k) {
    input.coarser[k] = coarser_level(finer);
    finer = &input.coarser[k];
  }
  if (p->frame.anew) vista_pipeline_reset(pipeline);
  return vista_pipeline_process(pipeline, &input, result);
}

/* All frames; prints the results or, when there is room for them, notes the times. */
static int play_frames(player *p, vista_pipeline *pipeline, double *times_ms) {
  const recording *const r = p->recording;
  if (fseek(r->stream, r->first_frame, SEEK_SET) != 0) return fail(r->path, strerror(errno));
  for (long i = 0; i < p->frame_count; ++i) {
    if (!read_frame(r, &p->frame)) return fail(r->path, "cannot be read to its end");
    vista_result result;
    const clock_t start = clock();
    const vista_status status = step(p, pipeline, &result);
    const clock_t end = clock();
    if (status != VISTA_OK) return fail(r->path, vista_status_text(status));
    if (times_ms == NULL) {
      print_result(i, &result);
      continue;
    }
    double *const row = times_ms + i * column_count();
    memcpy(row, result.stage_ms, (size_t)result.stage_count * sizeof *row);
    row[column_host()] = result.host_ms;
    row[column_host() + 1] = 1e3 * (double)(end - start) / CLOCKS_PER_SEC;
  }
  if (times_ms != NULL) return 0;
  return fflush(stdout) == 0 && !ferror(stdout) ? 0 : fail("stdout", "cannot be written");
}

/* All frames once, with fresh tracks. */
static int play(player *p, double *times_ms) {
  const recording *const r = p->recording;
  vista_pipeline *pipeline;
  const vista_status created = vista_pipeline_create(p->memory, p->bytes, &r->parameters, &r->camera, &pipeline);
  if (created != VISTA_OK) return fail(r->path, vista_status_text(created));
  const int exit_status = play_frames(p, pipeline, times_ms);
  vista_pipeline_destroy(pipeline);
  return exit_status;
}

static int measure(player *p, const options *o) {
  const long rows = p->frame_count * o->repeat;
  double *const times_ms = malloc((size_t)rows * ((size_t)column_count() + 1) * sizeof *times_ms);
  if (times_ms == NULL) return fail(o->path, "out of memory");
  int exit_status = 0;
  for (long i = 0; i < o->repeat && exit_status == 0; ++i)
    exit_status = play(p, times_ms + i * p->frame_count * column_count());
  if (exit_status == 0) print_times(times_ms, rows, times_ms + rows * column_count());
  if (exit_status == 0 && o->times != NULL) exit_status = write_times(o->times, times_ms, rows);
  free(times_ms);
  return exit_status;
}

#define LARGE_PAGE_BYTES ((size_t)1 << 21)

/* On large pages, where the system has them: the stages go over more memory than small pages are looked up for quickly,
 * and are some 4 % faster. */
static void *take_memory(size_t bytes) {
  void *const memory = aligned_alloc(LARGE_PAGE_BYTES, (bytes / LARGE_PAGE_BYTES + 1) * LARGE_PAGE_BYTES);
#if defined(MADV_HUGEPAGE)
  if (memory != NULL) (void)madvise(memory, bytes, MADV_HUGEPAGE); /* without them it works, too */
#endif
  return memory;
}

static int replay(const recording *r, const options *o) {
  const size_t pixels = (size_t)r->camera.width_px * (size_t)r->camera.height_px;
  player p = {.recording = r, .frame_count = o->frames > 0 && o->frames < r->frame_count ? o->frames : r->frame_count};
  const vista_status status = vista_pipeline_bytes(&r->parameters, &r->camera, &p.bytes);
  if (status != VISTA_OK) return fail(r->path, vista_status_text(status));
  p.memory = take_memory(p.bytes);
  p.frame.left = malloc(pixels);
  p.frame.words = malloc(2 * r->words);
  const bool enough = p.memory != NULL && p.frame.left != NULL && p.frame.words != NULL;
  int exit_status = enough ? play(&p, NULL) : fail(r->path, "out of memory");
  if (exit_status == 0) exit_status = measure(&p, o);
  free(p.frame.words);
  free(p.frame.left);
  free(p.memory);
  return exit_status;
}

int main(int argc, char **argv) {
  options o;
  if (!parse(argc, argv, &o))
    return fail("usage", "replay RECORDING [--frames N] [--repeat N] [--threads N] [--times FILE.csv]");
  recording r = {.path = o.path};
  int exit_status = open_recording(&r);
  if (exit_status == 0 && o.threads > 0 &&
      (vista_parameters_set(&r.parameters, "host.threads", (double)o.threads) != VISTA_OK ||
       vista_parameters_check(&r.parameters, NULL) != VISTA_OK))
    exit_status = fail("--threads", "1 or 2");
  if (exit_status == 0) exit_status = replay(&r, &o);
  if (r.stream != NULL) (void)fclose(r.stream);
  return exit_status;
}
