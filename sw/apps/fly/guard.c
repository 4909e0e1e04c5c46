#include "guard.h"

#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "clock.h"

#define LOOK_NS (100 * FLY_MS)

/* The protocol of sd_notify(3): a datagram with an assignment. */
static void tell(const guard *g, const char *text) {
  if (g->socket >= 0) (void)send(g->socket, text, strlen(text), MSG_NOSIGNAL | MSG_DONTWAIT);
}

static int join(const char *path) {
  struct sockaddr_un address = {.sun_family = AF_UNIX};
  const size_t length = path != NULL ? strlen(path) : 0;
  if (length < 2 || length >= sizeof address.sun_path || (path[0] != '/' && path[0] != '@')) return -1;
  memcpy(address.sun_path, path, length);
  if (path[0] == '@') address.sun_path[0] = '\0'; /* an abstract name */
  const int file = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  const socklen_t bytes = (socklen_t)(offsetof(struct sockaddr_un, sun_path) + length);
  if (file < 0 || connect(file, (const struct sockaddr *)(const void *)&address, bytes) == 0) return file;
  (void)close(file);
  return -1;
}

void guard_open(guard *g, int64_t limit_ns) {
  *g = (guard){.limit_ns = limit_ns, .socket = join(getenv("NOTIFY_SOCKET"))};
}

void guard_watch(guard *g, const char *name, const atomic_llong *alive_ns) {
  if (g->count < GUARD_WATCHED) g->watched[g->count++] = (guard_watched){name, alive_ns};
}

static const char *find_still(const guard *g, int64_t now_ns) {
  for (int k = 0; k < g->count; ++k)
    if (now_ns - atomic_load(g->watched[k].alive_ns) > g->limit_ns) return g->watched[k].name;
  return NULL;
}

static void *run(void *context) {
  guard *const g = context;
  while (fly_sleep_until(fly_now_ns() + LOOK_NS, &g->stopped)) {
    const char *const still = find_still(g, fly_now_ns());
    if (still != NULL) {
      /* Threads that stand still cannot be ended: the program is, and begins anew with clean memory. */
      dprintf(STDERR_FILENO, "vista-fly: %s stands still for %.1f s: ending, to be started again\n", still,
              1e-9 * (double)g->limit_ns);
      _exit(GUARD_EXIT);
    }
    tell(g, "WATCHDOG=1");
  }
  return NULL;
}

bool guard_start(guard *g, problem *p) {
  g->running = pthread_create(&g->thread, NULL, run, g) == 0;
  tell(g, "READY=1");
  return g->running || problem_say(p, "system", "gives no thread");
}

void guard_close(guard *g) {
  atomic_store(&g->stopped, true);
  if (g->running) (void)pthread_join(g->thread, NULL);
  g->running = false;
  tell(g, "STOPPING=1");
  if (g->socket >= 0) (void)close(g->socket);
  g->socket = -1;
}
