/* A flight of two seconds towards a board that stands in a field: draws what both cameras see, hands the pair and the
 * camera's pose to the detector and prints the obstacles of every frame. */
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <vista/vista.h>

enum { WIDTH = 320, HEIGHT = 240, FRAMES = 20 };

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
  static uint8_t left[WIDTH * HEIGHT], right[WIDTH * HEIGHT];
  const vista_parameters parameters = vista_parameters_default();
  const vista_rig rig = {.camera = camera}; /* the images come rectified */
  const vista_detector_options options = {0};
  size_t bytes = 0;
  vista_status status = vista_detector_bytes(&parameters, &rig, &options, &bytes);
  if (status != VISTA_OK) return fprintf(stderr, "flight: %s\n", vista_status_text(status)), EXIT_FAILURE;

  void *const memory = malloc(bytes);
  vista_detector *detector = NULL;
  if (memory == NULL) return fprintf(stderr, "flight: out of memory\n"), EXIT_FAILURE;
  status = vista_detector_create(memory, bytes, &parameters, &rig, &options, &detector);

  printf("libvista %s\n", vista_version());
  for (int i = 0; i < FRAMES && status == VISTA_OK; ++i) {
    const double z_m = start_z_m + step_m * i;
    const vista_pose pose = {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, z_m}};
    draw(left, 0.0, z_m);
    draw(right, camera.baseline_m, z_m);
    const vista_detector_pair pair = {.left = {left, WIDTH, HEIGHT, WIDTH},
                                      .right = {right, WIDTH, HEIGHT, WIDTH},
                                      .t_ns = (int64_t)(i + 1) * 100000000};
    const vista_detector_place place = {.pose = &pose};
    vista_novelty novelty;
    vista_detector_result found;
    status = vista_detector_process(detector, &pair, &place, &novelty, &found);
    if (status == VISTA_OK && novelty != VISTA_PAIR_REPEATED) print_frame(i, &found.result);
  }
  vista_detector_destroy(detector);
  free(memory);
  if (status != VISTA_OK) return fprintf(stderr, "flight: %s\n", vista_status_text(status)), EXIT_FAILURE;
  return EXIT_SUCCESS;
}
