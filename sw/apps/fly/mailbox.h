/* A queue of one frame between the thread of a source and that which detects: what was not taken in time gives way to
 * what is newer. All memory is taken when it is made. */
#ifndef VISTA_FLY_MAILBOX_H
#define VISTA_FLY_MAILBOX_H

#include <pthread.h>
#include <stdbool.h>
#include <stdint.h>

#include "vista/types.h"

/* A raw pair that was taken. */
typedef struct shot {
  int64_t index;
  int64_t t_ns;       /* counts for the motion of things, on the source's own clock */
  int64_t exposed_ns; /* the same moment on CLOCK_MONOTONIC */
  bool continues; /* false: what came before was another flight */
  bool has_pose, has_up;
  vista_pose pose;       /* of the raw left camera in the world */
  double up_world[3];
  bool anew;             /* poses begin anew */
  bool matched;          /* the pair is rectified, its pose is of the rectified left camera, and there are words */
  bool left_alone;       /* there is no right image */
  bool words_alone;      /* there is neither, and there are words */
  uint8_t *left, *right; /* height * width, in memory of the mailbox */
  int16_t *words;        /* of all levels, where there are any */
} shot;

typedef struct mailbox {
  pthread_mutex_t lock;
  pthread_cond_t changed;
  shot shots[3]; /* one that is written, one that waits, and the one that is worked on */
  int writing, waiting, taken;
  bool full, closed;
  bool patient; /* put waits until the frame before was taken */
  int64_t dropped;
  int32_t pixels;
} mailbox;

/* words: of a frame. False: out of memory. */
bool mailbox_make(mailbox *box, int32_t pixels, size_t words, bool patient);
void mailbox_free(mailbox *box);

/* The frame to be written next. For the source alone. */
shot *mailbox_blank(mailbox *box);

/* Hands it over. */
void mailbox_put(mailbox *box);

/* No more frames come; also ends waiting. */
void mailbox_close(mailbox *box);

/* The newest frame, which stays valid until the next is taken. Null: none came within the time, or none comes any
 * more. */
const shot *mailbox_take(mailbox *box, int64_t timeout_ns);

/* Closed, and nothing is left to take. */
bool mailbox_ended(mailbox *box);

int64_t mailbox_dropped(mailbox *box);

#endif
