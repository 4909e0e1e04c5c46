#include "problem.h"

#include <ctype.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

bool problem_say(problem *p, const char *culprit, const char *format, ...) {
  va_list arguments;
  int used = snprintf(p->line, sizeof p->line, "%s: ", culprit);
  if (used < 0) used = 0;
  va_start(arguments, format);
  if ((size_t)used < sizeof p->line) (void)vsnprintf(p->line + used, sizeof p->line - (size_t)used, format, arguments);
  va_end(arguments);
  for (char *c = p->line; *c != '\0'; ++c)
    if (iscntrl((unsigned char)*c)) *c = '?';
  return false;
}

bool problem_errno(problem *p, const char *culprit, int number) {
  const char *const text = strerror(number);
  return problem_say(p, culprit, "%c%s", tolower((unsigned char)text[0]), text + 1);
}
