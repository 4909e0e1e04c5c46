/* Symmetric matrices of a few rows, internal to libvista. */
#ifndef VISTA_SRC_SYMMETRIC_H
#define VISTA_SRC_SYMMETRIC_H

#include <stdbool.h>

#define VISTA_SYMMETRIC_MOST 7 /* rows */

/* Inverts a row-major matrix in place (Cholesky), so that it stays exactly symmetric; false, and it stays as it was:
 * not positive definite in double precision. */
bool vista_symmetric_invert(int size, double *matrix);

#endif
