#include "config.h"

#include <ctype.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define NAME_BYTES 48
#define LINE_BYTES 512
#define MOST_PARAMETERS 1024

typedef struct reader {
  const char *file;
  int line;
  char section[NAME_BYTES]; /* empty: before the first */
  vista_parameters *parameters;
  unsigned char given[MOST_PARAMETERS]; /* 1: set, 2: its section was opened */
  problem *problem;
} reader;

static bool refuse(const reader *r, const char *reason) {
  return problem_say(r->problem, r->file, "not readable as TOML: line %d: %s", r->line, reason);
}

static bool is_name(char c) { return isalnum((unsigned char)c) || c == '_' || c == '-'; }

static char *skip_blanks(char *at) { return at + strspn(at, " \t"); }

static bool ends(char *at) {
  at = skip_blanks(at);
  return *at == '\0' || *at == '#';
}

/* Takes a bare key. Null: there is none, or it is longer than any here. */
static char *take_name(char *at, char name[NAME_BYTES]) {
  size_t length = 0;
  while (is_name(at[length])) ++length;
  if (length == 0 || length >= NAME_BYTES) return NULL;
  memcpy(name, at, length);
  name[length] = '\0';
  return at + length;
}

/* Opens a section: whether there is one of the name, and it is new. */
static bool open_section(reader *r, char *at) {
  char name[NAME_BYTES];
  at = take_name(skip_blanks(at), name);
  if (at == NULL) return refuse(r, "a section is not understood");
  at = skip_blanks(at);
  if (*at != ']' || !ends(at + 1)) return refuse(r, "a section is not understood");
  (void)snprintf(r->section, sizeof r->section, "%s", name);
  const size_t length = strlen(name);
  bool known = false;
  for (int32_t k = 0; k < vista_parameter_count() && k < MOST_PARAMETERS; ++k) {
    const char *const full = vista_parameter_info(k)->name;
    if (strncmp(full, name, length) != 0 || full[length] != '.') continue;
    if (r->given[k] & 2) return refuse(r, "a section comes twice");
    r->given[k] |= 2;
    known = true;
  }
  return known || problem_say(r->problem, r->file, "unknown section [%s]", name);
}

static int32_t find(const char *name) {
  for (int32_t k = 0; k < vista_parameter_count() && k < MOST_PARAMETERS; ++k)
    if (strcmp(vista_parameter_info(k)->name, name) == 0) return k;
  return -1;
}

/* A string in double or single quotes; closes it. */
static char *take_string(char *at, char **behind) {
  char *const end = strchr(at + 1, at[0]);
  if (end == NULL) return NULL;
  *end = '\0';
  *behind = end + 1;
  if (at[0] == '"' && strchr(at + 1, '\\') != NULL) return NULL;
  return at + 1;
}

/* The length of an integer or a decimal number of TOML, or 0. *whole: whether it is an integer. */
static size_t number_length(const char *at, bool *whole) {
  size_t k = at[0] == '+' || at[0] == '-' ? 1 : 0;
  const size_t first = k;
  while (isdigit((unsigned char)at[k])) ++k;
  if (k == first || (at[first] == '0' && k > first + 1)) return 0;
  *whole = true;
  if (at[k] == '.') {
    const size_t point = k++;
    while (isdigit((unsigned char)at[k])) ++k;
    if (k == point + 1) return 0;
    *whole = false;
  }
  if (at[k] == 'e' || at[k] == 'E') {
    k += at[k + 1] == '+' || at[k + 1] == '-' ? 2 : 1;
    const size_t exponent = k;
    while (isdigit((unsigned char)at[k])) ++k;
    if (k == exponent) return 0;
    *whole = false;
  }
  return k;
}

static bool set_choice(const reader *r, const vista_parameter *info, const char *choice) {
  if (vista_parameters_set_choice(r->parameters, info->name, choice) == VISTA_OK) return true;
  char names[LINE_BYTES / 2] = "";
  for (int32_t k = 0; k < info->choice_count; ++k) {
    const size_t used = strlen(names);
    (void)snprintf(names + used, sizeof names - used, "%s%s", k > 0 ? ", " : "", info->choices[k]);
  }
  return problem_say(r->problem, r->file, "%s must be one of %s, not '%s'", info->name, names, choice);
}

static bool set_number(const reader *r, const vista_parameter *info, const char *text, bool whole) {
  const double value = strtod(text, NULL);
  if (info->type == VISTA_PARAMETER_CHOICE) return set_choice(r, info, text);
  if (info->type == VISTA_PARAMETER_INT && !whole)
    return problem_say(r->problem, r->file, "%s must be an integer, not %s", info->name, text);
  if (value >= info->min && value <= info->max && vista_parameters_set(r->parameters, info->name, value) == VISTA_OK)
    return true;
  return problem_say(r->problem, r->file, "%s must be from %g to %g%s%s, not %s", info->name, info->min, info->max,
                     info->unit[0] != '\0' ? " " : "", info->unit, text);
}

static bool set_value(reader *r, char *at) {
  char name[NAME_BYTES], full[2 * NAME_BYTES];
  at = take_name(at, name);
  if (at == NULL) return refuse(r, "neither a section nor a parameter");
  at = skip_blanks(at);
  if (*at != '=') return refuse(r, "no = behind a name");
  at = skip_blanks(at + 1);
  if (r->section[0] == '\0') return problem_say(r->problem, r->file, "unknown section [%s]", name);
  (void)snprintf(full, sizeof full, "%s.%s", r->section, name);
  const int32_t index = find(full);
  if (index < 0) return problem_say(r->problem, r->file, "unknown parameter %s", full);
  if (r->given[index] & 1) return refuse(r, "a parameter comes twice");
  r->given[index] |= 1;
  const vista_parameter *const info = vista_parameter_info(index);
  if (*at == '"' || *at == '\'') {
    char *behind = at;
    const char *const text = take_string(at, &behind);
    if (text == NULL || !ends(behind)) return refuse(r, "a string is not understood");
    if (info->type == VISTA_PARAMETER_CHOICE) return set_choice(r, info, text);
    return problem_say(r->problem, r->file, "%s must be %s, not '%s'", full,
                       info->type == VISTA_PARAMETER_INT ? "an integer" : "a number", text);
  }
  bool whole = false;
  const size_t length = number_length(at, &whole);
  if (length == 0 || !ends(at + length)) return refuse(r, "a value is not understood");
  at[length] = '\0';
  return set_number(r, info, at, whole);
}

static bool take_line(reader *r, char *line) {
  for (const char *c = line; *c != '\0'; ++c)
    if (iscntrl((unsigned char)*c) && *c != '\t') return refuse(r, "a control character");
  char *const at = skip_blanks(line);
  if (ends(at)) return true;
  return *at == '[' ? open_section(r, at + 1) : set_value(r, at);
}

static bool check(const reader *r) {
  const char *culprit = NULL;
  if (vista_parameters_check(r->parameters, &culprit) == VISTA_OK) return true;
  const int32_t index = culprit != NULL ? find(culprit) : -1;
  const char *const limit = index >= 0 ? vista_parameter_info(index)->at_most : "";
  if (limit[0] == '\0') return problem_say(r->problem, r->file, "%s is out of range", culprit != NULL ? culprit : "?");
  double value = 0.0, highest = 0.0;
  (void)vista_parameters_get(r->parameters, culprit, &value);
  (void)vista_parameters_get(r->parameters, limit, &highest);
  return problem_say(r->problem, r->file, "%s must be at most %s (%g), not %g", culprit, limit, highest, value);
}

bool config_parse(const char *name, const char *text, size_t bytes, vista_parameters *parameters, problem *p) {
  reader r = {.file = name, .parameters = parameters, .problem = p};
  char line[LINE_BYTES];
  for (size_t at = 0; at < bytes;) {
    const char *const end = memchr(text + at, '\n', bytes - at);
    size_t length = end != NULL ? (size_t)(end - (text + at)) : bytes - at;
    ++r.line;
    const size_t next = at + length + 1;
    if (length > 0 && end != NULL && text[at + length - 1] == '\r') --length;
    if (length >= sizeof line) return refuse(&r, "longer than any line here");
    if (memchr(text + at, '\0', length) != NULL) return refuse(&r, "a control character");
    memcpy(line, text + at, length);
    line[length] = '\0';
    if (!take_line(&r, line)) return false;
    at = next;
  }
  return check(&r);
}

bool config_read(const char *path, vista_parameters *parameters, problem *p) {
  const int file = open(path, O_RDONLY | O_CLOEXEC);
  if (file < 0) return problem_errno(p, path, errno);
  char *const text = malloc(CONFIG_MOST_BYTES);
  size_t bytes = 0;
  ssize_t got = text != NULL ? 1 : -1;
  while (got > 0 && bytes < CONFIG_MOST_BYTES) {
    got = read(file, text + bytes, CONFIG_MOST_BYTES - bytes);
    if (got > 0) bytes += (size_t)got;
  }
  const int number = errno;
  (void)close(file);
  const bool done = got < 0                      ? problem_errno(p, path, number)
                    : bytes == CONFIG_MOST_BYTES ? problem_say(p, path, "larger than any configuration")
                                                 : config_parse(path, text, bytes, parameters, p);
  free(text);
  return done;
}
