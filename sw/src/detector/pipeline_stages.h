/* What the tests and the evaluation need from inside the pipeline, by name. Internal to libvista: it may change at any
 * time. */
#ifndef VISTA_SRC_PIPELINE_STAGES_H
#define VISTA_SRC_PIPELINE_STAGES_H

#include <stdint.h>

#include "common/arena.h"
#include "follow/motion.h"
#include "follow/tracker.h"
#include "perceive/cells/affinity.h"
#include "perceive/cells/cells.h"
#include "perceive/cells/surface.h"
#include "perceive/frame_view.h"
#include "perceive/region/region.h"
#include "space/face.h"
#include "space/path_places.h"
#include "space/space_map.h"
#include "vista/detector.h"
#include "vista/directions.h"
#include "vista/obstacle.h"
#include "vista/parameters.h"
#include "vista/pipeline.h"
#include "vista/status.h"
#include "vista/types.h"

/* What the stages made of the last frame. */
typedef struct vista_pipeline_stages {
  const vista_frame_view *frame; /* without the images, which are gone */
  const vista_cells *cells;
  const vista_surfaces *surfaces;
  const vista_affinity *affinity;
  const vista_regions *regions;
  const vista_path_places *places; /* on the flight path */
  const vista_space_map *space;
  const vista_track *tracks;
  int32_t track_count;
  const vista_obstacle *obstacles; /* of the last frame */
  int32_t obstacle_count;
  const vista_face *faces; /* of the obstacles */
} vista_pipeline_stages;

vista_pipeline_stages vista_pipeline_look(const vista_pipeline *pipeline);

/* What a detector has seen. */
typedef struct vista_detector_seen {
  const vista_pipeline *pipeline; /* null: no frame was judged since the detector was made */
  vista_directions directions;    /* of the last one */
} vista_detector_seen;

const vista_detector_seen *vista_detector_look(const vista_detector *detector);

/* A partition of the last frame's cells, drawn and judged as the pipeline does with its own. */
typedef struct vista_judged_partition {
  int32_t *region_of_pixel; /* height * width, negative: none */
  const vista_regions *regions;
} vista_judged_partition;

/* Draws the boundaries of a partition along the image. region_of_cell: negative: none. The arena may only count. */
vista_status vista_pipeline_draw_partition(const vista_pipeline *pipeline, const int32_t *region_of_cell,
                                           vista_arena *arena, vista_judged_partition *drawn);

/* Draws the boundaries and judges the regions 0 .. region_count - 1, all of which are taken for grown from disparities
 * of their own. Pixels of the ground at the foot of obstacles leave region_of_pixel then. The arena may only count. */
vista_status vista_pipeline_judge_partition(const vista_pipeline *pipeline, const int32_t *region_of_cell,
                                            int32_t region_count, vista_arena *arena, vista_judged_partition *judged);

/* The first stage: what is given of a frame, how the camera has moved, and the path that it flies next. Errors are
 * those of vista_motion_update. */
vista_status vista_pipeline_begin(const vista_parameters *parameters, const vista_camera *camera,
                                  const vista_frame *given, vista_motion_state *state, vista_frame_view *frame);

/* The second half of the pipeline by itself: regions that were found in other ways, tracked and mapped. */
typedef struct vista_region_tracker vista_region_tracker;

/* max_regions: of a frame, and of tracks. *tracker is NULL while the arena counts. */
vista_status vista_region_tracker_layout(int32_t max_regions, vista_arena *arena, vista_region_tracker **tracker);

/* One frame, begun and with its words. What is nearest comes first in *obstacles, which are valid until the next call. */
vista_status vista_pipeline_track_regions(vista_region_tracker *tracker, const vista_frame_view *frame,
                                          const vista_region *regions, int32_t region_count);

const vista_obstacle *vista_region_tracker_obstacles(const vista_region_tracker *tracker, int32_t *count);
vista_nearest_collision vista_region_tracker_nearest(const vista_region_tracker *tracker);

#endif
