/* Decodes pictures from stdin with the decoder of vista-fly: for each, four int32 (width, height, views, bytes) and the
 * data. To stdout: int32 whole, int32 allocations, then height * width / views bytes of the left and the right view. */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "jpeg.h"

static int32_t allocations;

void *__real_malloc(size_t bytes);
void *__wrap_malloc(size_t bytes);
void *__wrap_malloc(size_t bytes) {
  ++allocations;
  return __real_malloc(bytes);
}

int main(void) {
  int32_t head[4];
  while (fread(head, sizeof head, 1, stdin) == 1) {
    const size_t half = (size_t)head[0] / (size_t)head[2] * (size_t)head[1], scratch = jpeg_scratch_bytes(head[0]);
    unsigned char *const data = malloc((size_t)head[3] + 1), *const memory = malloc(scratch),
                         *const out = malloc(2 * half);
    if (data == NULL || memory == NULL || out == NULL || fread(data, 1, (size_t)head[3], stdin) != (size_t)head[3])
      return 1;
    memset(out, 7, 2 * half);
    const int32_t before = allocations;
    int32_t told[2] = {jpeg_decode(data, (size_t)head[3], head[0], head[1], head[2], memory, scratch, out, out + half)};
    told[1] = allocations - before;
    if (fwrite(told, sizeof told, 1, stdout) != 1 || fwrite(out, 2 * half, 1, stdout) != 1) return 1;
    free(out);
    free(memory);
    free(data);
  }
  return 0;
}
