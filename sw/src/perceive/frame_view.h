/* One frame as its stages see it: what it is, and what the first of them found out about it as a whole. The pipeline
 * fills it in once, in the order of the stages, and each of them takes it. */
#ifndef VISTA_FRAME_VIEW_H
#define VISTA_FRAME_VIEW_H

#include <stdbool.h>
#include <stdint.h>

#include "common/flight_path.h"
#include "common/image_noise.h"
#include "common/matched_area.h"
#include "perceive/cells/foveation.h"
#include "vista/obstacle.h"
#include "vista/parameters.h"
#include "vista/types.h"

typedef struct vista_frame_view {
  const vista_parameters *params;
  const vista_camera *camera;
  const vista_foveation *foveation;
  int64_t t_ns;
  vista_image image; /* rectified, left; black, where none was given */
  bool seen;         /* one was */
  vista_disparity_image levels[1 + VISTA_COARSER_LEVELS]; /* words of the engine, the first one of full resolution */
  vista_matched_area matched;                             /* by the engine, with the levels of this frame */
  vista_motion motion;                                    /* pose and velocity */
  vista_flight_path path;                                 /* flown next, in the world */
  double up_camera[3];                                    /* unit vector against gravity in camera coordinates */
  bool up_known;                                          /* else the camera is taken for level */
  vista_image_noise noise;
  vista_disparity_image words; /* of all levels together */
} vista_frame_view;

#endif
