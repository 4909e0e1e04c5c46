/* vista-replay: runs libvista over a recording (vista run --record FILE) without Python: for targets, memory
 * checkers and profilers.
 *
 *   replay RECORDING [--frames N] [--repeat N]
 *
 * stdout: one JSON line a frame with the obstacles, numbers to the last digit. stderr: times of the stages.
 * Exit status: 0, or 2 with one line on stderr that names what is wrong.
 * Format of a recording: sw/python/vista/recording.py. */
#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "vista/pipeline.h"

#define MAGIC "VISTAREC"
#define VERSION 2
#define NAME_BYTES 48

typedef struct recording {
  const char *path;
  FILE *stream;
  vista_camera camera;
  vista_parameters parameters;
  uint32_t stills; /* the frames are unrelated: no tracking from one to the next */
  long first_frame; /* offset of the first frame */
} recording;

typedef struct frame_buffer {
  int64_t t_ns;
  uint32_t has_pose, has_up;
  vista_pose pose;
  double up_world[3];
  uint8_t *left;
  int16_t *disparity;
} frame_buffer;

static int fail(const char *culprit, const char *reason) {
  fprintf(stderr, "replay: %s: %s\n", culprit, reason);
  return 2;
}

static bool read_exactly(FILE *stream, void *target, size_t bytes) { return fread(target, 1, bytes, stream) == bytes; }

static int open_recording(recording *r) {
  char magic[8];
  uint32_t numbers[4]; /* version, width, height, parameter count */
  double camera[4];
  uint32_t flags[2]; /* stills, 0 */
  r->stream = fopen(r->path, "rb");
  if (r->stream == NULL) return fail(r->path, strerror(errno));
  if (!read_exactly(r->stream, magic, sizeof magic) || memcmp(magic, MAGIC, sizeof magic) != 0)
    return fail(r->path, "not a recording");
  if (!read_exactly(r->stream, numbers, sizeof numbers) || !read_exactly(r->stream, camera, sizeof camera) ||
      !read_exactly(r->stream, flags, sizeof flags))
    return fail(r->path, "cut off in the header");
  if (numbers[0] != VERSION) return fail(r->path, "a recording of another version");
  if (numbers[1] > 8192 || numbers[2] > 8192) return fail(r->path, "images larger than 8192x8192");
  r->camera = (vista_camera){(int32_t)numbers[1], (int32_t)numbers[2], camera[0], camera[1], camera[2], camera[3]};
  r->stills = flags[0];
  r->parameters = vista_parameters_default();
  for (uint32_t i = 0; i < numbers[3]; ++i) {
    char name[NAME_BYTES + 1] = {0};
    double value;
    if (!read_exactly(r->stream, name, NAME_BYTES) || !read_exactly(r->stream, &value, sizeof value))
      return fail(r->path, "cut off in the parameters");
    if (vista_parameters_set(&r->parameters, name, value) != VISTA_OK) return fail(name, "unknown parameter");
  }
  r->first_frame = ftell(r->stream);
  return 0;
}

/* 1: a frame; 0: the end; -1: cut off. */
static int read_frame(const recording *r, frame_buffer *frame) {
  const size_t pixels = (size_t)r->camera.width_px * (size_t)r->camera.height_px;
  const size_t first = fread(&frame->t_ns, 1, sizeof frame->t_ns, r->stream);
  if (first == 0) return 0;
  const bool complete = first == sizeof frame->t_ns && read_exactly(r->stream, &frame->has_pose, 4) &&
                        read_exactly(r->stream, &frame->has_up, 4) &&
                        read_exactly(r->stream, frame->pose.rotation, sizeof frame->pose.rotation) &&
                        read_exactly(r->stream, frame->pose.translation_m, sizeof frame->pose.translation_m) &&
                        read_exactly(r->stream, frame->up_world, sizeof frame->up_world) &&
                        read_exactly(r->stream, frame->left, pixels) &&
                        read_exactly(r->stream, frame->disparity, 2 * pixels);
  return complete ? 1 : -1;
}

static void print_result(int index, const vista_result *result) {
  printf("{\"frame\": %d, \"regions\": %d, \"valid_fraction\": %.17g, \"obstacles\": [", index, result->region_count,
         result->valid_fraction);
  for (int32_t i = 0; i < result->obstacle_count; ++i) {
    const vista_obstacle *const o = &result->obstacles[i];
    printf("%s{\"id\": %d, \"confirmed\": %s, \"position_m\": [%.17g, %.17g, %.17g], \"distance_m\": %.17g}",
           i == 0 ? "" : ", ", o->id, o->confirmed ? "true" : "false", o->position_m[0], o->position_m[1],
           o->position_m[2], o->distance_m);
  }
  if (result->nearest_collision.valid)
    printf("], \"nearest_collision\": %d}\n", result->nearest_collision.id);
  else
    printf("], \"nearest_collision\": null}\n");
}

static int compare_doubles(const void *a, const void *b) {
  const double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

static void print_times(double *stage_ms, int frames) {
  fprintf(stderr, "%-16s %10s %10s   of %d frames\n", "stage", "median ms", "p99 ms", frames);
  for (int stage = 0; stage <= VISTA_STAGE_COUNT; ++stage) {
    double *const column = stage_ms + (size_t)stage * (size_t)frames;
    qsort(column, (size_t)frames, sizeof *column, compare_doubles);
    fprintf(stderr, "%-16s %10.3f %10.3f\n",
            stage < VISTA_STAGE_COUNT ? vista_stage_name((vista_stage)stage) : "host", column[frames / 2],
            column[(int)ceil(0.99 * frames) - 1]);
  }
}

typedef struct options {
  const char *path;
  long frames, repeat;
} options;

static bool parse(int argc, char **argv, options *o) {
  *o = (options){.frames = -1, .repeat = 1};
  for (int i = 1; i < argc; ++i) {
    long *const number = strcmp(argv[i], "--frames") == 0 ? &o->frames : strcmp(argv[i], "--repeat") == 0 ? &o->repeat : NULL;
    if (number == NULL) {
      if (o->path != NULL || argv[i][0] == '-') return false;
      o->path = argv[i];
      continue;
    }
    char *end = NULL;
    if (++i == argc) return false;
    *number = strtol(argv[i], &end, 10);
    if (*end != '\0' || *number < 1 || *number > 1000000) return false;
  }
  return o->path != NULL;
}

/* All frames once, with fresh tracks. Prints when asked; returns the number of frames or minus the exit status. */
static long run(const recording *r, void *memory, size_t bytes, frame_buffer *frame, long limit, bool print,
                double *stage_ms, long column) {
  vista_pipeline *pipeline;
  const vista_status created = vista_pipeline_create(memory, bytes, &r->parameters, &r->camera, &pipeline);
  if (created != VISTA_OK) return -fail(r->path, vista_status_text(created));
  if (fseek(r->stream, r->first_frame, SEEK_SET) != 0) return -fail(r->path, strerror(errno));
  long count = 0;
  for (; limit < 0 || count < limit; ++count) {
    const int got = read_frame(r, frame);
    if (got < 0) return -fail(r->path, "cut off in a frame");
    if (got == 0) break;
    const vista_frame input = {
        .image = {frame->left, r->camera.width_px, r->camera.height_px, r->camera.width_px},
        .disparity = {frame->disparity, r->camera.width_px, r->camera.height_px, r->camera.width_px},
        .pose = frame->has_pose ? &frame->pose : NULL,
        .up_world = frame->has_up ? frame->up_world : NULL,
        .t_ns = frame->t_ns,
    };
    if (r->stills) vista_pipeline_reset(pipeline);
    vista_result result;
    const vista_status status = vista_pipeline_process(pipeline, &input, &result);
    if (status != VISTA_OK) return -fail(r->path, vista_status_text(status));
    if (print) print_result((int)count, &result);
    if (stage_ms == NULL) continue;
    for (int stage = 0; stage < VISTA_STAGE_COUNT; ++stage) stage_ms[stage * column + count] = result.stage_ms[stage];
    stage_ms[VISTA_STAGE_COUNT * column + count] = result.host_ms;
  }
  return count;
}

static int replay(recording *r, const options *o) {
  size_t bytes;
  const vista_status status = vista_pipeline_bytes(&r->parameters, &r->camera, &bytes);
  if (status != VISTA_OK) return fail(r->path, vista_status_text(status));
  const size_t pixels = (size_t)r->camera.width_px * (size_t)r->camera.height_px;
  void *const memory = malloc(bytes);
  frame_buffer frame = {.left = malloc(pixels), .disparity = malloc(2 * pixels)};
  double *stage_ms = NULL;
  int exit_status = 0;
  if (memory == NULL || frame.left == NULL || frame.disparity == NULL) {
    exit_status = fail(r->path, "out of memory");
  } else {
    const long count = run(r, memory, bytes, &frame, o->frames, true, NULL, 0);
    if (count == 0) exit_status = fail(r->path, "no frames");
    if (count < 0) exit_status = (int)-count;
    if (exit_status == 0) {
      stage_ms = malloc((VISTA_STAGE_COUNT + 1) * (size_t)(count * o->repeat) * sizeof *stage_ms);
      if (stage_ms == NULL) exit_status = fail(r->path, "out of memory");
      for (long i = 0; i < o->repeat && exit_status == 0; ++i)
        if (run(r, memory, bytes, &frame, count, false, stage_ms + i * count, count * o->repeat) != count)
          exit_status = 2;
      if (exit_status == 0) print_times(stage_ms, (int)(count * o->repeat));
    }
  }
  free(stage_ms);
  free(frame.disparity);
  free(frame.left);
  free(memory);
  return exit_status;
}

int main(int argc, char **argv) {
  options o;
  if (!parse(argc, argv, &o)) return fail("usage", "replay RECORDING [--frames N] [--repeat N]");
  recording r = {.path = o.path};
  int exit_status = open_recording(&r);
  if (exit_status == 0) exit_status = replay(&r, &o);
  if (r.stream != NULL) (void)fclose(r.stream);
  return exit_status;
}
