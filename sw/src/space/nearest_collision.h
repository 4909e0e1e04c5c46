/* Where the flight path meets an obstacle, how far away that is, and how long it takes (obstacle_map.h). */
#ifndef VISTA_NEAREST_COLLISION_H
#define VISTA_NEAREST_COLLISION_H

#include <stdbool.h>
#include <stdint.h>

#include "follow/tracker.h"
#include "perceive/frame_view.h"
#include "vista/obstacle.h"
#include "vista/types.h"

/* Whether the pixels of a track have shown where the path meets it, and it is so large that this counts: by its extent,
 * or by its last detection, because an extent that was first that of a part takes long to grow. */
bool vista_track_is_touched(const vista_frame_view *frame, const vista_track *track);

/* The collision with an obstacle. A large one is met in its surface, not in the middle behind that. track: NULL for an
 * obstacle that has none and stands still. */
vista_nearest_collision vista_nearest_collision_with(const vista_frame_view *frame, const vista_obstacle *obstacle,
                                                     const vista_track *track);

/* Widens the covariance across the line of sight. What is in the way at the same range may be another part of one
 * thing, such as the posts of a fence or of a sign: which of them is met first is as uncertain as they are apart. */
void vista_nearest_collision_allow_for_parts(const vista_pose *pose, const vista_obstacle *obstacles, int32_t count,
                                             vista_nearest_collision *nearest);

#endif
