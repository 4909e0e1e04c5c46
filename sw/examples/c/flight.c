/* A flight of two seconds towards a board that stands in a field: draws what both cameras see, matches the images with
 * the engine, hands the disparities and the camera's pose to the detector and prints the obstacles of every frame. */
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <vista/engine.h>
#include <vista/frontend.h>
#include <vista/vista.h>

enum { WIDTH = 320, HEIGHT = 240, LEVELS = 3, FRAMES = 20 };

static const vista_camera camera = {WIDTH, HEIGHT, 300.0, (WIDTH - 1) / 2.0, (HEIGHT - 1) / 2.0, 0.5};
static const double board_z_m = 30.0, ground_y_m = 4.0, start_z_m = 4.0, step_m = 0.9;

/* Waves that do not repeat: without texture nothing can be matched. */
static double texture(double a_m, double b_m, double mean) {
  static const double k[] = {1.7, 2.9, 4.3, 6.1, 8.9};
  double sum = 0.0;
  for (int i = 0; i < 5; ++i) sum += sin(k[i] * (a_m * cos(k[i]) + b_m * sin(k[i])) + k[i] * k[i]);
  return mean + 6.0 * sum;
}

/* World axes are those of the first camera: x to the right, y down, z ahead. */
static void draw(uint8_t *image, double x_m, double z_m) {
  for (int v = 0; v < HEIGHT; ++v) {
    for (int u = 0; u < WIDTH; ++u) {
      const double right = (u - camera.center_u_px) / camera.focal_px,
                   down = (v - camera.center_v_px) / camera.focal_px;
      const double board_m = board_z_m - z_m, x = x_m + right * board_m, y = down * board_m;
      double grey = 200.0; /* sky */
      if (x > -1.2 && x < 1.2 && y > -1.0 && y < ground_y_m) {
        grey = texture(3.0 * x, 3.0 * y, 150.0);
      } else if (down * 120.0 > ground_y_m) {
        const double ground_m = ground_y_m / down;
        grey = texture(x_m + right * ground_m, z_m + ground_m, 90.0);
      }
      image[v * WIDTH + u] = (uint8_t)grey;
    }
  }
}

/* Each level has half the size of the one before. */
typedef struct pyramid {
  uint8_t images[LEVELS][WIDTH * HEIGHT];
} pyramid;

static vista_engine_status reduce(pyramid *p, int level, int32_t width, int32_t height) {
  const vista_frontend_image image = {p->images[level], width, height, width};
  return vista_frontend_reduce(&image, p->images[level + 1], vista_frontend_reduced_px(width), VISTA_ENGINE_ISA_AUTO);
}

/* The words of all levels: what is too near for one is matched by the next. */
static vista_engine_status match(const vista_engine_params *engine, pyramid *left, pyramid *right, void *scratch,
                                 size_t scratch_bytes, int16_t words[LEVELS][WIDTH * HEIGHT], vista_frame *frame) {
  int32_t width = WIDTH, height = HEIGHT;
  for (int k = 0; k < LEVELS; ++k) {
    const vista_engine_images images = {left->images[k], right->images[k], width, height, width, width};
    const vista_engine_output output = {words[k], NULL, width, 0};
    vista_engine_status status = vista_engine_compute(engine, &images, &output, scratch, scratch_bytes);
    if (status == VISTA_ENGINE_OK && k + 1 < LEVELS) status = reduce(left, k, width, height);
    if (status == VISTA_ENGINE_OK && k + 1 < LEVELS) status = reduce(right, k, width, height);
    if (status != VISTA_ENGINE_OK) return status;
    *(k == 0 ? &frame->disparity : &frame->coarser[k - 1]) = (vista_disparity_image){words[k], width, height, width};
    width = vista_frontend_reduced_px(width);
    height = vista_frontend_reduced_px(height);
  }
  return VISTA_ENGINE_OK;
}

static void print_frame(int frame, const vista_result *result) {
  printf("frame %2d:", frame);
  for (int32_t i = 0; i < result->obstacle_count; ++i) {
    const vista_obstacle *o = vista_result_obstacle(result, i);
    if (o->confirmed)
      printf(" obstacle %" PRId32 " at %.1f m, %.1f x %.1f m;", o->id, o->distance_m, o->extent_m[0], o->extent_m[1]);
  }
  if (result->nearest_collision.valid) printf(" collision in %.1f s", result->nearest_collision.time_to_collision_s);
  printf("\n");
}

int main(void) {
  static pyramid left, right;
  static int16_t words[LEVELS][WIDTH * HEIGHT];
  const vista_engine_params engine = vista_engine_defaults();

  vista_parameters parameters = vista_parameters_default();
  parameters.stereo.num_disparities = engine.num_disparities; /* the detector asks how near the engine can match */
  size_t bytes = 0;
  vista_status status = vista_pipeline_bytes(&parameters, &camera, &bytes);
  if (status != VISTA_OK) return fprintf(stderr, "flight: %s\n", vista_status_text(status)), EXIT_FAILURE;

  const size_t scratch_bytes = vista_engine_scratch_bytes(&engine, WIDTH, HEIGHT, 1);
  void *const scratch = aligned_alloc(64, (scratch_bytes + 63) / 64 * 64), *const memory = malloc(bytes);
  vista_pipeline *pipeline = NULL;
  if (scratch == NULL || memory == NULL) return fprintf(stderr, "flight: out of memory\n"), EXIT_FAILURE;
  status = vista_pipeline_create(memory, bytes, &parameters, &camera, &pipeline);

  printf("libvista %s\n", vista_version());
  for (int i = 0; i < FRAMES && status == VISTA_OK; ++i) {
    const double z_m = start_z_m + step_m * i;
    const vista_pose pose = {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, z_m}};
    draw(left.images[0], 0.0, z_m);
    draw(right.images[0], camera.baseline_m, z_m);
    vista_frame frame = {
        .image = {left.images[0], WIDTH, HEIGHT, WIDTH}, .pose = &pose, .t_ns = (int64_t)(i + 1) * 100000000};
    const vista_engine_status matched = match(&engine, &left, &right, scratch, scratch_bytes, words, &frame);
    if (matched != VISTA_ENGINE_OK)
      return fprintf(stderr, "flight: %s\n", vista_engine_status_text(matched)), EXIT_FAILURE;
    vista_result result;
    status = vista_pipeline_process(pipeline, &frame, &result);
    if (status == VISTA_OK) print_frame(i, &result);
  }
  vista_pipeline_destroy(pipeline);
  free(memory);
  free(scratch);
  if (status != VISTA_OK) return fprintf(stderr, "flight: %s\n", vista_status_text(status)), EXIT_FAILURE;
  return EXIT_SUCCESS;
}
