#include "detector/pipeline_stages.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include "common/frame.h"
#include "common/matched_area.h"
#include "follow/tracker.h"
#include "perceive/region/reconstruction.h"
#include "space/obstacle_map.h"

/* ---- the first stage ---- */

static vista_matched_area matched_area(const vista_stereo_params *stereo, int32_t levels) {
  const int32_t radius = (stereo->block_size - 1) / 2;
  return (vista_matched_area){.disparity_max_px = (stereo->num_disparities - 1) << (levels - 1),
                              .margin_left_px = stereo->num_disparities - 1 + radius,
                              .margin_px = radius,
                              .coarser_levels = levels - 1};
}

/* Finds the direction up in camera coordinates, R^T up_world. False: no pose tells how the camera hangs; it is taken to
 * be level. */
/* Every row of the image that stands for one that was not given. */
static const uint8_t black[VISTA_MOST_IMAGE_PX];

static bool up_in_camera(const vista_motion *motion, const double *up_world, double up[3]) {
  static const double level[3] = {0.0, -1.0, 0.0};
  const bool known = up_world != NULL && motion->source != VISTA_MOTION_UNTOLD;
  if (known)
    vista_frame_direction_to_camera(&motion->pose, up_world, up);
  else
    memcpy(up, level, sizeof level);
  return known;
}

vista_status vista_pipeline_begin(const vista_parameters *parameters, const vista_camera *camera,
                                  const vista_frame *given, vista_motion_state *state, vista_frame_view *frame) {
  vista_frame_view f = {.params = parameters,
                        .camera = camera,
                        .t_ns = given->t_ns,
                        .image = given->image,
                        .seen = given->image.data != NULL,
                        .levels = {given->disparity}};
  if (!f.seen) f.image = (vista_image){black, camera->width_px, camera->height_px, 0};
  int32_t levels = 1;
  for (; levels <= VISTA_COARSER_LEVELS && given->coarser[levels - 1].data != NULL; ++levels)
    f.levels[levels] = given->coarser[levels - 1];
  f.matched = matched_area(&parameters->stereo, levels);
  const vista_motion_input input = {given->pose, given->velocity_m_s, given->stationary, given->t_ns};
  const vista_status status = vista_motion_update(&parameters->motion, &input, state, &f.motion);
  if (status != VISTA_OK) return status;
  f.up_known = up_in_camera(&f.motion, given->up_world, f.up_camera);
  f.path = vista_motion_path(state, &f.motion, parameters->obstacle_map.collision_length_m,
                             parameters->obstacle_map.collision_radius_m);
  *frame = f;
  return VISTA_OK;
}

/* ---- regions that were found in other ways ---- */

struct vista_region_tracker {
  vista_detections detections;
  vista_tracker *tracker;
  vista_obstacle_map *map;
};

vista_status vista_region_tracker_layout(int32_t max_regions, vista_arena *arena, vista_region_tracker **tracker) {
  *tracker = NULL;
  vista_region_tracker *const made = vista_arena_take(arena, 1, sizeof *made);
  vista_region_tracker parts = {.detections.capacity = max_regions};
  parts.detections.items = vista_arena_take(arena, (size_t)max_regions, sizeof(vista_detection));
  vista_status status = vista_tracker_layout(max_regions, max_regions, arena, &parts.tracker);
  if (status == VISTA_OK) status = vista_obstacle_map_layout(max_regions, arena, &parts.map);
  if (status != VISTA_OK || arena->base == NULL) return status;
  *made = parts;
  *tracker = made;
  return VISTA_OK;
}

vista_status vista_pipeline_track_regions(vista_region_tracker *tracker, const vista_frame_view *frame,
                                          const vista_region *regions, int32_t region_count) {
  vista_status status = vista_reconstruct_regions(frame, regions, region_count, &tracker->detections);
  if (status != VISTA_OK) return status;
  if (frame->motion.restarted) vista_tracker_reset(tracker->tracker);
  status = vista_tracker_update(tracker->tracker, frame, &tracker->detections);
  if (status != VISTA_OK) return status;
  vista_map_input input = {0};
  input.tracks = vista_tracker_tracks(tracker->tracker, &input.track_count);
  vista_obstacle_map_update(tracker->map, frame, &input);
  return VISTA_OK;
}

const vista_obstacle *vista_region_tracker_obstacles(const vista_region_tracker *tracker, int32_t *count) {
  return vista_obstacle_map_obstacles(tracker->map, count);
}

vista_nearest_collision vista_region_tracker_nearest(const vista_region_tracker *tracker) {
  return vista_obstacle_map_nearest(tracker->map);
}
