/* Bad input in one line. Whoever finds it writes it into the caller's memory; main prints it. */
#ifndef VISTA_FLY_PROBLEM_H
#define VISTA_FLY_PROBLEM_H

#include <stdbool.h>

#define PROBLEM_BYTES 512

typedef struct problem {
  char line[PROBLEM_BYTES]; /* "culprit: reason", without a line break */
} problem;

/* Writes the line; false, to be returned. */
__attribute__((format(printf, 3, 4))) bool problem_say(problem *p, const char *culprit, const char *format, ...);

/* The same with what the system says of an errno, in lower case. */
bool problem_errno(problem *p, const char *culprit, int number);

#endif
