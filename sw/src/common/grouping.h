/* Items listed group by group, internal to libvista. */
#ifndef VISTA_SRC_GROUPING_H
#define VISTA_SRC_GROUPING_H

#include <stddef.h>
#include <stdint.h>

/* Lists the items of each group in the order given: those of group k are members[first[k] .. first[k + 1]). group: of
 * each item, negative: none. order: `count` items; null: 0 .. count - 1. first: group_count + 1. */
static inline void vista_group(const int32_t *group, const int32_t *order, int32_t count, int32_t group_count,
                               int32_t *first, int32_t *members) {
  for (int32_t k = 0; k <= group_count; ++k) first[k] = 0;
  for (int32_t i = 0; i < count; ++i) {
    const int32_t k = group[order == NULL ? i : order[i]];
    if (k >= 0) first[k + 1]++;
  }
  for (int32_t k = 0; k < group_count; ++k) first[k + 1] += first[k];
  for (int32_t i = 0; i < count; ++i) {
    const int32_t item = order == NULL ? i : order[i], k = group[item];
    if (k >= 0) members[first[k]++] = item;
  }
  for (int32_t k = group_count; k > 0; --k) first[k] = first[k - 1];
  first[0] = 0;
}

#endif
