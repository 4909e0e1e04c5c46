/* Borders of the front end: mirrored without repeating the edge, as often as a tiny image needs it. */
#ifndef VISTA_ENGINE_MIRROR_H
#define VISTA_ENGINE_MIRROR_H

#include <stdint.h>

/* The place inside 0 .. size-1 that stands for place i: -1 is 1, size is size-2; a single place stands for all. */
static inline int32_t vista_mirror(int32_t i, int32_t size) {
  if (size == 1) return 0;
  while (i < 0 || i >= size) i = i < 0 ? -i : 2 * (size - 1) - i;
  return i;
}

#endif
