#include "vista/correction.h"

#include "common/arena.h"

#define CALIBRATED (-1)

/* One of two, so that the right image can be rectified by one while the other is made. */
typedef struct own_table {
  int16_t *whole, *grid;
  uint16_t *fraction;
} own_table;

struct vista_correction {
  vista_alignment *alignment;
  vista_camera camera;
  vista_right_rectification right;
  own_table tables[2];
  vista_turn applied, before; /* what the table is for, and what the one before it was for */
  int table, table_before;    /* 0, 1 or CALIBRATED */
  vista_turn made_for;        /* the turn of the table that is being made, if one is */
  int32_t made_rows;
  bool makes;
};

static vista_status lay_out(vista_correction *c, size_t alignment_bytes, vista_arena *arena, void **alignment) {
  const size_t pixels = (size_t)c->camera.width_px * (size_t)c->camera.height_px;
  *alignment = vista_arena_take(arena, 1, alignment_bytes);
  for (int k = 0; k < 2; ++k) {
    own_table *const table = &c->tables[k];
    *table = (own_table){0};
    if (c->right.grid != NULL) {
      table->grid = vista_arena_take(arena, 2 * (size_t)c->right.columns * (size_t)c->right.rows, sizeof *table->grid);
    } else {
      table->whole = vista_arena_take(arena, 2 * pixels, sizeof *table->whole);
      table->fraction = vista_arena_take(arena, pixels, sizeof *table->fraction);
    }
  }
  return arena->base == NULL || arena->used <= arena->size ? VISTA_OK : VISTA_ERROR_MEMORY;
}

/* Whether a table can be made at all: of no row of a map, or with a grid. */
static vista_status check(const vista_camera *camera, const vista_right_rectification *right) {
  int16_t whole = 0;
  uint16_t fraction = 0;
  if (right->grid != NULL && (right->columns < 2 || right->rows < 2)) return VISTA_ERROR_SIZE;
  return vista_turn_map(&(vista_turn){0}, camera, &right->raw, 0, 0, &whole, &fraction);
}

vista_status vista_correction_bytes(const vista_parameters *parameters, const vista_camera *camera,
                                    const vista_right_rectification *right, size_t *bytes) {
  if (parameters == NULL || camera == NULL || right == NULL || bytes == NULL) return VISTA_ERROR_ARGUMENT;
  size_t alignment_bytes = 0;
  vista_status status = vista_alignment_bytes(parameters, camera, &alignment_bytes);
  if (status == VISTA_OK) status = check(camera, right);
  if (status != VISTA_OK) return status;
  vista_arena arena = {0};
  vista_correction counted = {.camera = *camera, .right = *right};
  void *alignment;
  (void)vista_arena_take(&arena, 1, sizeof counted);
  (void)lay_out(&counted, alignment_bytes, &arena, &alignment);
  *bytes = arena.used + VISTA_ARENA_ALIGNMENT; /* the caller's memory need not be aligned */
  return VISTA_OK;
}

vista_status vista_correction_create(void *memory, size_t bytes, const vista_parameters *parameters,
                                     const vista_camera *camera, const vista_right_rectification *right,
                                     vista_correction **correction) {
  if (memory == NULL || parameters == NULL || camera == NULL || right == NULL || correction == NULL)
    return VISTA_ERROR_ARGUMENT;
  size_t alignment_bytes = 0;
  void *alignment;
  vista_status status = vista_alignment_bytes(parameters, camera, &alignment_bytes);
  if (status == VISTA_OK) status = check(camera, right);
  if (status != VISTA_OK) return status;
  vista_arena arena = {.base = memory, .size = bytes};
  vista_correction *const c = vista_arena_take(&arena, 1, sizeof *c);
  if (c == NULL) return VISTA_ERROR_MEMORY;
  c->camera = *camera;
  c->right = *right;
  status = lay_out(c, alignment_bytes, &arena, &alignment);
  if (status == VISTA_OK)
    status = vista_alignment_create(alignment, alignment_bytes, parameters, camera, &c->alignment);
  if (status != VISTA_OK) return status;
  vista_correction_reset(c);
  *correction = c;
  return VISTA_OK;
}

void vista_correction_reset(vista_correction *c) {
  vista_alignment_reset(c->alignment);
  c->applied = c->before = (vista_turn){0};
  c->table = c->table_before = CALIBRATED;
  c->makes = false;
}

/* The next part of the table that is made. */
static vista_status make_part(vista_correction *c) {
  const own_table *const table = &c->tables[c->table == 0];
  const int32_t height_px = c->camera.height_px;
  if (c->right.grid != NULL) {
    c->made_rows = height_px;
    return vista_turn_grid(&c->made_for, &c->camera, c->right.grid, c->right.columns, c->right.rows, table->grid);
  }
  const int32_t first = c->made_rows, part = (height_px + VISTA_CORRECTION_PARTS - 1) / VISTA_CORRECTION_PARTS;
  c->made_rows = first + part < height_px ? first + part : height_px;
  return vista_turn_map(&c->made_for, &c->camera, &c->right.raw, first, c->made_rows, table->whole, table->fraction);
}

static void take_over(vista_correction *c, vista_alignment_result *result) {
  c->makes = false;
  c->before = c->applied;
  c->table_before = c->table;
  c->applied = c->made_for;
  c->table = c->table == 0;
  result->correction = c->applied;
  result->changed = true;
}

vista_status vista_correction_update(vista_correction *c, const vista_image *left, const vista_image *right,
                                     int64_t t_ns, vista_alignment_result *result) {
  if (c == NULL) return VISTA_ERROR_ARGUMENT;
  const vista_status status = vista_alignment_update(c->alignment, left, right, t_ns, &c->applied, result);
  if (status != VISTA_OK) return status;
  if (!c->makes && result->changed) {
    c->makes = true;
    c->made_for = result->correction;
    c->made_rows = 0;
  }
  result->correction = c->applied;
  result->changed = false;
  if (!c->makes) return VISTA_OK;
  if (make_part(c) != VISTA_OK) {
    c->makes = false;
    result->state = VISTA_ALIGNMENT_BEYOND;
  } else if (c->made_rows == c->camera.height_px) {
    take_over(c, result);
  }
  return VISTA_OK;
}

void vista_correction_refuse(vista_correction *c, vista_alignment_result *result) {
  c->applied = c->before;
  c->table = c->table_before;
  result->correction = c->applied;
  result->changed = false;
  result->state = VISTA_ALIGNMENT_BEYOND;
}

vista_right_table vista_correction_table(const vista_correction *c) {
  if (c->table == CALIBRATED) return (vista_right_table){0};
  const own_table *const table = &c->tables[c->table];
  return (vista_right_table){table->whole, table->fraction, table->grid};
}
