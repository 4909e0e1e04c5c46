#define _POSIX_C_SOURCE 200809L /* threads */

#include "common/team.h"

#include <stddef.h>

static void do_alone(vista_part do_part, void *context, int32_t count) {
  for (int32_t part = 0; part < count; ++part) do_part(context, part, 0);
}

#if defined(__has_include)
#if __has_include(<pthread.h>)
#define HAS_THREADS
#endif
#endif

#if defined(HAS_THREADS)

#include <pthread.h>
#include <stdatomic.h>
#include <stdbool.h>

/* All but `next` belongs to whoever holds the lock. */
struct vista_helper {
  pthread_t thread;
  pthread_mutex_t lock;
  pthread_cond_t begins, ends; /* a job, or the helper's life; the helper's work on a job */
  vista_part do_part;          /* null: no job */
  void *context;
  int32_t count;
  bool works; /* the helper, on the job */
  bool dismissed;
  atomic_int_least32_t next; /* part that nobody has taken yet */
};

static void do_parts(struct vista_helper *h, vista_part do_part, void *context, int32_t count, int32_t worker) {
  for (int32_t part; (part = atomic_fetch_add(&h->next, 1)) < count;) do_part(context, part, worker);
}

static void *help(void *of_team) {
  struct vista_helper *const h = of_team;
  (void)pthread_mutex_lock(&h->lock);
  for (;;) {
    while (!h->dismissed && (h->do_part == NULL || atomic_load(&h->next) >= h->count))
      (void)pthread_cond_wait(&h->begins, &h->lock);
    if (h->dismissed) break;
    const vista_part do_part = h->do_part;
    void *const context = h->context;
    const int32_t count = h->count;
    h->works = true;
    (void)pthread_mutex_unlock(&h->lock);
    do_parts(h, do_part, context, count, 1);
    (void)pthread_mutex_lock(&h->lock);
    h->works = false;
    (void)pthread_cond_signal(&h->ends);
  }
  (void)pthread_mutex_unlock(&h->lock);
  return NULL;
}

vista_status vista_team_layout(int32_t workers, vista_arena *arena, vista_team *team) {
  if (arena == NULL || team == NULL) return VISTA_ERROR_ARGUMENT;
  if (workers < 1 || workers > VISTA_MOST_WORKERS) return VISTA_ERROR_RANGE;
  *team = (vista_team){.workers = workers};
  if (workers > 1) team->helper = vista_arena_take(arena, 1, sizeof *team->helper);
  return arena->base != NULL && arena->used > arena->size ? VISTA_ERROR_MEMORY : VISTA_OK;
}

vista_status vista_team_start(vista_team *team) {
  struct vista_helper *const h = team->helper;
  if (h == NULL) return VISTA_OK;
  team->helper = NULL;
  if (pthread_mutex_init(&h->lock, NULL) != 0) return VISTA_ERROR_THREAD;
  if (pthread_cond_init(&h->begins, NULL) == 0) {
    if (pthread_cond_init(&h->ends, NULL) == 0) {
      if (pthread_create(&h->thread, NULL, help, h) == 0) {
        team->helper = h;
        return VISTA_OK;
      }
      (void)pthread_cond_destroy(&h->ends);
    }
    (void)pthread_cond_destroy(&h->begins);
  }
  (void)pthread_mutex_destroy(&h->lock);
  return VISTA_ERROR_THREAD;
}

void vista_team_stop(vista_team *team) {
  struct vista_helper *const h = team->helper;
  if (h == NULL) return;
  (void)pthread_mutex_lock(&h->lock);
  h->dismissed = true;
  (void)pthread_cond_signal(&h->begins);
  (void)pthread_mutex_unlock(&h->lock);
  (void)pthread_join(h->thread, NULL);
  (void)pthread_cond_destroy(&h->ends);
  (void)pthread_cond_destroy(&h->begins);
  (void)pthread_mutex_destroy(&h->lock);
  team->helper = NULL;
}

/* Only the thread that calls the pipeline gives jobs, so the job can only be another one's while that one shares: then
 * it is a part of it that calls. */
static bool give_job(struct vista_helper *h, vista_part do_part, void *context, int32_t count) {
  (void)pthread_mutex_lock(&h->lock);
  const bool free = h->do_part == NULL;
  if (free) {
    h->do_part = do_part;
    h->context = context;
    h->count = count;
    atomic_store(&h->next, 0);
    (void)pthread_cond_signal(&h->begins);
  }
  (void)pthread_mutex_unlock(&h->lock);
  return free;
}

static void end_job(struct vista_helper *h) {
  (void)pthread_mutex_lock(&h->lock);
  while (h->works) (void)pthread_cond_wait(&h->ends, &h->lock);
  h->do_part = NULL; /* not before: a part that shares would think that there is no job */
  (void)pthread_mutex_unlock(&h->lock);
}

void vista_team_share(vista_team *team, vista_part do_part, void *context, int32_t count) {
  struct vista_helper *const h = team != NULL ? team->helper : NULL;
  if (h == NULL || count < 2 || !give_job(h, do_part, context, count)) {
    do_alone(do_part, context, count);
    return;
  }
  do_parts(h, do_part, context, count, 0);
  end_job(h);
}

#else

vista_status vista_team_layout(int32_t workers, vista_arena *arena, vista_team *team) {
  if (arena == NULL || team == NULL) return VISTA_ERROR_ARGUMENT;
  *team = (vista_team){.workers = 1};
  return workers == 1 ? VISTA_OK : VISTA_ERROR_THREAD;
}

vista_status vista_team_start(vista_team *team) { return (void)team, VISTA_OK; }

void vista_team_stop(vista_team *team) { (void)team; }

void vista_team_share(vista_team *team, vista_part do_part, void *context, int32_t count) {
  (void)team;
  do_alone(do_part, context, count);
}

#endif
