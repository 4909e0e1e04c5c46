/* Tracks to the obstacle map: what the control system gets (paper, section II-D; obstacles.jsonl).
 *
 * Collision volume: the points within radius_m of the path that is flown next, straight or an arc (motion.h).
 * Time to collision: along the path, over the speed at which the obstacle comes nearer along it.
 * Covariance: the filter takes the errors of a region for white, and averages them out. Part of them lasts as long as
 * the thing is in view: the matcher's bias, a region that wanders (what its detections have in common from one to the
 * next), the end of a long thing that the region lacks. That part is added to the filter's covariance,
 * J diag(lasting^2) J^T as in reconstruction, not fed into it.
 * Position: of the middle, thickness_ratio of half the width behind the surface that is seen, uncertain by as much.
 * What is long and low is no deeper than twice its height, and what is large no deeper than 1 m.
 * Too near to match (blind_zone.h): an obstacle without a track, id 0, on the flight path somewhere within the
 * blind zone, as wide as the volume. It is given at the far end of the zone, with the zone's length as uncertainty. It
 * never hides a track: while one in the volume is seen in this frame, the view is not blocked, and the nearest
 * collision is with the track. When all of them coast beyond the zone, what is too near to match may be what hides
 * them. Either way both are obstacles in the volume.
 * Ground (terrain.h): an obstacle without a track, id -1, where the volume meets it; what lies on it is no collision of
 * its own.
 * Membership: an obstacle that is seen, by the pixels of its region (collision_volume.h) in two of its last three
 * hits, or in its only one. Without a detection it stays a member as far as its disc does.
 * Entering: what is seen to move across the path, with at most one miss since, is a member, too, when its disc will be
 * within half a second.
 * Disc: an elliptical one facing the camera, semi-axes extent / 2 + inflation_sigma times the standard deviation
 * of its bearing at its depth. Only across the line of sight: the range uncertainty of a far obstacle moves it along
 * its line of sight and would put misses into the volume; it is reported in the covariance instead.
 * Places (path_places.h): what is in the way has to be borne out by a place on the path, at which the frames, the tracks
 * and the ground together say that something is there. Where they do and no track stands for it, there is an obstacle
 * without a track, id -2.
 * Nearest collision: the place that the path meets. Of what is large it is where the words of its region touch the
 * volume (collision_volume.h); where they have not told, and of what is small, it is put together from the middle and
 * the extent. Its covariance is that of the obstacle, and of which point of it, or of its parts, is met first; along the
 * line of sight that of those words, where they have told. */
#ifndef VISTA_OBSTACLE_MAP_H
#define VISTA_OBSTACLE_MAP_H

#include <stdint.h>

#include "common/arena.h"
#include "follow/tracker.h"
#include "perceive/frame_view.h"
#include "perceive/terrain/terrain.h"
#include "perceive/words/blind_zone.h"
#include "space/face.h"
#include "space/path_places.h"
#include "space/space_map.h"
#include "vista/obstacle.h"
#include "vista/status.h"

typedef struct vista_obstacle_map vista_obstacle_map;

/* *map is NULL while the arena counts. VISTA_ERROR_RANGE: max_tracks outside 1..VISTA_TRACKER_MAX. */
vista_status vista_obstacle_map_layout(int32_t max_tracks, vista_arena *arena, vista_obstacle_map **map);

/* Forget all obstacles. */
void vista_obstacle_map_reset(vista_obstacle_map *map);

/* What the map is made of. */
typedef struct vista_map_input {
  const vista_track *tracks;
  int32_t track_count;                /* max_tracks at most */
  const vista_terrain *terrain;       /* NULL: not known */
  const vista_blind_zone *blind_zone; /* NULL: not known */
  const vista_space_map *space;
  vista_path_places *places; /* looked at in this frame; NULL: not known */
} vista_map_input;

/* Makes the map of a frame, after the tracker's update. */
void vista_obstacle_map_update(vista_obstacle_map *map, const vista_frame_view *frame, const vista_map_input *input);

/* In front of the camera only, nearest first (then by id); valid until the next update. */
const vista_obstacle *vista_obstacle_map_obstacles(const vista_obstacle_map *map, int32_t *count);
const vista_face *vista_obstacle_map_faces(const vista_obstacle_map *map); /* of these, in their order */
vista_nearest_collision vista_obstacle_map_nearest(const vista_obstacle_map *map);

/* How far the path is free: as far as its places are, no farther than the nearest collision, nor than what flies and may
 * meet the aircraft. 0: the places are not known. */
double vista_obstacle_map_free_m(const vista_obstacle_map *map);

#endif
