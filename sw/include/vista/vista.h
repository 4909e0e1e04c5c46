/* libvista: obstacles from stereo disparities. This is the header to include; it includes the others.
 *
 *   vista_parameters parameters = vista_parameters_default();
 *   vista_camera camera = {...};
 *   size_t bytes;
 *   vista_pipeline_bytes(&parameters, &camera, &bytes);
 *   vista_pipeline *pipeline;
 *   vista_pipeline_create(malloc(bytes), bytes, &parameters, &camera, &pipeline);
 *   for each frame:
 *     vista_frame frame = {.image = ..., .disparity = ..., .pose = ..., .t_ns = ...};
 *     vista_result result;
 *     vista_pipeline_process(pipeline, &frame, &result);
 *   vista_pipeline_destroy(pipeline);
 *
 * A stereo engine on a board is reached by vista/board.h. vista/correction.h keeps the cameras aligned, vista/line.h
 * writes results as JSON, vista/mavlink.h tells an autopilot of them, vista/vehicle.h hears from it where the vehicle is,
 * and vista/shared_frames.h hands pairs to the program vista-fly.
 *
 * Functions that can fail return a vista_status. Nothing is allocated, printed or kept in global state. */
#ifndef VISTA_VISTA_H
#define VISTA_VISTA_H

#include "vista/alignment.h"
#include "vista/api.h"
#include "vista/board.h"
#include "vista/correction.h"
#include "vista/directions.h"
#include "vista/line.h"
#include "vista/mavlink.h"
#include "vista/obstacle.h"
#include "vista/parameters.h"
#include "vista/pipeline.h"
#include "vista/shared_frames.h"
#include "vista/status.h"
#include "vista/types.h"
#include "vista/vehicle.h"
#include "vista/version.h"

#endif
