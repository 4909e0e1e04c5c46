/* Recordings of any content through the replay program: it ends with status 0 or 2. */
#define _GNU_SOURCE
#include <stdio.h>
#include <sys/mman.h>
#include <unistd.h>

#include "input.h"

int replay_main(int argc, char **argv); /* main of sw/apps/replay.c */

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  char path[64], program[] = "replay";
  const int file = memfd_create("recording", 0);
  if (file < 0 || write(file, data, size) != (ssize_t)size) abort();
  (void)snprintf(path, sizeof path, "/proc/self/fd/%d", file);
  char *arguments[] = {program, path, NULL};
  const int status = replay_main(2, arguments);
  (void)close(file);
  if (status != 0 && status != 2) abort();
  return 0;
}
