/* Text of JSON into memory of one size, with numbers as Python's json module writes them. */
#ifndef VISTA_SRC_LINE_JSON_H
#define VISTA_SRC_LINE_JSON_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* What has no room is left out, and `full` says so. */
typedef struct vista_json {
  char *text;
  size_t capacity, length;
  bool full;
} vista_json;

void vista_json_put(vista_json *json, const char *text);
void vista_json_put_integer(vista_json *json, int64_t value);
void vista_json_put_bool(vista_json *json, bool value);

/* Writes a name in quotes; it is of plain ASCII without any. */
void vista_json_put_name(vista_json *json, const char *name);

/* Writes a number as round(value, digits) of Python does, 1 .. 6 digits behind the point; null for what is not
 * finite. */
void vista_json_put_number(vista_json *json, double value, int digits);

/* A list of numbers. */
void vista_json_put_numbers(vista_json *json, const double *values, int32_t count, int digits);

#endif
