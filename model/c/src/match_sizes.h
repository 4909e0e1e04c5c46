/* match_narrow: an instance for each number of groups of 32, so that all sums stay in registers. D 16 would leave half
 * of a group idle and has an instance of its own. */
#ifndef VISTA_ENGINE_MATCH_SIZES_H
#define VISTA_ENGINE_MATCH_SIZES_H

#include "match_group.h"

#define MATCH_SIZE(groups) \
  VISTA_TARGET static void match_##groups(const vista_match_job *job) { match_modes(job, groups); }
MATCH_SIZE(1)
MATCH_SIZE(2)
MATCH_SIZE(3)
MATCH_SIZE(4)
MATCH_SIZE(5)
MATCH_SIZE(6)
MATCH_SIZE(7)
MATCH_SIZE(8)
#undef MATCH_SIZE

VISTA_TARGET static void match_narrow(const vista_match_job *job) {
  static void (*const sizes[MAX_GROUPS + 1])(const vista_match_job *) = {
      vista_match_16, match_1, match_2, match_3, match_4, match_5, match_6, match_7, match_8};
  sizes[job->lanes / LANES](job);
}

#endif
