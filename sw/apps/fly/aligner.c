#include "aligner.h"

#include <stdlib.h>
#include <string.h>

bool aligner_make(aligner *a, const rig *r, const vista_parameters *parameters, problem *p) {
  *a = (aligner){.rig = r};
  const vista_right_rectification right = {.raw = r->right,
                                           .grid = r->tables[1].grid,
                                           .columns = vista_frontend_grid_points(r->camera.width_px),
                                           .rows = vista_frontend_grid_points(r->camera.height_px)};
  if (parameters->alignment.correct != VISTA_ALIGNMENT_CORRECT_ON) return true;
  size_t bytes = 0;
  vista_status status = vista_correction_bytes(parameters, &r->camera, &right, &bytes);
  if (status != VISTA_OK) return problem_say(p, "rig", "%s", vista_status_text(status));
  a->memory = malloc(bytes);
  if (a->memory == NULL) return problem_say(p, "rig", "out of memory");
  memset(a->memory, 0, bytes); /* the pages are there before the first frame */
  status = vista_correction_create(a->memory, bytes, parameters, &r->camera, &right, &a->correction);
  return status == VISTA_OK || problem_say(p, "rig", "%s", vista_status_text(status));
}

void aligner_free(aligner *a) {
  free(a->memory);
  *a = (aligner){0};
}

void aligner_reset(aligner *a) {
  if (a->correction != NULL) vista_correction_reset(a->correction);
  a->found = (vista_alignment_result){0};
}

rig_table aligner_table(const aligner *a) {
  const rig_table calibrated = a->rig->tables[1];
  if (a->correction == NULL) return calibrated;
  const rig_table turned = vista_correction_table(a->correction);
  return turned.whole != NULL || turned.grid != NULL ? turned : calibrated;
}

/* Whether the hardware that the rig was prepared for has a line buffer for the table. */
static bool fits(const aligner *a) {
  const rig_table table = vista_correction_table(a->correction);
  const vista_frontend_offset *const grid = (const vista_frontend_offset *)(const void *)table.grid;
  const vista_camera *const camera = &a->rig->camera;
  return grid == NULL || vista_frontend_row_beyond(grid, camera->width_px, camera->height_px, a->rig->rectify_rows) < 0;
}

vista_status aligner_take(aligner *a, const uint8_t *left, const uint8_t *right, int64_t t_ns) {
  if (a->correction == NULL) return VISTA_OK;
  const int32_t width = a->rig->camera.width_px, height = a->rig->camera.height_px;
  const vista_image images[2] = {{left, width, height, width}, {right, width, height, width}};
  const vista_status status = vista_correction_update(a->correction, &images[0], &images[1], t_ns, &a->found);
  if (status != VISTA_OK) return status;
  if (a->found.changed && !fits(a)) vista_correction_refuse(a->correction, &a->found);
  a->changes += a->found.changed;
  return VISTA_OK;
}
