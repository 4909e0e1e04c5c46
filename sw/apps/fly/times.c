#include "times.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { RECTIFY, STEREO, ALIGNMENT, WATCH, FIRST_STAGE };

static const char *const before_the_stages[FIRST_STAGE] = {"rectify", "stereo", "alignment", "watch"};

enum { HOST, CPU, LATENCY, BEHIND_STAGES };

static const char *const behind_the_stages[BEHIND_STAGES] = {"host", "cpu", "latency"};

/* What is before the stages, the stages, the time of all stages together, that of the processor, and the latency. */
static int column_count(void) { return FIRST_STAGE + vista_stage_count() + BEHIND_STAGES; }

static const char *column_name(int column) {
  const int behind = column - FIRST_STAGE - vista_stage_count();
  if (column < FIRST_STAGE) return before_the_stages[column];
  return behind < 0 ? vista_stage_name(column - FIRST_STAGE) : behind_the_stages[behind];
}

bool times_make(times *t, int64_t most, problem *p) {
  *t = (times){.most = most, .rows = calloc((size_t)most, (size_t)column_count() * sizeof *t->rows)};
  return t->rows != NULL || problem_say(p, "--times", "out of memory");
}

void times_free(times *t) { free(t->rows); }

void times_add(times *t, const vista_detector_result *found, double cpu_ms, double latency_ms) {
  if (t->count == t->most) return;
  double *const row = t->rows + t->count++ * column_count();
  const int32_t stages = vista_stage_count();
  row[RECTIFY] = found->rectify_ms;
  row[STEREO] = found->match_ms;
  row[ALIGNMENT] = found->alignment_ms;
  row[WATCH] = found->watch_ms;
  memcpy(row + FIRST_STAGE, found->result.stage_ms, (size_t)stages * sizeof *row);
  double *const behind = row + FIRST_STAGE + stages;
  behind[HOST] = found->result.host_ms;
  behind[CPU] = cpu_ms;
  behind[LATENCY] = latency_ms;
}

bool times_write(const times *t, const char *path, problem *p) {
  const int columns = column_count();
  FILE *const stream = fopen(path, "w");
  if (stream == NULL) return problem_errno(p, path, errno);
  for (int column = 0; column < columns; ++column)
    fprintf(stream, "%s%s", column_name(column), column + 1 < columns ? "," : "\n");
  for (int64_t row = 0; row < t->count; ++row)
    for (int column = 0; column < columns; ++column)
      fprintf(stream, "%.6f%s", t->rows[row * columns + column], column + 1 < columns ? "," : "\n");
  const bool written = !ferror(stream);
  return (fclose(stream) == 0 && written) || problem_say(p, path, "cannot be written");
}
