/* The chain in order: foveate, surface, affinity, segment, refine, regions, reconstruct, track, blind_zone, map;
 * nothing else happens here.
 *
 * All memory is the caller's: ask vista_pipeline_bytes, hand that much to vista_pipeline_create. Processing a frame
 * allocates nothing, keeps no pointer into the frame, and gives the same result for the same frames every time. */
#ifndef VISTA_PIPELINE_H
#define VISTA_PIPELINE_H

#include <stddef.h>
#include <stdint.h>

#include "stages/affinity.h"
#include "stages/blind_zone.h"
#include "stages/foveation.h"
#include "stages/obstacle_map.h"
#include "stages/refinement.h"
#include "stages/region.h"
#include "stages/segmentation.h"
#include "stages/surface.h"
#include "stages/tracker.h"
#include "vista/parameters.h"
#include "vista/status.h"
#include "vista/types.h"

typedef enum vista_stage {
  VISTA_STAGE_FOVEATION,
  VISTA_STAGE_SURFACE,
  VISTA_STAGE_AFFINITY,
  VISTA_STAGE_SEGMENTATION,
  VISTA_STAGE_REFINEMENT,
  VISTA_STAGE_REGIONS,
  VISTA_STAGE_RECONSTRUCTION,
  VISTA_STAGE_TRACKING,
  VISTA_STAGE_BLIND_ZONE,
  VISTA_STAGE_MAP,
  VISTA_STAGE_COUNT
} vista_stage;

/* Lower-case name as in summary.json; never null. */
const char *vista_stage_name(vista_stage stage);

typedef struct vista_frame {
  vista_image image;               /* left, rectified */
  vista_disparity_image disparity; /* engine words of the same size */
  const vista_pose *pose;          /* of the left rectified camera in world; null: a still camera, world = camera */
  const double *up_world;          /* 3: unit vector against gravity in world; null: camera -y */
  int64_t t_ns;                    /* increasing from frame to frame */
} vista_frame;

/* Views into the pipeline's memory, valid until the next frame. */
typedef struct vista_result {
  double stage_ms[VISTA_STAGE_COUNT];
  double host_ms;        /* all stages */
  double valid_fraction; /* of the image's pixels that have a disparity */
  const vista_foveation *foveation;
  const vista_cells *cells;
  const vista_surfaces *surfaces;
  const vista_affinity *affinity;
  const vista_segmentation *segmentation;
  const vista_refinement *refinement;
  const vista_region *regions;
  int32_t region_count;
  int32_t accepted_count;
  vista_blind_zone blind_zone;
  const vista_obstacle *obstacles; /* nearest first */
  int32_t obstacle_count;
  vista_nearest_collision nearest_collision;
  double velocity_m_s[3]; /* of the camera in world, from the poses; zero while unknown */
  int64_t dropped_tracks; /* in this frame, newborns included: the table was full */
} vista_result;

typedef struct vista_pipeline vista_pipeline;

/* Bytes that a pipeline for this camera needs. Errors as vista_pipeline_create. */
vista_status vista_pipeline_bytes(const vista_parameters *parameters, const vista_camera *camera, size_t *bytes);

/* VISTA_ERROR_RANGE: a parameter or the camera; VISTA_ERROR_SIZE: an image size that is not handled;
 * VISTA_ERROR_NUMBER: a camera number that is not finite; VISTA_ERROR_MEMORY: too few bytes. */
vista_status vista_pipeline_create(void *memory, size_t bytes, const vista_parameters *parameters,
                                   const vista_camera *camera, vista_pipeline **pipeline);

/* Forget tracks, velocity and time, as between sequences; ids go on counting. */
void vista_pipeline_reset(vista_pipeline *pipeline);

/* One frame. On an error the tracks are as before and *result is not written.
 * VISTA_ERROR_SIZE: images of another size; VISTA_ERROR_ORDER: time; VISTA_ERROR_NUMBER: pose or up not finite;
 * VISTA_ERROR_RANGE: pose without a rotation, up not of unit length; VISTA_ERROR_ARGUMENT: a null pointer. */
vista_status vista_pipeline_process(vista_pipeline *pipeline, const vista_frame *frame, vista_result *result);

#endif
