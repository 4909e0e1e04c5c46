/* Detections to tracks: one extended Kalman filter an obstacle, in the inertial frame with known pose (paper, II-D).
 *
 * State      x = (position, velocity) in world, nearly constant velocity with a small prior (obstacles are mostly
 *            static) and white acceleration noise. Width and height: one scalar filter each, on the logarithm.
 * Measurement z = (u, v, d) of the current camera: p = R^T (position - t), u = u0 + f X/Z, v = v0 + f Y/Z,
 *            d = f B/Z. Joseph-form update.
 * Association in global assignments over what the one before left over:
 *            confirmed tracks with the detections in their Mahalanobis gate, both in (u, v, d) linearised at the track
 *            and in space linearised at the detection: close to the camera the former accepts anything;
 *            confirmed tracks with detections inside their extent at their depth: the region changed its shape, so
 *            its centre counts as uncertain by half the extent;
 *            tentative tracks with the detections in their gate. A newborn never takes a confirmed track's detection;
 *            last, tracks seen once with detections of the same size where they may have moved to by now. Such a pair
 *            starts one more track, whose velocity is that of the two; it takes nothing from what stands.
 * Life       a detection that nothing claims starts a tentative track, unless it lies within a confirmed one (a split
 *            region). Confirmed at M hits in the last N frames in which it could be seen, one
 *            hit more while the static-world test is open, both moved_hits more if it moves; a tentative track that can
 *            no longer get there, or lies within a confirmed one, is dropped; so is a confirmed one after more than
 *            miss_max misses in a row.
 * Credible   once the static-world test holds it to stand still or to move by itself, until it refutes that; where own
 *            travel tells nothing (a still camera, hovering) once confirmed.
 * Followed   a credible track without a detection whose face shows words, most of them of its own disparity, is seen:
 *            what is near falls into several regions. Their mean corrects its range. For follow_s after its last
 *            detection, or while it may be in the way until it is passed: then no region having it tells against it.
 * Held       a credible track whose face shows too few words is not blamed for hold_s: a frame without light, a part
 *            without texture. Any track is not, until own travel has moved its disparity by hold_px: half way between
 *            two whole disparities the engine may find nothing of it. One that was told by its outline alone never
 *            shows words: it coasts as in the blind zone.
 * Released   words of something else, behind it or before it, are misses.
 * Unseen     nearer than the engine matches (the blind zone), a track is not blamed for a miss: it coasts until it is
 *            behind the camera or for blind_zone_s. Outside the matched part of the image, too, if it may be in the
 *            way; else for out_of_view_s: what passes beside the path is of no more use.
 *            May be in the way: in the collision volume in one of its last three hits, and credible.
 * Duplicates two confirmed tracks, each centred within the other: the older one stays.
 * Overflow   with the table full, the least certain tentative track (fewest hits, then largest position variance)
 *            makes room for a more certain newborn; else the newborn is dropped. Either is counted. */
#ifndef VISTA_TRACKER_H
#define VISTA_TRACKER_H

#include <stdbool.h>
#include <stdint.h>

#include "common/arena.h"
#include "follow/static_world.h"
#include "perceive/frame_view.h"
#include "perceive/region/reconstruction.h"
#include "vista/obstacle.h"
#include "vista/status.h"

#define VISTA_VOLUME_PIXELS 8 /* a region is in the collision volume when at least this many of its pixels are */
/* A track nearer than the engine matches coasts for this long, unless it is passed before. */
#define VISTA_BLIND_ZONE_S 30.0
#define VISTA_HOLD_S 0.3 /* a track whose place shows no words coasts for this long before it counts as missed */
#define VISTA_TRACKER_MAX 4096 /* tracks, detections */

typedef struct vista_track {
  int32_t id; /* from 1; used again only after 2^31 tracks, and never of one that lives */
  bool confirmed;      /* M of N: it is tracked */
  bool credible;       /* and it does not move with the aircraft (static_world.h): it may be warned of */
  bool moved;          /* started from two detections as something that moves: confirmed by more hits */
  bool coasting;       /* not seen in this frame: the state is a prediction */
  bool followed;       /* seen by the words at its place alone: there was no detection */
  bool held;           /* coasting in view, and the engine's words show nothing there: it may still be there */
  bool in_view;        /* predicted inside the matched part of the image */
  bool in_blind_zone;  /* predicted nearer than the engine matches, and in view when it came so near */
  bool plain;          /* once told by its outline alone (region.h) */
  bool unrepeated;     /* its last detection is no image of a texture (reconstruction.h) */
  double lasting_sigma_m; /* of its range, by an error of its detections that is the same in each frame */
  bool edges_only;     /* plain, and this frame's detection is not: parts of its outline, as it leaves the image */
  int32_t label;       /* of the region in this frame; -1 without a detection */
  int32_t age_frames;  /* updates since its birth, that one included */
  int32_t hits;        /* detections in all */
  int32_t misses;      /* in a row; only frames in which it could be seen count */
  int32_t seen_frames; /* frames in which it was seen or could have been */
  uint32_t window;     /* the last 32 of these, bit 0 the newest, 1 = hit */
  uint32_t volume_window; /* the last 32 hits, bit 0 the newest, 1 = in the collision volume by volume_pixels;
                             those of edges only, which do not tell what is between them, are left out */
  bool met;               /* the collision volume touched it in one of its hits; there: */
  double met_m[3];        /* world */
  double met_sigma_m;     /* of its range */
  int64_t hit_t_ns;    /* last detection */
  int64_t seen_t_ns;   /* last detection, or frame in which it was followed */
  int64_t visible_t_ns; /* last frame in which it could be seen */
  double position_m[3];   /* world */
  double velocity_m_s[3]; /* world */
  double covariance[36];  /* of (position, velocity), row-major, symmetric; m^2, m^2/s, m^2/s^2 */
  double extent_m[2];     /* width, height */
  double extent_variance[2]; /* of the natural logarithm of extent_m */
  /* The scatter of the last VISTA_SCATTER_HITS detections; u, v, d: */
  double scatter_px2[3]; /* mean square of what they differed by from the prediction */
  double lasting_px2[3]; /* mean product of two such differences in a row: what lasts in them */
  double off_px[3];      /* the last one */
  double expected_px2[3]; /* what the noise of the detections and of the prediction would have the scatter be */
  vista_static_world world;
  vista_ellipse ellipse; /* of the last detection */
  double ellipse_depth_m; /* camera z at that detection */
  double seen_off_m[3]; /* world: from the position to the middle of that ellipse, at the depth of the position */
} vista_track;

#define VISTA_SCATTER_HITS 10.0 /* of which the means of a track's scatter are */

typedef struct vista_tracker vista_tracker;

/* *tracker is NULL while the arena counts. VISTA_ERROR_RANGE: a capacity outside 1..VISTA_TRACKER_MAX. */
vista_status vista_tracker_layout(int32_t max_tracks, int32_t max_detections, vista_arena *arena,
                                  vista_tracker **tracker);

/* Forget all tracks and the time; ids go on counting. */
void vista_tracker_reset(vista_tracker *tracker);

/* One frame. Without words no track is held. On any error nothing is changed.
 * VISTA_ERROR_ORDER: its time is not after that of the last update; VISTA_ERROR_NUMBER: a detection is not finite;
 * VISTA_ERROR_RANGE: a disparity, sigma or extent is not positive; VISTA_ERROR_CAPACITY: more than max_detections. */
vista_status vista_tracker_update(vista_tracker *tracker, const vista_frame_view *frame,
                                  const vista_detections *detections);

/* All live tracks, oldest first; valid until the next update. */
const vista_track *vista_tracker_tracks(const vista_tracker *tracker, int32_t *count);

/* Tracks lost because the table was full, newborns included, since the layout or the last reset. */
int64_t vista_tracker_dropped(const vista_tracker *tracker);

#endif
