/* Steps 2, 3, 5 and 6 in plain C, and the rivals of step 8, for the costs' integer type VISTA_COST; defines
 * VISTA_MATCH_PLAIN. May be included more than once. */

VISTA_TARGET static void VISTA_MATCH_PLAIN(const vista_match_job *job) {
  enum { MAX_D = VISTA_ENGINE_MAX_DISPARITIES };
  const VISTA_COST none = (VISTA_COST)-1; /* above every cost */
  const int32_t D = job->num_disparities, W = job->width, block = job->block_size, radius = block / 2;
  VISTA_COST sums[MAX_D] = {0};
  VISTA_COST *right_cost = (VISTA_COST *)(void *)job->work; /* both by mirrored right x */
  uint8_t *right_best = (uint8_t *)(job->work + W + VISTA_ROWS_PAD);

  if (job->check)
    for (int32_t i = 0; i < W + D; ++i) right_cost[i] = none;
  for (int32_t x = D - 1; x < W; ++x) { /* x: the column entering the block */
    const uint8_t *restrict right_in = job->right_in + (W - 1 - x), *restrict right_out = job->right_out + (W - 1 - x);
    const int32_t left_in = job->left_in[x], left_out = job->left_out[x];
    uint16_t *restrict column = job->columns + (size_t)x * (size_t)job->lanes;
    for (int32_t d = 0; d < D; ++d) {
      const int32_t enters = left_in - right_in[d], leaves = left_out - right_out[d];
      const int32_t change = (enters < 0 ? -enters : enters) - (leaves < 0 ? -leaves : leaves);
      column[d] = (uint16_t)(column[d] + change);
      sums[d] = (VISTA_COST)(sums[d] + column[d]);
    }
    const int32_t center = x - radius;
    if (x < D - 1 + block - 1) continue;

    VISTA_COST least = sums[0];
    for (int32_t d = 1; d < D; ++d) least = sums[d] < least ? sums[d] : least;
    int32_t best = D - 1;
    while (sums[best] != least) --best;
    const uint32_t limit = uniqueness_limit(least, (uint32_t)job->uniqueness_ratio);
    uint32_t close = 0, near = 1; /* within the limit: any d; dL and its neighbours */
    for (int32_t d = 0; d < D; ++d) close += sums[d] <= limit;
    if (best > 0) near += sums[best - 1] <= limit;
    if (best < D - 1) near += sums[best + 1] <= limit;
    job->winner.cost[center] = least;
    job->winner.unique[center] = close == near || job->uniqueness_ratio == 0;
    job->winner.best[center] = (uint8_t)best;
    job->winner.around[2 * center] = sums[best > 0 ? best - 1 : 0];
    job->winner.around[2 * center + 1] = sums[best < D - 1 ? best + 1 : best];
    if (job->winner.rival) {
      VISTA_COST rival_cost = none;
      for (int32_t d = 0; d < D; ++d) {
        if (d >= best - 1 && d <= best + 1) continue;
        if (sums[d] <= rival_cost) {
          rival_cost = sums[d];
          job->winner.rival[center] = (uint8_t)d;
        }
      }
      job->winner.rival_cost[center] = rival_cost;
    }

    if (job->check) { /* candidate d of right pixel center - d: its candidates come by rising d */
      VISTA_COST *restrict cost = right_cost + (W - 1 - center);
      uint8_t *restrict arg = right_best + (W - 1 - center);
      for (int32_t d = 0; d < D; ++d) {
        const int32_t better = sums[d] <= cost[d];
        cost[d] = better ? sums[d] : cost[d];
        arg[d] = better ? (uint8_t)d : arg[d];
      }
    }
    const uint16_t *restrict leaving = column - (ptrdiff_t)(block - 1) * job->lanes;
    for (int32_t d = 0; d < D; ++d) sums[d] = (VISTA_COST)(sums[d] - leaving[d]);
  }
  if (job->check)
    for (int32_t x = 0; x < W; ++x) job->winner.right_best[x] = right_best[W - 1 - x];
}
