/* The chain of one frame: rectified, matched at each level, and judged; what was found as a line and as a frame for the
 * autopilot. All memory is taken when it is made. */
#ifndef VISTA_FLY_DETECTOR_H
#define VISTA_FLY_DETECTOR_H

#include <stddef.h>

#include "aligner.h"
#include "mailbox.h"
#include "problem.h"
#include "rig.h"
#include "vista/engine.h"
#include "vista/line.h"
#include "vista/mavlink.h"
#include "vista/pipeline.h"

/* Where the camera is at the time of a frame. Members as in vista_frame. */
typedef struct placement {
  bool has_pose, has_up, has_velocity;
  vista_pose pose; /* of the rectified left camera */
  double up_world[3], velocity_m_s[3];
} placement;

typedef struct detector {
  const rig *rig;
  vista_engine_params engine;
  int32_t levels;
  bool smooth;
  aligner aligner;
  vista_pipeline *pipeline;
  bool placed; /* a frame had a pose since the last reset */
  void *memory, *scratch;
  size_t scratch_bytes;
  uint8_t *images[2][VISTA_FRONTEND_MAX_LEVELS]; /* left, right: rectified, of each level */
  uint8_t *smoothed[2];
  int16_t *words[VISTA_FRONTEND_MAX_LEVELS];
} detector;

/* What one frame gave. */
typedef struct detection {
  vista_result result; /* valid until the next frame */
  vista_directions directions;
  vista_line_health health;
} detection;

bool detector_make(detector *d, const rig *r, const vista_parameters *parameters, problem *p);
void detector_free(detector *d);

/* What comes next does not continue what came before. */
void detector_reset(detector *d);

/* Forgets the tracks alone: the cameras are as they were. */
void detector_forget(detector *d);

/* Rectifies and matches a pair; then detector_judge is called. Between them the pose may still arrive. */
bool detector_match(detector *d, const shot *s, problem *p);
bool detector_judge(detector *d, const shot *s, const placement *where, detection *found, problem *p);

#endif
