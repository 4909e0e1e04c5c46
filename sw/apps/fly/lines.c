#include "lines.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* The end of the last whole line. -1: the file cannot be read. */
static off_t whole_bytes(int file, off_t bytes) {
  char buffer[4096];
  while (bytes > 0) {
    const off_t from = bytes > (off_t)sizeof buffer ? bytes - (off_t)sizeof buffer : 0;
    const ssize_t got = pread(file, buffer, (size_t)(bytes - from), from);
    if (got != (ssize_t)(bytes - from)) return -1;
    for (ssize_t k = got - 1; k >= 0; --k)
      if (buffer[k] == '\n') return from + k + 1;
    bytes = from;
  }
  return 0;
}

static bool mend(int file) {
  struct stat status;
  if (fstat(file, &status) != 0) return false;
  if (!S_ISREG(status.st_mode)) return true;
  const off_t whole = whole_bytes(file, status.st_size);
  return whole >= 0 && (whole == status.st_size || ftruncate(file, whole) == 0);
}

bool lines_open(lines *l, const char *path, problem *p) {
  *l = (lines){.path = path, .file = -1};
  if (path == NULL) return true;
  l->own = strcmp(path, "-") != 0;
  l->file = l->own ? open(path, O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0666) : STDOUT_FILENO;
  if (l->file < 0) l->file = open(path, O_WRONLY | O_CLOEXEC); /* a pipe, or a device that cannot be read */
  if (l->file < 0 || (l->own && !mend(l->file))) {
    const int number = errno;
    lines_close(l);
    return problem_errno(p, path, number);
  }
  return true;
}

bool lines_write(lines *l, const char *line, size_t bytes, problem *p) {
  if (l->file < 0) return true;
  const ssize_t written = write(l->file, line, bytes);
  if (written == (ssize_t)bytes) return true;
  const int number = written < 0 ? errno : ENOSPC;
  struct stat status;
  if (written > 0 && l->own && fstat(l->file, &status) == 0 && S_ISREG(status.st_mode) &&
      ftruncate(l->file, status.st_size - written) != 0)
    return problem_errno(p, l->path, errno);
  (void)problem_errno(p, l->path, number);
  lines_close(l);
  return false;
}

void lines_close(lines *l) {
  if (l->own && l->file >= 0) (void)close(l->file);
  l->file = -1;
}
