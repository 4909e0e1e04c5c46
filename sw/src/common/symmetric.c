#include "common/symmetric.h"

#include <math.h>

bool vista_symmetric_invert(int size, double *matrix) {
  double l[VISTA_SYMMETRIC_MOST][VISTA_SYMMETRIC_MOST], inverse[VISTA_SYMMETRIC_MOST][VISTA_SYMMETRIC_MOST];
  for (int i = 0; i < size; ++i)
    for (int j = 0; j <= i; ++j) {
      double sum = matrix[i * size + j];
      for (int k = 0; k < j; ++k) sum -= l[i][k] * l[j][k];
      if (i == j && !(sum > 0.0)) return false;
      l[i][j] = i == j ? sqrt(sum) : sum / l[j][j];
    }
  for (int i = 0; i < size; ++i) { /* of L */
    inverse[i][i] = 1.0 / l[i][i];
    for (int j = 0; j < i; ++j) {
      double sum = 0.0;
      for (int k = j; k < i; ++k) sum += l[i][k] * inverse[k][j];
      inverse[i][j] = -sum * inverse[i][i];
    }
  }
  for (int i = 0; i < size; ++i) /* L^-T L^-1 */
    for (int j = 0; j <= i; ++j) {
      double sum = 0.0;
      for (int k = i; k < size; ++k) sum += inverse[k][i] * inverse[k][j];
      matrix[i * size + j] = matrix[j * size + i] = sum;
    }
  return true;
}
