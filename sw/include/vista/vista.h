/* libvista: obstacles from image pairs. This is the header to include; it includes the others.
 *
 *   vista_parameters parameters = vista_parameters_default();
 *   vista_rig rig = {.camera = {...}};
 *   vista_detector_options options = {0};
 *   size_t bytes;
 *   vista_detector_bytes(&parameters, &rig, &options, &bytes);
 *   vista_detector *detector;
 *   vista_detector_create(malloc(bytes), bytes, &parameters, &rig, &options, &detector);
 *   for each pair of images:
 *     vista_detector_pair pair = {.left = ..., .right = ..., .t_ns = ...};
 *     vista_detector_place place = {.pose = ...};
 *     vista_novelty novelty;
 *     vista_detector_result result;
 *     vista_detector_process(detector, &pair, &place, &novelty, &result);
 *   vista_detector_destroy(detector);
 *
 * vista/pipeline.h is the same without the images' way to disparities, for those that come from elsewhere.
 * vista/plan.h decides what is flown next. A stereo engine on a board is reached by vista/board.h. vista/correction.h
 * keeps the cameras aligned, vista/line.h writes results as JSON, vista/mavlink.h tells an autopilot of them,
 * vista/vehicle.h hears from it where the vehicle is, and vista/shared_frames.h hands pairs to the program vista-fly.
 *
 * Functions that can fail return a vista_status. Nothing is allocated, printed or kept in global state. */
#ifndef VISTA_VISTA_H
#define VISTA_VISTA_H

#include "vista/alignment.h"
#include "vista/api.h"
#include "vista/board.h"
#include "vista/correction.h"
#include "vista/detector.h"
#include "vista/directions.h"
#include "vista/latency.h"
#include "vista/line.h"
#include "vista/mavlink.h"
#include "vista/obstacle.h"
#include "vista/parameters.h"
#include "vista/pipeline.h"
#include "vista/plan.h"
#include "vista/rig.h"
#include "vista/shared_frames.h"
#include "vista/status.h"
#include "vista/types.h"
#include "vista/vehicle.h"
#include "vista/version.h"

#endif
