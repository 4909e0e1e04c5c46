#include "vista/parameters.h"

#include <stdbool.h>
#include <stddef.h>
#include <string.h>

#include "common/parameters_check.h"
#include "common/parameters_table.h"

#define COUNT ((int32_t)(sizeof parameter_table / sizeof parameter_table[0]))
#define FEWEST_BYTES (sizeof(size_t) + sizeof(vista_stereo_params)) /* shorter structs never were */

int32_t vista_parameter_count(void) { return COUNT; }

const vista_parameter *vista_parameter_info(int32_t index) {
  return index >= 0 && index < COUNT ? &parameter_table[index].info : NULL;
}

static int32_t find(const char *name) {
  for (int32_t i = 0; i < COUNT; ++i)
    if (strcmp(parameter_table[i].info.name, name) == 0) return i;
  return -1;
}

static bool is_float(int32_t index) { return parameter_table[index].info.type == VISTA_PARAMETER_FLOAT; }

/* Choices are enums, of the size of an int. `at`: of the parameter. */
static double read(const unsigned char *at, int32_t index) {
  double number;
  int32_t whole;
  if (!is_float(index)) return memcpy(&whole, at, sizeof whole), whole;
  return memcpy(&number, at, sizeof number), number;
}

static size_t offset_of(int32_t index) { return parameter_table[index].offset; }

static void write(vista_parameters *parameters, int32_t index, double value) {
  unsigned char *const at = (unsigned char *)parameters + parameter_table[index].offset;
  const int32_t whole = is_float(index) ? 0 : (int32_t)value;
  if (is_float(index))
    memcpy(at, &value, sizeof value);
  else
    memcpy(at, &whole, sizeof whole);
}

/* A caller with an older header lacks the last sections. */
static bool has(const vista_parameters *parameters, int32_t index) {
  return parameter_table[index].offset + sizeof(double) <= parameters->struct_bytes;
}

vista_status vista_parameters_init(vista_parameters *parameters, size_t bytes) {
  if (parameters == NULL) return VISTA_ERROR_ARGUMENT;
  if (bytes < FEWEST_BYTES) return VISTA_ERROR_SIZE;
  memset(parameters, 0, bytes);
  parameters->struct_bytes = bytes;
  for (int32_t i = 0; i < COUNT; ++i)
    if (has(parameters, i)) write(parameters, i, parameter_table[i].info.default_value);
  return VISTA_OK;
}

/* The first parameter from `offset` to `end` that is out of range, or -1. start: where offset 0 would be. Limits that
 * are parameters have to be good themselves, so they come second. */
static int32_t find_culprit(const unsigned char *start, size_t offset, size_t end) {
  for (int pass = 0; pass < 2; ++pass)
    for (int32_t i = 0; i < COUNT; ++i) {
      const vista_parameter *const info = &parameter_table[i].info;
      if (offset_of(i) < offset || offset_of(i) + sizeof(double) > end) continue;
      const bool limited = pass == 1 && info->at_most[0] != '\0';
      if (pass == 1 && !limited) continue;
      const int32_t limit = limited ? find(info->at_most) : i;
      const double value = read(start + (offset_of(i) - offset), i);
      const double highest = limited ? read(start + (offset_of(limit) - offset), limit) : info->max;
      if (!(value >= info->min && value <= highest)) return i;
    }
  return -1;
}

vista_status vista_parameters_check(const vista_parameters *parameters, const char **culprit) {
  if (parameters == NULL) return VISTA_ERROR_ARGUMENT;
  if (culprit != NULL) *culprit = NULL;
  if (parameters->struct_bytes < FEWEST_BYTES) return VISTA_ERROR_SIZE;
  const int32_t found = find_culprit((const unsigned char *)parameters, 0, parameters->struct_bytes);
  if (culprit != NULL && found >= 0) *culprit = parameter_table[found].info.name;
  return found < 0 ? VISTA_OK : VISTA_ERROR_RANGE;
}

vista_status vista_parameters_check_section(size_t offset, const void *section) {
  const int32_t found = find_culprit(section, offset, offset + sizeof(vista_stereo_params));
  return found < 0 ? VISTA_OK : VISTA_ERROR_RANGE;
}

vista_status vista_parameters_set(vista_parameters *parameters, const char *name, double value) {
  if (parameters == NULL || name == NULL) return VISTA_ERROR_ARGUMENT;
  const int32_t index = find(name);
  if (index < 0 || !has(parameters, index) || !(value >= -1e9 && value <= 1e9)) return VISTA_ERROR_RANGE;
  write(parameters, index, value);
  return VISTA_OK;
}

vista_status vista_parameters_set_choice(vista_parameters *parameters, const char *name, const char *choice) {
  if (parameters == NULL || name == NULL || choice == NULL) return VISTA_ERROR_ARGUMENT;
  const int32_t index = find(name);
  if (index < 0 || !has(parameters, index)) return VISTA_ERROR_RANGE;
  for (int32_t k = 0; k < parameter_table[index].info.choice_count; ++k)
    if (strcmp(parameter_table[index].info.choices[k], choice) == 0) return write(parameters, index, k), VISTA_OK;
  return VISTA_ERROR_RANGE;
}

vista_status vista_parameters_get(const vista_parameters *parameters, const char *name, double *value) {
  if (parameters == NULL || name == NULL || value == NULL) return VISTA_ERROR_ARGUMENT;
  const int32_t index = find(name);
  if (index < 0 || !has(parameters, index)) return VISTA_ERROR_RANGE;
  *value = read((const unsigned char *)parameters + offset_of(index), index);
  return VISTA_OK;
}

vista_parameters vista_parameters_own(const vista_parameters *parameters) {
  vista_parameters own = vista_parameters_default();
  const size_t common = parameters->struct_bytes < sizeof own ? parameters->struct_bytes : sizeof own;
  memcpy(&own, parameters, common);
  own.struct_bytes = sizeof own;
  return own;
}
