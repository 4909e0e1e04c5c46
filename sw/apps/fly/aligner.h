/* The correction of the rig in flight, where the parameters ask for it. All memory is taken when it is made. */
#ifndef VISTA_FLY_ALIGNER_H
#define VISTA_FLY_ALIGNER_H

#include "problem.h"
#include "rig.h"
#include "vista/correction.h"

typedef struct aligner {
  const rig *rig;
  vista_correction *correction; /* null: it is not asked for */
  void *memory;
  vista_alignment_result found; /* of the newest pair; of zeros before */
  int64_t changes;
} aligner;

bool aligner_make(aligner *a, const rig *r, const vista_parameters *parameters, problem *p);
void aligner_free(aligner *a);

/* The calibration holds again. */
void aligner_reset(aligner *a);

/* How right images are to be rectified. */
rig_table aligner_table(const aligner *a);

/* Takes a rectified pair, whose rows have no gaps between them. */
vista_status aligner_take(aligner *a, const uint8_t *left, const uint8_t *right, int64_t t_ns);

#endif
