/* The table of an instruction set, VISTA_ROW_CODE, from match_narrow and the plain loops around it; costs of 32 bits
 * are rare and plain everywhere. */
#include "front_steps.h"

#define VISTA_COST uint32_t
#define VISTA_MATCH_PLAIN match_wide
#include "match_plain.h"
#undef VISTA_COST
#undef VISTA_MATCH_PLAIN

VISTA_TARGET static void match_row(const vista_match_job *job) {
  if (job->wide)
    match_wide(job);
  else
    match_narrow(job);
}

const vista_row_code VISTA_ROW_CODE = {
    .smooth = smooth_row,
    .reduce = reduce_row,
    .xsobel = xsobel_row,
    .mirror = mirror_row,
    .texture_columns = texture_columns_row,
    .texture_sums = texture_sums_row,
    .add_row = add_row,
    .match = match_row,
    .finish = finish_row,
};
