/* Plain C for every machine, and the costs of 32 bits everywhere. */
#define VISTA_TARGET
#include "row_steps.h"
#include "add_plain.h"

#define VISTA_COST uint16_t
#define VISTA_MATCH_PLAIN match_narrow
#include "match_plain.h"
#undef VISTA_COST
#undef VISTA_MATCH_PLAIN
#define VISTA_COST uint32_t
#define VISTA_MATCH_PLAIN match_wide
#include "match_plain.h"

static void match(const vista_match_job *job) {
  if (job->wide)
    match_wide(job);
  else
    match_narrow(job);
}

const vista_row_code vista_rows_portable = {
    .xsobel = xsobel_row,
    .mirror = mirror_row,
    .texture_columns = texture_columns_row,
    .texture_sums = texture_sums_row,
    .add_row = add_row,
    .match = match,
    .finish = finish_row,
};
