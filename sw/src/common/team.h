/* The thread that calls libvista and, if it is asked for (host.threads), a second one that helps it: both take part
 * after part of a job until none is left. A part writes what no other part reads or writes, so that results do not
 * depend on who does which, nor on whether there is a second thread at all. The second one sleeps between jobs; when it
 * wakes late, or never, the first one has done all parts meanwhile. Internal to libvista. */
#ifndef VISTA_SRC_TEAM_H
#define VISTA_SRC_TEAM_H

#include <stdint.h>

#include "common/arena.h"
#include "vista/status.h"

#define VISTA_MOST_WORKERS 2

struct vista_helper; /* the second thread */

/* Zeroed, it is the calling thread alone. */
typedef struct vista_team {
  int32_t workers;             /* 0 and 1: the calling thread alone */
  struct vista_helper *helper; /* null: none has been started */
} vista_team;

/* One part of a job. worker: which of the threads does it, 0 .. VISTA_MOST_WORKERS - 1, for scratch memory. */
typedef void (*vista_part)(void *context, int32_t part, int32_t worker);

/* Workers that may come to a part; null: the calling thread alone. */
static inline int32_t vista_team_workers(const vista_team *team) {
  return team != NULL && team->workers > 1 ? team->workers : 1;
}

/* workers: 1 .. VISTA_MOST_WORKERS. Starts no thread. VISTA_ERROR_THREAD: this system has none. */
vista_status vista_team_layout(int32_t workers, vista_arena *arena, vista_team *team);

/* Starts the second thread, if there is to be one. VISTA_ERROR_THREAD: the system gives none. */
vista_status vista_team_start(vista_team *team);

/* Ends the second thread, if there is one. */
void vista_team_stop(vista_team *team);

/* Does parts 0 .. count - 1, each once, and returns when all are done. They are begun in this order, the longest one
 * should come first. A job of one part is no job to share: that part may share its own work. A part of a job of more
 * that calls this again does the parts of that call alone. team: null is the calling thread alone. */
void vista_team_share(vista_team *team, vista_part do_part, void *context, int32_t count);

#endif
