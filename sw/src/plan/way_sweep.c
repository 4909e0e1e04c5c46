#include "plan/way_sweep.h"

#include <assert.h>
#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#include "common/numbers.h"
#include "common/wide_vectors.h"

#define GRID VISTA_PLAN_GRID
#define BAND 32 /* rows that are gone through together */
#define STEPS (GRID + BAND - 1)
#define ROUNDS 4 /* of four sweeps each, at most */
#define SHORTER_MIN 0.02f /* of a cell: what is less does not matter */

static_assert(GRID % BAND == 0, "bands fill the grid");

/* Cell i of row k of a band, both counted as the sweep goes, has the place [i + k + 1][k + 1]; row 0 is the one before
 * the band, the last one that after it. */
typedef struct row_band {
  float way[STEPS + 2][BAND + 2];
  float length[STEPS][BAND];
  float gained[BAND]; /* of a row: by how much its cells became shorter, at most */
} row_band;

/* What is beside the grid: no way leads through it. */
static void clear(row_band *band) {
  for (int32_t t = 0; t < STEPS + 2; ++t)
    for (int32_t k = 0; k < BAND + 2; ++k) band->way[t][k] = VISTA_PLAN_WAY_FAR;
  for (int32_t t = 0; t < STEPS; ++t)
    for (int32_t k = 0; k < BAND; ++k) band->length[t][k] = INFINITY;
}

/* The way from a cell if that from its neighbours is known: |grad way| = length. */
static inline float solved(float a, float b, float length) {
  const float apart = fabsf(a - b), straight = vista_smaller(a, b) + length;
  const float across = 0.5f * (a + b + sqrtf(2.0f * length * length - apart * apart));
  return apart >= length ? straight : across;
}

/* Goes through the cells of a band, one of each row in a step, and makes their ways shorter where it can. */
VISTA_WIDE_VECTORS static void relax(row_band *band) {
  float gained[BAND] = {0};
  for (int32_t t = 0; t < STEPS; ++t) {
    const float *const before = band->way[t], *const after = band->way[t + 2], *const length = band->length[t];
    float *const restrict way = band->way[t + 1] + 1;
    for (int k = 0; k < BAND; ++k) {
      const float beside = vista_smaller(before[k + 1], after[k + 1]), across = vista_smaller(before[k], after[k + 2]);
      const float new_way = solved(beside, across, length[k]);
      gained[k] = vista_larger(gained[k], way[k] - new_way);
      way[k] = vista_smaller(new_way, way[k]);
    }
  }
  memcpy(band->gained, gained, sizeof gained);
}

/* Whether a row of the band may become shorter. After it or a row beside it became shorter for the last time, each row is
 * gone through in both directions; then nothing more can. */
static bool may_change(const int32_t changed[GRID + 2], int32_t first, int32_t number) {
  bool may = number <= 2;
  for (int32_t y = first - 1; y <= first + BAND; ++y) may |= changed[y + 1] >= number - 2;
  return may;
}

/* Goes through the cells from one of the four corners (bit 0: from the right, bit 1: from above): the `number`-th time,
 * from 1. changed: the last time that a row became shorter, with a row of the rim on both sides. False: nothing became
 * shorter by enough to matter. */
static bool sweep(vista_planner *planner, row_band *band, int32_t corner, int32_t number, int32_t changed[GRID + 2]) {
  const bool back = corner & 1, down = corner & 2;
  bool shorter = false;
  for (int32_t done = 0; done < GRID; done += BAND) {
    const int32_t first = down ? GRID - BAND - done : done; /* the lowest row of the band */
    if (!may_change(changed, first, number)) continue;
    for (int32_t k = -1; k <= BAND; ++k) {
      const int32_t y = down ? first + BAND - 1 - k : first + k;
      const float *const way = planner->way[y + 1] + 1;
      for (int32_t i = 0; i < GRID; ++i) band->way[i + k + 1][k + 1] = way[back ? GRID - 1 - i : i];
      if (k < 0 || k == BAND) continue;
      const float *const length = planner->length[y];
      for (int32_t i = 0; i < GRID; ++i) band->length[i + k][k] = length[back ? GRID - 1 - i : i];
    }
    relax(band);
    for (int32_t k = 0; k < BAND; ++k) {
      if (!(band->gained[k] > 0.0f)) continue;
      const int32_t y = down ? first + BAND - 1 - k : first + k;
      float *const way = planner->way[y + 1] + 1;
      for (int32_t i = 0; i < GRID; ++i) way[back ? GRID - 1 - i : i] = band->way[i + k + 1][k + 1];
      changed[y + 1] = number;
      shorter |= band->gained[k] > SHORTER_MIN;
    }
  }
  return shorter;
}

void vista_plan_sweep(vista_planner *planner) {
  row_band band;
  int32_t changed[GRID + 2] = {0};
  bool shorter = true;
  clear(&band);
  for (int32_t k = 0; shorter && k < ROUNDS; ++k) {
    shorter = false;
    for (int32_t corner = 0; corner < 4; ++corner)
      shorter |= sweep(planner, &band, corner, 4 * k + corner + 1, changed);
  }
}
