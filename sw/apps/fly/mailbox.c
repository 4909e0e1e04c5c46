#include "mailbox.h"

#include <stdlib.h>
#include <time.h>

#define SECOND 1000000000LL

bool mailbox_make(mailbox *box, int32_t pixels, size_t words, bool patient) {
  pthread_condattr_t attributes;
  *box = (mailbox){.patient = patient, .pixels = pixels, .writing = 0, .waiting = 1, .taken = 2};
  (void)pthread_condattr_init(&attributes);
  (void)pthread_condattr_setclock(&attributes, CLOCK_MONOTONIC);
  (void)pthread_mutex_init(&box->lock, NULL);
  (void)pthread_cond_init(&box->changed, &attributes);
  (void)pthread_condattr_destroy(&attributes);
  for (int k = 0; k < 3; ++k) {
    box->shots[k].left = calloc(2, (size_t)pixels);
    box->shots[k].words = calloc(words + 1, sizeof(int16_t));
    if (box->shots[k].left == NULL || box->shots[k].words == NULL) return false;
    box->shots[k].right = box->shots[k].left + pixels;
  }
  return true;
}

void mailbox_free(mailbox *box) {
  for (int k = 0; k < 3; ++k) {
    free(box->shots[k].left);
    free(box->shots[k].words);
  }
  (void)pthread_cond_destroy(&box->changed);
  (void)pthread_mutex_destroy(&box->lock);
}

shot *mailbox_blank(mailbox *box) { return &box->shots[box->writing]; }

static void swap(int *a, int *b) {
  const int kept = *a;
  *a = *b;
  *b = kept;
}

void mailbox_put(mailbox *box) {
  (void)pthread_mutex_lock(&box->lock);
  while (box->patient && box->full && !box->closed) (void)pthread_cond_wait(&box->changed, &box->lock);
  if (box->full) {
    ++box->dropped;
    box->shots[box->writing].continues &= box->shots[box->waiting].continues; /* what began still has to be told */
  }
  swap(&box->writing, &box->waiting);
  box->full = true;
  (void)pthread_cond_broadcast(&box->changed);
  (void)pthread_mutex_unlock(&box->lock);
}

void mailbox_close(mailbox *box) {
  (void)pthread_mutex_lock(&box->lock);
  box->closed = true;
  (void)pthread_cond_broadcast(&box->changed);
  (void)pthread_mutex_unlock(&box->lock);
}

const shot *mailbox_take(mailbox *box, int64_t timeout_ns) {
  struct timespec until;
  (void)clock_gettime(CLOCK_MONOTONIC, &until);
  const int64_t end_ns = until.tv_nsec + timeout_ns;
  until.tv_sec += (time_t)(end_ns / SECOND);
  until.tv_nsec = (long)(end_ns % SECOND);
  (void)pthread_mutex_lock(&box->lock);
  int late = 0;
  while (!box->full && !box->closed && late == 0) late = pthread_cond_timedwait(&box->changed, &box->lock, &until);
  const bool there = box->full;
  if (there) {
    swap(&box->taken, &box->waiting);
    box->full = false;
    (void)pthread_cond_broadcast(&box->changed);
  }
  (void)pthread_mutex_unlock(&box->lock);
  return there ? &box->shots[box->taken] : NULL;
}

bool mailbox_ended(mailbox *box) {
  (void)pthread_mutex_lock(&box->lock);
  const bool ended = box->closed && !box->full;
  (void)pthread_mutex_unlock(&box->lock);
  return ended;
}

int64_t mailbox_dropped(mailbox *box) {
  (void)pthread_mutex_lock(&box->lock);
  const int64_t dropped = box->dropped;
  (void)pthread_mutex_unlock(&box->lock);
  return dropped;
}
