/* Disjoint sets over an array of parents, internal to libvista. The smallest member is the root of its set, so the
 * outcome does not depend on the order of the joins. */
#ifndef VISTA_SRC_DISJOINT_SETS_H
#define VISTA_SRC_DISJOINT_SETS_H

#include <stdint.h>

static inline int32_t vista_sets_find(int32_t *parent, int32_t item) {
  while (parent[item] != item) {
    parent[item] = parent[parent[item]];
    item = parent[item];
  }
  return item;
}

/* Joins the sets of a and b; returns the root that is none any more, or -1 if they were one set. */
static inline int32_t vista_sets_join(int32_t *parent, int32_t a, int32_t b) {
  const int32_t root_a = vista_sets_find(parent, a), root_b = vista_sets_find(parent, b);
  if (root_a == root_b) return -1;
  const int32_t low = root_a < root_b ? root_a : root_b, high = root_a < root_b ? root_b : root_a;
  parent[high] = low;
  return high;
}

#endif
