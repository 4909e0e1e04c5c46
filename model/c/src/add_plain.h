/* Step 2 for rows that only enter; the including file defines VISTA_TARGET. */
#ifndef VISTA_ENGINE_ADD_PLAIN_H
#define VISTA_ENGINE_ADD_PLAIN_H

VISTA_TARGET static void add_row(const vista_match_job *job) {
  const int32_t D = job->num_disparities, W = job->width;
  for (int32_t x = D - 1; x < W; ++x) {
    const uint8_t *restrict right = job->right_in + (W - 1 - x);
    const int32_t left = job->left_in[x];
    uint16_t *restrict column = job->columns + (size_t)x * (size_t)job->lanes;
    for (int32_t d = 0; d < D; ++d)
      column[d] = (uint16_t)(column[d] + (left > right[d] ? left - right[d] : right[d] - left));
  }
}

#endif
