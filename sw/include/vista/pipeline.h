/* The detector takes a left image, the disparities of the engine, the time and the pose, and gives obstacles. Without the
 * image it does what the disparities alone allow, and the frame is degraded (VISTA_HEALTH_IMAGE_MISSING).
 *
 * The caller provides all memory: vista_pipeline_bytes says how much vista_pipeline_create needs. Processing a frame
 * allocates nothing, keeps no pointer into the frame, and gives the same result for the same frames every time. A
 * pipeline is used by one thread at a time; any number of pipelines may run at once. In memory on large pages a frame
 * takes some 4 % less time. With host.threads = 2 a pipeline has a thread of its own that helps with each frame and
 * sleeps between them; the results are the same.
 *
 * vista_parameters, vista_frame, vista_result, vista_views and vista_obstacle may get more members at their end. The
 * library is told how large the caller's are, or says how large its own are, so that a program built with an older
 * header goes on working. All other structs stay as they are within one soname. */
#ifndef VISTA_PIPELINE_H
#define VISTA_PIPELINE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "vista/api.h"
#include "vista/directions.h"
#include "vista/obstacle.h"
#include "vista/parameters.h"
#include "vista/status.h"
#include "vista/types.h"

VISTA_BEGIN

/* The input of one frame. Members that are left out of an initialiser are zero, which stands for "not given". */
typedef struct vista_frame {
  vista_image image; /* the rectified left image; all zero: none came with the words */
  vista_disparity_image disparity; /* words of the engine, of the same size */
  const vista_pose *pose; /* of the rectified left camera in the world; null: not known (motion.source) */
  const double *up_world; /* 3 numbers: the unit vector against gravity in the world; null: -y of the camera */
  int64_t t_ns; /* increasing from frame to frame */
  const double *velocity_m_s; /* 3 numbers: of the camera in the world; null: from the poses */
  bool stationary; /* without a pose: the camera has not moved since the last frame */
  vista_disparity_image coarser[VISTA_COARSER_LEVELS]; /* words of levels 1, 2, ..; the first without data ends them */
} vista_frame;

/* What the detector saw, as pictures for displays and logs. Each pixel belongs to a cell of the log-polar grid, each
 * cell to a region or to none. */
typedef struct vista_views {
  int32_t width_px, height_px, cell_count, region_count;
  const int32_t *cell_of_pixel; /* height * width; the same in every frame */
  const float *cell_intensity; /* cell_count: mean grey level, 0 .. 255 */
  const float *cell_disparity_px; /* cell_count: median; negative without one */
  const int32_t *region_of_cell; /* cell_count: -1 without one */
  const int32_t *region_of_pixel; /* height * width: -1 without one; boundaries follow the image */
  const vista_region_verdict *verdict_of_region; /* region_count */
  const int16_t *words; /* height * width: the disparity of each pixel in 1/16 px, of all levels; negative: none */
} vista_views;

/* The output of one frame. Its pointers lead into the memory of the pipeline and are valid until the next frame. */
typedef struct vista_result {
  const vista_obstacle *obstacles; /* nearest first; see vista_result_obstacle */
  int32_t obstacle_count;
  int32_t obstacle_bytes; /* bytes from one obstacle to the next */
  vista_nearest_collision nearest_collision;
  vista_motion motion;
  vista_health health;
  double valid_fraction; /* share of the pixels of the image that have a disparity */
  int32_t region_count;
  int32_t accepted_count; /* regions that are taken for obstacles */
  int64_t dropped_tracks; /* tracks, new ones included, that were dropped in this frame because the table was full */
  int32_t stage_count; /* the same as vista_stage_count() */
  const double *stage_ms; /* stage_count numbers: the time of each stage */
  double host_ms; /* the time of the frame: of all stages together, or less where two threads work at once */
  const vista_views *views;
  double path_seen_m; /* how far the flight path is free: beyond, no obstacle does not mean free space */
  double collision_probability; /* that something is in the way where nearest_collision is; NaN if that is not known,
                                   as of what moves or is too near to match, or there is none */
} vista_result;

/* Returns the obstacle with this index, 0 .. obstacle_count - 1. Indexing result->obstacles does the same as long as
 * header and library are of one version. */
static inline const vista_obstacle *vista_result_obstacle(const vista_result *result, int32_t index) {
  const char *const first = (const char *)result->obstacles;
  return (const vista_obstacle *)(const void *)(first + (ptrdiff_t)index * result->obstacle_bytes);
}

/* The number of stages. */
VISTA_API int32_t vista_stage_count(void);

/* The name of a stage, in lower case as in summary.json, in the order of the chain; never null. */
VISTA_API const char *vista_stage_name(int32_t stage);

/* A detector, in the memory that vista_pipeline_create was given. */
typedef struct vista_pipeline vista_pipeline;

/* The number of bytes that a pipeline for this camera needs. The errors are those of vista_pipeline_create. */
VISTA_API vista_status vista_pipeline_bytes(const vista_parameters *parameters, const vista_camera *camera,
                                            size_t *bytes);

/* Makes a pipeline in the memory given, which may have any alignment.
 *
 * - VISTA_ERROR_RANGE: a parameter or a number of the camera is out of range.
 * - VISTA_ERROR_SIZE: images of this size are not handled.
 * - VISTA_ERROR_NUMBER: a number of the camera is not finite.
 * - VISTA_ERROR_MEMORY: there are too few bytes.
 * - VISTA_ERROR_THREAD: the system gives no second thread (host.threads). */
VISTA_API vista_status vista_pipeline_create(void *memory, size_t bytes, const vista_parameters *parameters,
                                             const vista_camera *camera, vista_pipeline **pipeline);

/* Ends the second thread, if there is one: with host.threads = 2 it is called before the memory is given back or used
 * for something else, and without it need not be. The pipeline is gone then. Null is allowed. */
VISTA_API void vista_pipeline_destroy(vista_pipeline *pipeline);

/* Forgets tracks, velocity and time, as is needed between sequences. Ids go on counting. */
VISTA_API void vista_pipeline_reset(vista_pipeline *pipeline);

/* Does what vista_pipeline_process does, for a frame and a result of these sizes. */
VISTA_API vista_status vista_pipeline_process_sized(vista_pipeline *pipeline, const vista_frame *frame,
                                                    size_t frame_bytes, vista_result *result, size_t result_bytes);

/* Processes one frame. On an error the tracks are as before, and *result is not written.
 *
 * - VISTA_ERROR_ARGUMENT: a pointer is null, or a level is missing before another.
 * - VISTA_ERROR_SIZE: the images have another size than the camera, or a level has not half the size of the one before.
 * - VISTA_ERROR_ORDER: the time is not after that of the frame before.
 * - VISTA_ERROR_NUMBER: the pose, the velocity or the vector against gravity is not finite.
 * - VISTA_ERROR_RANGE: the pose has no rotation, the vector against gravity is not of unit length, or the velocity is
 *   above motion.speed_max_m_s. */
static inline vista_status vista_pipeline_process(vista_pipeline *pipeline, const vista_frame *frame,
                                                  vista_result *result) {
  return vista_pipeline_process_sized(pipeline, frame, sizeof *frame, result, sizeof *result);
}

/* Which directions were free in the last frame. It is no stage of a frame: who does not ask has no cost. Without a frame
 * since the pipeline was made nothing is free. */
VISTA_API vista_status vista_pipeline_directions(const vista_pipeline *pipeline, vista_directions *directions);

VISTA_END

#endif
