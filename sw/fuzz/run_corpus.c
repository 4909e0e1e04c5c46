/* In place of libFuzzer, where there is no clang: runs a fuzz target on every file that is named, without new inputs. */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);
size_t LLVMFuzzerMutate(uint8_t *data, size_t size, size_t capacity);

/* Stands in for libFuzzer's own, which the pipeline's mutator names; nothing calls it here. */
size_t LLVMFuzzerMutate(uint8_t *data, size_t size, size_t capacity) {
  (void)data, (void)capacity;
  return size;
}

int main(int argc, char **argv) {
  for (int i = 1; i < argc; ++i) {
    FILE *const stream = fopen(argv[i], "rb");
    if (stream == NULL || fseek(stream, 0, SEEK_END) != 0) return 1;
    const long size = ftell(stream);
    uint8_t *const data = malloc(size > 0 ? (size_t)size : 1);
    rewind(stream);
    if (data == NULL || fread(data, 1, (size_t)size, stream) != (size_t)size) return 1;
    (void)fclose(stream);
    fprintf(stderr, "running %s\n", argv[i]);
    (void)LLVMFuzzerTestOneInput(data, (size_t)size);
    free(data);
  }
  fprintf(stderr, "%d inputs run\n", argc - 1);
  return 0;
}
