#include "common/arena.h"

#include <stdint.h>
#include <string.h>

void *vista_arena_take(vista_arena *arena, size_t count, size_t item_bytes) {
  const size_t mask = VISTA_ARENA_ALIGNMENT - 1;
  if (item_bytes != 0 && count > (SIZE_MAX / 2 - mask) / item_bytes) { /* saturate: it can never fit */
    arena->used = SIZE_MAX / 2;
    return NULL;
  }
  const size_t bytes = (count * item_bytes + mask) & ~mask;
  const size_t start = arena->used;
  arena->used = start > SIZE_MAX / 2 - bytes ? SIZE_MAX / 2 : start + bytes;
  if (arena->base == NULL || arena->used > arena->size) return NULL;
  memset(arena->base + start, 0, bytes);
  return arena->base + start;
}
