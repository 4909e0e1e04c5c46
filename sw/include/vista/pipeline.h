/* The detector: a left image, the engine's disparities, time and pose in; obstacles out.
 *
 * All memory is the caller's: ask vista_pipeline_bytes, hand that much to vista_pipeline_create. Processing a frame
 * allocates nothing, keeps no pointer into the frame, and gives the same result for the same frames every time. A
 * pipeline is used by one thread at a time; any number of pipelines may run at once.
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
#include "vista/obstacle.h"
#include "vista/parameters.h"
#include "vista/status.h"
#include "vista/types.h"

VISTA_BEGIN

/* Members that are left out of an initialiser are zero, which stands for "not given". */
typedef struct vista_frame {
  vista_image image;               /* left, rectified */
  vista_disparity_image disparity; /* engine words of the same size */
  const vista_pose *pose;          /* of the left rectified camera in world; null: not known (motion.source) */
  const double *up_world;          /* 3: unit vector against gravity in world; null: camera -y */
  int64_t t_ns;                    /* increasing from frame to frame */
  const double *velocity_m_s;      /* 3: of the camera in world; null: from the poses */
  bool stationary;                 /* without a pose: the camera has not moved since the last frame */
} vista_frame;

/* Pictures of what the detector saw, for displays and logs. Each pixel belongs to a cell of the log-polar grid, each
 * cell to a region or to none. */
typedef struct vista_views {
  int32_t width_px, height_px, cell_count, region_count;
  const int32_t *cell_of_pixel;    /* height * width; the same in every frame */
  const float *cell_intensity;     /* cell_count: mean grey level, 0 .. 255 */
  const float *cell_disparity_px;  /* cell_count: median; negative without one */
  const int32_t *region_of_cell;   /* cell_count: -1 without one */
  const int32_t *region_of_pixel;  /* height * width: -1 without one; boundaries follow the image */
  const vista_region_verdict *verdict_of_region; /* region_count */
} vista_views;

/* Pointers lead into the pipeline's memory and are valid until the next frame. */
typedef struct vista_result {
  const vista_obstacle *obstacles; /* nearest first; see vista_result_obstacle */
  int32_t obstacle_count;
  int32_t obstacle_bytes; /* from one to the next */
  vista_nearest_collision nearest_collision;
  vista_motion motion;
  double valid_fraction;  /* of the image's pixels that have a disparity */
  int32_t region_count;
  int32_t accepted_count; /* of the regions, taken for obstacles */
  int64_t dropped_tracks; /* in this frame, newborns included: the table was full */
  int32_t stage_count;    /* as vista_stage_count */
  const double *stage_ms; /* stage_count: what each stage took */
  double host_ms;         /* all stages */
  const vista_views *views;
} vista_result;

/* The obstacle with this index, 0 .. obstacle_count - 1. Indexing result->obstacles does the same as long as header and
 * library are of one version. */
static inline const vista_obstacle *vista_result_obstacle(const vista_result *result, int32_t index) {
  const char *const first = (const char *)result->obstacles;
  return (const vista_obstacle *)(const void *)(first + (ptrdiff_t)index * result->obstacle_bytes);
}

/* The stages in their order. Lower-case name as in summary.json; never null. */
VISTA_API int32_t vista_stage_count(void);
VISTA_API const char *vista_stage_name(int32_t stage);

typedef struct vista_pipeline vista_pipeline;

/* Bytes that a pipeline for this camera needs. Errors as vista_pipeline_create. */
VISTA_API vista_status vista_pipeline_bytes(const vista_parameters *parameters, const vista_camera *camera,
                                            size_t *bytes);

/* The memory may have any alignment. VISTA_ERROR_RANGE: a parameter or the camera; VISTA_ERROR_SIZE: an image size that
 * is not handled; VISTA_ERROR_NUMBER: a camera number that is not finite; VISTA_ERROR_MEMORY: too few bytes. */
VISTA_API vista_status vista_pipeline_create(void *memory, size_t bytes, const vista_parameters *parameters,
                                             const vista_camera *camera, vista_pipeline **pipeline);

/* Forget tracks, velocity and time, as between sequences; ids go on counting. */
VISTA_API void vista_pipeline_reset(vista_pipeline *pipeline);

/* vista_pipeline_process for a frame and a result of these sizes. */
VISTA_API vista_status vista_pipeline_process_sized(vista_pipeline *pipeline, const vista_frame *frame,
                                                    size_t frame_bytes, vista_result *result, size_t result_bytes);

/* One frame. On an error the tracks are as before and *result is not written.
 * VISTA_ERROR_SIZE: images of another size; VISTA_ERROR_ORDER: time; VISTA_ERROR_NUMBER: pose, velocity or up not
 * finite; VISTA_ERROR_RANGE: pose without a rotation, up not of unit length, a velocity above motion.speed_max_m_s; VISTA_ERROR_ARGUMENT: a null pointer. */
static inline vista_status vista_pipeline_process(vista_pipeline *pipeline, const vista_frame *frame,
                                                  vista_result *result) {
  return vista_pipeline_process_sized(pipeline, frame, sizeof *frame, result, sizeof *result);
}

VISTA_END

#endif
