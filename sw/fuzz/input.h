/* What a fuzz target reads its input with: numbers from the front, zeros behind the end. Pixels come in memory that
 * holds not a byte more than they need, so that AddressSanitizer sees every access beside them. */
#ifndef VISTA_FUZZ_INPUT_H
#define VISTA_FUZZ_INPUT_H

#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

typedef struct fuzz_input {
  const uint8_t *data;
  size_t size;
} fuzz_input;

static inline void fuzz_take(fuzz_input *input, void *target, size_t bytes) {
  const size_t taken = bytes < input->size ? bytes : input->size;
  memset(target, 0, bytes);
  if (taken > 0) memcpy(target, input->data, taken);
  input->data += taken;
  input->size -= taken;
}

static inline uint8_t fuzz_byte(fuzz_input *input) {
  uint8_t value;
  fuzz_take(input, &value, sizeof value);
  return value;
}

static inline int32_t fuzz_int32(fuzz_input *input) {
  int32_t value;
  fuzz_take(input, &value, sizeof value);
  return value;
}

/* Any bit pattern: huge, tiny, not a number. */
static inline double fuzz_double(fuzz_input *input) {
  double value;
  fuzz_take(input, &value, sizeof value);
  return value;
}

/* low, low + 1 .. high. */
static inline int32_t fuzz_between(fuzz_input *input, int32_t low, int32_t high) {
  uint16_t value;
  fuzz_take(input, &value, sizeof value);
  return low + value % (high - low + 1);
}

/* Never null, also for 0 bytes. */
static inline void *fuzz_allocate(size_t bytes) {
  void *const memory = malloc(bytes > 0 ? bytes : 1);
  if (memory == NULL) abort();
  return memory;
}

static inline uint32_t fuzz_random(uint32_t *state) { /* xorshift; the state is never 0 */
  *state ^= *state << 13;
  *state ^= *state >> 17;
  *state ^= *state << 5;
  return *state;
}

#endif
