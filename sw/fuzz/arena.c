/* In place of sw/src/common/arena.c: the same, but behind each array lie bytes that AddressSanitizer forbids. All the
 * arrays of a detector share one block of memory, and without that an access beyond one of them would find the next. */
#include "common/arena.h"

#include <sanitizer/asan_interface.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#define TOO_MUCH (SIZE_MAX / 2)
#define FORBIDDEN 128 /* bytes behind an array at least */

void *vista_arena_take(vista_arena *arena, size_t count, size_t item_bytes) {
  const size_t mask = VISTA_ARENA_ALIGNMENT - 1;
  const size_t gap = (VISTA_ARENA_ALIGNMENT - ((uintptr_t)arena->base + arena->used) % VISTA_ARENA_ALIGNMENT) & mask;
  const bool fits = item_bytes == 0 || count <= (TOO_MUCH - mask - FORBIDDEN) / item_bytes;
  const size_t wanted = fits ? count * item_bytes : 0;
  const size_t bytes = fits ? (wanted + FORBIDDEN + mask) & ~mask : TOO_MUCH;
  const size_t start = arena->used + gap;
  arena->used = start > TOO_MUCH - bytes ? TOO_MUCH : start + bytes;
  if (arena->base == NULL || arena->used > arena->size) return NULL;
  unsigned char *const taken = arena->base + start;
  ASAN_UNPOISON_MEMORY_REGION(taken, wanted); /* the memory may have been another detector's */
  memset(taken, 0, wanted);
  ASAN_POISON_MEMORY_REGION(taken + wanted, bytes - wanted);
  return taken;
}
