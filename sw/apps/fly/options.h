/* The command line of vista-fly. */
#ifndef VISTA_FLY_OPTIONS_H
#define VISTA_FLY_OPTIONS_H

#include <stdbool.h>
#include <stdint.h>

#include "problem.h"

typedef enum options_want { OPTIONS_FLY = 0, OPTIONS_HELP, OPTIONS_VERSION } options_want;

/* Texts lead into the command line; null: not given. */
typedef struct options {
  options_want want;
  const char *rig, *recording, *shared, *board, *camera[2], *to, *out, *times;
  int camera_count;
  bool poses_from_mavlink, repeat, all_frames;
  bool has_goal;
  double goal_m[3], speed_m_s; /* NED */
  double pose_delay_ms, pair_tolerance_ms, watchdog_s;
  double passes, frames, threads; /* of a recording: 0 is without end, all, as it says */
  int listen_port;                /* 0: any */
} options;

extern const char *const options_help;

bool options_parse(int argc, char *const *argv, options *o, problem *p);

#endif
