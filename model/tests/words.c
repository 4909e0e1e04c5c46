/* The engine's words of pairs on stdin, on stdout: for machines other than that of the test.
 *
 * A pair: ten int32 (width, height, disparities, block, prefilter, cap, texture, uniqueness, left/right, instruction
 * set), then the left and the right image, uint8. Its words, int16, and its smallest costs, uint32, come out. All as the machine has them, which is little
 * endian. Exit status 1 when something fails, with a line on stderr. */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include "vista/engine.h"

static int fail(const char *what) {
  fprintf(stderr, "words: %s\n", what);
  return 1;
}

static int compute(const int32_t head[10]) {
  const int32_t width = head[0], height = head[1];
  const size_t pixels = (size_t)width * (size_t)height;
  const vista_engine_params params = {.num_disparities = head[2],
                                      .block_size = head[3],
                                      .prefilter = head[4],
                                      .prefilter_cap = head[5],
                                      .texture_threshold = head[6],
                                      .uniqueness_ratio = head[7],
                                      .lr_max_diff = head[8],
                                      .isa = head[9]};
  const size_t scratch_bytes = vista_engine_scratch_bytes(&params, width, height, 1);
  uint8_t *const images = malloc(2 * pixels);
  int16_t *const words = malloc(pixels * sizeof *words);
  uint32_t *const smin = malloc(pixels * sizeof *smin);
  uint16_t *const confidence = malloc(pixels * sizeof *confidence);
  void *const scratch = aligned_alloc(64, (scratch_bytes + 63) / 64 * 64);
  if (images == NULL || words == NULL || smin == NULL || confidence == NULL || scratch == NULL)
    return fail("no memory");
  if (fread(images, 1, 2 * pixels, stdin) != 2 * pixels) return fail("cut off");
  const vista_engine_images pair = {images, images + pixels, width, height, width, width};
  const vista_engine_output output = {words, smin, width, width, confidence, width};
  const vista_engine_status status = vista_engine_compute(&params, &pair, &output, scratch, scratch_bytes);
  if (status != VISTA_ENGINE_OK) return fail(vista_engine_status_text(status));
  const int whole = fwrite(words, sizeof *words, pixels, stdout) == pixels &&
                    fwrite(smin, sizeof *smin, pixels, stdout) == pixels &&
                    fwrite(confidence, sizeof *confidence, pixels, stdout) == pixels;
  free(images);
  free(words);
  free(smin);
  free(confidence);
  free(scratch);
  return whole ? 0 : fail("stdout");
}

int main(void) {
  int32_t head[10];
  while (fread(head, sizeof *head, 10, stdin) == 10)
    if (compute(head) != 0) return 1;
  return 0;
}
