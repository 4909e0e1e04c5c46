/* The loop: of the frames that have come the newest is processed, told of and written, until the source ends. */
#ifndef VISTA_FLY_FLIGHT_H
#define VISTA_FLY_FLIGHT_H

#include <time.h>

#include "autopilot.h"
#include "guard.h"
#include "lines.h"
#include "mailbox.h"
#include "options.h"
#include "pilot.h"
#include "source.h"
#include "times.h"
#include "vista/detector.h"
#include "vista/latency.h"

typedef struct flight {
  options options;
  container file; /* of the rig and the parameters, and the recording */
  times times;
  pthread_t reader;            /* the thread of the source */
  struct timespec reader_time; /* what it has taken of the processor */
  mailbox box;
  source source;
  vista_detector *detector;
  void *memory; /* of the detector */
  vista_alignment_result aligned; /* of the newest pair */
  int64_t alignments;             /* how often the correction changed */
  autopilot autopilot; /* with --to */
  pilot pilot;         /* with --goal */
  guard guard;
  lines lines;
  char line[VISTA_LINE_BYTES];
  atomic_llong alive_ns;
  int64_t processed, duplicates, restarts, refused;
  vista_latency latency; /* from the exposure until it is told of and written */
} flight;

/* Takes all memory. On a problem it may be half open; flight_close is called in any case. */
bool flight_open(flight *f, const options *o, problem *p);

/* Flies until the source ends or *interrupted. False: the source failed. */
bool flight_run(flight *f, const atomic_bool *interrupted, problem *p);

void flight_close(flight *f);

/* What came and how long it took, on stderr. */
void flight_print(flight *f);

#endif
