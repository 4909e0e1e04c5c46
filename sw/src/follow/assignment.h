/* Optimal rectangular assignment with forbidden pairs: as many pairs as possible, and of these assignments the one
 * with the smallest sum of costs. Shortest augmenting paths with potentials (Hungarian method, Jonker and Volgenant
 * 1987); O(min^2 * max) steps. */
#ifndef VISTA_ASSIGNMENT_H
#define VISTA_ASSIGNMENT_H

#include <stdint.h>

#include "common/arena.h"
#include "vista/status.h"

#define VISTA_ASSIGNMENT_MAX 8192 /* rows, columns */

typedef struct vista_assignment vista_assignment; /* working memory, nothing kept from call to call */

/* *assignment is NULL while the arena counts. VISTA_ERROR_RANGE: a size outside 1..VISTA_ASSIGNMENT_MAX. */
vista_status vista_assignment_layout(int32_t max_rows, int32_t max_columns, vista_arena *arena,
                                     vista_assignment **assignment);

/* cost: rows x columns, row-major, +INFINITY = forbidden. column_of_row: rows entries, -1 = unassigned.
 * VISTA_ERROR_CAPACITY: larger than laid out; VISTA_ERROR_NUMBER: a NaN or -INFINITY. */
vista_status vista_assignment_solve(vista_assignment *assignment, const double *cost, int32_t rows, int32_t columns,
                                    int32_t *column_of_row);

#endif
