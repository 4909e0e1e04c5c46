/* Windows of the last 32 events as bits, internal to libvista. */
#ifndef VISTA_SRC_BITS_H
#define VISTA_SRC_BITS_H

#include <stdint.h>

#define VISTA_WINDOW_BITS 32

/* Ones among the newest `length` bits, 0 .. VISTA_WINDOW_BITS. */
static inline int32_t vista_window_count(uint32_t window, int32_t length) {
  int32_t count = 0;
  const uint32_t mask = length <= 0 ? 0 : UINT32_MAX >> (VISTA_WINDOW_BITS - length);
  for (uint32_t bits = window & mask; bits != 0; bits &= bits - 1) ++count;
  return count;
}

#endif
