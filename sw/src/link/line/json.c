#include "link/line/json.h"

#include <ctype.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define PLAIN_BELOW 1e9 /* with 6 digits behind the point 15 in all: a double keeps them */
#define EXACT_DIGITS 17
#define EXPONENT_FROM 16 /* Python writes 1e+16, and 0.0001 but 1e-05 */
#define EXPONENT_BELOW (-4)

static void put_bytes(vista_json *json, const char *bytes, size_t count) {
  json->full = json->full || json->capacity - json->length <= count;
  if (json->full) return;
  memcpy(json->text + json->length, bytes, count);
  json->length += count;
  json->text[json->length] = '\0';
}

void vista_json_put(vista_json *json, const char *text) { put_bytes(json, text, strlen(text)); }

void vista_json_put_integer(vista_json *json, int64_t value) {
  char text[24];
  (void)snprintf(text, sizeof text, "%" PRId64, value);
  vista_json_put(json, text);
}

void vista_json_put_bool(vista_json *json, bool value) { vista_json_put(json, value ? "true" : "false"); }

void vista_json_put_name(vista_json *json, const char *name) {
  vista_json_put(json, "\"");
  vista_json_put(json, name);
  vista_json_put(json, "\"");
}

/* Keeps the digits of what printf wrote, whatever sign a locale has for the point. Returns their number. */
static int keep_digits(const char *from, char *to) {
  int count = 0;
  for (; *from != '\0' && *from != 'e'; ++from)
    if (isdigit((unsigned char)*from)) to[count++] = *from;
  to[count] = '\0';
  return count;
}

/* 0.d1d2d3... times 10 to the `point`, in Python's layout. */
static void put_decimal(vista_json *json, bool negative, const char *digits, int count, int point) {
  while (count > 1 && digits[0] == '0') ++digits, --count, --point;
  while (count > 1 && digits[count - 1] == '0') --count;
  if (count == 1 && digits[0] == '0') {
    vista_json_put(json, "0.0"); /* also of -0.0 */
    return;
  }
  if (negative) vista_json_put(json, "-");
  if (point - 1 < EXPONENT_BELOW || point - 1 >= EXPONENT_FROM) {
    char exponent[16];
    put_bytes(json, digits, 1);
    if (count > 1) vista_json_put(json, "."), put_bytes(json, digits + 1, (size_t)count - 1);
    (void)snprintf(exponent, sizeof exponent, "e%c%02d", point > 0 ? '+' : '-', abs(point - 1));
    vista_json_put(json, exponent);
    return;
  }
  if (point <= 0) vista_json_put(json, "0.");
  for (int k = point; k < 0; ++k) vista_json_put(json, "0");
  for (int k = 0; k < count || k < point; ++k) {
    if (k == point && k > 0) vista_json_put(json, ".");
    put_bytes(json, k < count ? digits + k : "0", 1);
  }
  if (count <= point) vista_json_put(json, ".0");
}

/* The fewest digits that give the same double again. */
static void put_shortest(vista_json *json, double value) {
  char text[40], digits[40];
  for (int precision = 0; precision < EXACT_DIGITS; ++precision) {
    (void)snprintf(text, sizeof text, "%.*e", precision, value);
    if (strtod(text, NULL) == value) break;
  }
  const int count = keep_digits(text, digits);
  put_decimal(json, value < 0.0, digits, count, 1 + (int)strtol(strchr(text, 'e') + 1, NULL, 10));
}

void vista_json_put_number(vista_json *json, double value, int digits) {
  char text[40], kept[40];
  if (!isfinite(value)) {
    vista_json_put(json, "null");
    return;
  }
  if (fabs(value) >= PLAIN_BELOW) {
    if (fabs(value) < 1e16) { /* beyond, a double is a whole number anyway */
      (void)snprintf(text, sizeof text, "%.*f", digits, value);
      value = strtod(text, NULL);
    }
    put_shortest(json, value);
    return;
  }
  (void)snprintf(text, sizeof text, "%.*f", digits, value);
  const int count = keep_digits(text, kept);
  put_decimal(json, value < 0.0, kept, count, count - digits);
}

void vista_json_put_numbers(vista_json *json, const double *values, int32_t count, int digits) {
  vista_json_put(json, "[");
  for (int32_t k = 0; k < count; ++k) {
    if (k > 0) vista_json_put(json, ", ");
    vista_json_put_number(json, values[k], digits);
  }
  vista_json_put(json, "]");
}
