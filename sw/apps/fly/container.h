/* The file that a program takes along: a rig, parameters, and, if it is a recording, frames. vista/recording.py writes it
 * and describes its layout. */
#ifndef VISTA_FLY_CONTAINER_H
#define VISTA_FLY_CONTAINER_H

#include <stdio.h>
#include <sys/types.h>

#include "mailbox.h"
#include "problem.h"
#include "vista/parameters.h"
#include "vista/rig.h"

#define CONTAINER_TEXT_BYTES 192

typedef struct container {
  const char *path;
  FILE *stream;
  vista_rig rig;
  vista_parameters parameters;
  bool has_words; /* frames are rectified and matched; otherwise they are raw pairs */
  bool has_right, stills;
  size_t pixels, words; /* of an image; of all levels of a frame */
  off_t first_frame;
  int64_t frames;
  char problems[2][CONTAINER_TEXT_BYTES]; /* of the rig */
  void *tables; /* of the rig */
  char buffer[1 << 16]; /* of the stream, which would take its own from the heap */
} container;

/* Reads all but the frames, and checks it. *c stays where it is: the rig leads into it. */
bool container_open(container *c, const char *path, problem *p);
void container_close(container *c);

/* The words of all levels of a pair of this rig. */
size_t container_words_of_pair(const container *c);

/* The first frame is the next. */
bool container_rewind(container *c, problem *p);

/* The next frame. Its times are those of the file, and it continues the one before. */
bool container_read(container *c, shot *to, problem *p);

#endif
