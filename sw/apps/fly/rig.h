/* The file of a rig, which `vista prepare` writes and vista/flight_files.py describes. */
#ifndef VISTA_FLY_RIG_H
#define VISTA_FLY_RIG_H

#include "problem.h"
#include "vista/rig.h"

typedef struct rig {
  vista_rig cameras;
  void *memory; /* of their tables */
} rig;

/* Reads a rig and checks all of it. */
bool rig_read(const char *path, rig *r, problem *p);

void rig_free(rig *r);

#endif
