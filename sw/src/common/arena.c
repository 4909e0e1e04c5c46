#include "common/arena.h"

#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#define TOO_MUCH (SIZE_MAX / 2) /* saturated: it can never fit */

void *vista_arena_take(vista_arena *arena, size_t count, size_t item_bytes) {
  const size_t mask = VISTA_ARENA_ALIGNMENT - 1;
  const size_t gap = (VISTA_ARENA_ALIGNMENT - ((uintptr_t)arena->base + arena->used) % VISTA_ARENA_ALIGNMENT) & mask;
  const bool fits = item_bytes == 0 || count <= (TOO_MUCH - mask) / item_bytes;
  const size_t bytes = fits ? (count * item_bytes + mask) & ~mask : TOO_MUCH;
  const size_t start = arena->used + gap;
  arena->used = start > TOO_MUCH - bytes ? TOO_MUCH : start + bytes;
  if (arena->base == NULL || arena->used > arena->size) return NULL;
  memset(arena->base + start, 0, bytes);
  return arena->base + start;
}
