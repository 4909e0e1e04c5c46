/* Caller-owned memory, handed out once at creation and never given back.
 *
 * A module lays its arrays out through an arena. With base == NULL the arena only counts, so the same
 * layout function first answers "how many bytes?" and then, on real memory, places the arrays. Memory that is not
 * aligned itself takes up to VISTA_ARENA_ALIGNMENT - 1 bytes more than were counted. */
#ifndef VISTA_ARENA_H
#define VISTA_ARENA_H

#include <stddef.h>

#define VISTA_ARENA_ALIGNMENT 64

typedef struct vista_arena {
  unsigned char *base; /* NULL: count only */
  size_t size;         /* bytes at base; ignored when counting */
  size_t used;         /* bytes taken so far, alignment included; > size: did not fit */
} vista_arena;

/* Zeroed room for `count` items of `item_bytes`, aligned to VISTA_ARENA_ALIGNMENT; NULL when counting or when it
 * does not fit (then used > size). */
void *vista_arena_take(vista_arena *arena, size_t count, size_t item_bytes);

#endif
