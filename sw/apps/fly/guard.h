/* The watchdog: tells systemd that the program works, and ends it when a thread stands still, to be started again. */
#ifndef VISTA_FLY_GUARD_H
#define VISTA_FLY_GUARD_H

#include <pthread.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

#include "problem.h"

#define GUARD_WATCHED 3
#define GUARD_EXIT 3 /* the exit status when a thread stands still */

typedef struct guard_watched {
  const char *name;
  const atomic_llong *alive_ns; /* when it last did something */
} guard_watched;

typedef struct guard {
  pthread_t thread;
  bool running;
  int count;
  guard_watched watched[GUARD_WATCHED];
  int64_t limit_ns;
  int socket; /* to systemd; -1: not started by it */
  atomic_bool stopped;
} guard;

/* limit_ns: how long a thread may stand still. Joins $NOTIFY_SOCKET, if there is one. */
void guard_open(guard *g, int64_t limit_ns);
void guard_watch(guard *g, const char *name, const atomic_llong *alive_ns);

/* Starts, and tells systemd that the program is ready. */
bool guard_start(guard *g, problem *p);
void guard_close(guard *g);

#endif
