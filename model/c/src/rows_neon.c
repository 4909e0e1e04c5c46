/* NEON of AArch64, which every such processor has: a group is four vectors. */
#include "rows.h"

#ifdef VISTA_ROWS_NEON
#define VISTA_TARGET
#define VISTA_INLINE static inline __attribute__((always_inline))
#include "row_steps.h"

#define VECTORS 4
#include "group_neon.h"
#include "match_sizes.h"

#define VISTA_ROW_CODE vista_rows_neon
#include "row_code.h"
#endif
