/* What is seen of a pair against what was seen before it: faults of cameras, engines, poses and clocks that one frame by
 * itself does not show. A detector asks it once for each pair. Internal to libvista.
 *
 * - An image, or the part of it where the flight leads, that is the same to the bit as in the pair before, while the
 *   vehicle moves, comes from a camera, a cable or a buffer that stands still: sensors have noise. What is burnt out to
 *   white says nothing, nor does an image without noise.
 * - Images that move otherwise than poses and disparities say (coherence.h).
 * - Poses that lead where the last ones do not: farther from a steady velocity than their own scatter and the acceleration
 *   of a vehicle explain, or turn so. Where the images show that the vehicle did move so, it is the acceleration of no vehicle that
 *   tells of a clock that is wrong. A pose after some that were refused or missing has to go on where they led.
 * - Times that go back, or leave a gap that is none of the source's.
 * - Whatever was placed by a pose that is not believed stays in the map and in the tracks for HELD frames; so long the
 *   frame is not healthy either. */
#ifndef VISTA_WATCH_H
#define VISTA_WATCH_H

#include <stdbool.h>
#include <stdint.h>

#include "common/arena.h"
#include "health/coherence.h"
#include "vista/parameters.h"
#include "vista/pipeline.h"
#include "vista/types.h"

/* Where the poses that were believed lead. */
typedef struct vista_watched_way {
  bool began, rated;
  bool refused, missed; /* a pose was, since the last one that was believed */
  double at_m[3], rate_m_s[3];
  double rotation[9], turn_rad_s[3];
  double rate_s; /* that the rate was measured over */
  double scatter2_m2; /* mean square of what they were off */
  int32_t scattered; /* times */
  int64_t t_ns;
} vista_watched_way;

typedef struct vista_watch {
  double radius_m; /* of the volume around the path */
  vista_camera camera;
  vista_coherence coherence;
  uint8_t *before[2]; /* rectified images of the pair before */
  bool began;
  bool had[2]; /* an image of that side was in the pair before */
  bool posed;
  vista_pose pose; /* of the pair before */
  vista_watched_way way;
  double found_share; /* of the points, where the poses said, in the newest frame with enough of them */
  double noise; /* of the camera: the most that was seen, which fades */
  bool stuck; /* part of the view was, in the pair before */
  int64_t t_ns;
  double passed_s; /* between the two pairs before */
  int32_t jumped; /* frames for which the times are still too new */
  int32_t differed; /* frames for which words that were not compared are not trusted either */
  int32_t doubted; /* frames for which the motion is still doubted */
  int32_t restarted; /* frames for which what was begun anew is too new to be relied on */
} vista_watch;

/* What is found: bit k, the reason with number k. */
typedef struct vista_watched {
  uint32_t reasons;
  vista_coherence_result coherence;
} vista_watched;

void vista_watch_layout(vista_watch *watch, vista_arena *arena, const vista_camera *camera, double radius_m);

/* Forgets what was seen. */
void vista_watch_reset(vista_watch *watch);

/* Says that a pair is older than the one before, after the reset that this calls for. */
void vista_watch_time_went_back(vista_watch *watch);

/* Says that tracks and map were forgotten. */
void vista_watch_begin_anew(vista_watch *watch);

/* Says whether words of a pair are not those of its images. Returns whether those of the pair are trusted, a few of which
 * were compared. */
bool vista_watch_words(vista_watch *watch, bool differ);

/* Takes a rectified pair, the images of which may have no data, the right one or both, the noise of the left one, and what
 * the pipeline made of the pair. */
void vista_watch_pair(vista_watch *watch, const vista_image *left, const vista_image *right, double noise,
                      const vista_result *result, int64_t t_ns, vista_watched *found);

#endif
