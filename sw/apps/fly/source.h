/* Sources of raw pairs: a recording of `vista prepare`, shared memory or cameras; or a board with sensors of its own, of which
 * words come. A source is opened, run in a thread of its own, and closed. While it runs it takes no memory. */
#ifndef VISTA_FLY_SOURCE_H
#define VISTA_FLY_SOURCE_H

#include <stdatomic.h>
#include <stdint.h>

#include "container.h"
#include "mailbox.h"
#include "problem.h"

typedef struct source source;

/* What each kind of source does. */
typedef struct source_kind {
  /* Puts frames into the mailbox until it ends or `stopped`. False: it failed, and the problem says why. */
  bool (*run)(source *s);
  void (*close)(source *s);
} source_kind;

struct source {
  const source_kind *kind;
  mailbox *box;
  int32_t width_px, height_px;
  bool has_poses; /* some frame may have one */
  atomic_bool stopped;
  atomic_llong alive_ns; /* when the thread of the source last did something */
  atomic_llong skipped; /* frames that the source left out itself */
  int64_t passes, frames; /* of a recording: how often it is played, 0: without end; frames of a pass, 0: all */
  problem problem;
  void *own; /* of the kind */
};

/* The frames of an open container, as fast as they were taken, or with a patient mailbox as fast as they are taken from.
 * passes, frames: as in source. */
bool source_open_recording(source *s, container *c, int64_t passes, int64_t frames, problem *p);

/* Frames that another process shares, as vista/shared_frames.h describes. It may come later, and go and come back. */
bool source_open_shared(source *s, const char *name, problem *p);

/* The sensors of a board, ADDRESS or ADDRESS:PORT, which matches their pairs as the rig of the container says. silent_ms:
 * after which the board counts as lost. */
bool source_open_board(source *s, const char *name, const container *c, int32_t silent_ms, problem *p);

/* Cameras of V4L2: one whose picture holds both views side by side, or a left and a right one. */
bool source_open_cameras(source *s, const char *const *devices, int count, int64_t tolerance_ns, problem *p);

#endif
