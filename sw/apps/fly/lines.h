/* A file of whole lines, to which a restarted program goes on writing. */
#ifndef VISTA_FLY_LINES_H
#define VISTA_FLY_LINES_H

#include <stdbool.h>
#include <stddef.h>

#include "problem.h"

typedef struct lines {
  const char *path;
  int file; /* -1: none, or given up */
  bool own; /* to be closed */
} lines;

/* path: "-" is stdout, null is none. Appends to a file; what a killed program left of a line is cut off first. */
bool lines_open(lines *l, const char *path, problem *p);

/* Writes a line with its line break in one piece. A file that cannot be written any more is given up: false, once. */
bool lines_write(lines *l, const char *line, size_t bytes, problem *p);

void lines_close(lines *l);

#endif
