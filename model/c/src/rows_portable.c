/* Plain C for every machine. */
#define VISTA_TARGET
#include "row_steps.h"

#define VISTA_COST uint16_t
#define VISTA_MATCH_PLAIN match_narrow
#include "match_plain.h"
#undef VISTA_COST
#undef VISTA_MATCH_PLAIN

#define VISTA_ROW_CODE vista_rows_portable
#include "row_code.h"
