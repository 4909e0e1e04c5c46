/* A track as an obstacle of the map (obstacle_map.h): where its middle is, how well that is known, and whether it is in
 * the collision volume. */
#ifndef VISTA_TRACK_OBSTACLE_H
#define VISTA_TRACK_OBSTACLE_H

#include <stdbool.h>

#include "follow/tracker.h"
#include "perceive/frame_view.h"
#include "vista/obstacle.h"

/* The obstacle where it is now: in the collision volume if its own pixels or its disc are. False: the track is behind the
 * camera. */
bool vista_track_obstacle(const vista_frame_view *frame, const vista_track *track, vista_obstacle *obstacle);

/* Whether a thing in front of the camera is seen to move so that it will be in the volume soon, or meet the aircraft. */
bool vista_track_enters(const vista_frame_view *frame, const vista_track *track);

/* Whether it may fly into the way of the aircraft, by what is known of its motion: enough for the path not to be free. */
bool vista_track_may_enter(const vista_frame_view *frame, const vista_track *track);

#endif
