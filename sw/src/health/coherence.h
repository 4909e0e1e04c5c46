/* Does what is seen now agree with what the frame before and the motion predict?
 *
 * Corners of the frame before that have a disparity are points in space. The poses say where the image shows them now;
 * Lucas and Kanade find where it does. What is left over is fitted robustly by seven numbers: a turn and a step that the
 * poses lack, and an offset of all disparities. A pose that jumps is seen as a turn or a step in its frame. A camera that
 * has turned in yaw, or a baseline or a speed that is told wrongly, stay as they are: the offset and the
 * velocity that the poses lack are averaged over the last seconds, with their errors. A point d px away whose disparity is off by one
 * px moves by (u - u0) t / (f B) px too much when the camera moves forward by t: by as much as a camera that looks at
 * 30 m and moves by 1 m shows in a frame.
 *
 * A camera that turns in yaw from one frame to the next changes the disparities of all points at once, beside what the
 * motion changes. That is seen in its frame, by few points, and without a motion. The jump counts as lasting until
 * they change back, or until the means say that there is no offset.
 *
 * Images that are late against their poses, or early, by whole frames show the turns that the poses had so many frames ago,
 * or will have. While the vehicle turns evenly, or not at all, nothing tells it.
 *
 * Things that move by themselves, and words matched by chance, agree on nothing and are left out. Where fewer points are
 * found than can be, the poses are so far off that nothing is found where they say. Internal to libvista. */
#ifndef VISTA_COHERENCE_H
#define VISTA_COHERENCE_H

#include <stdbool.h>
#include <stdint.h>

#include "align/row_matches.h"
#include "common/arena.h"
#include "vista/obstacle.h"
#include "vista/types.h"

#define VISTA_COHERENCE_POINTS 128
#define VISTA_COHERENCE_LASTING 4
#define VISTA_COHERENCE_TURNS 8 /* frames */

typedef struct vista_coherent_point {
  int32_t u0, v0; /* first pixel of its tile, at half the size */
  double disparity_px;
} vista_coherent_point;

/* What is known of a number. */
typedef struct vista_estimate {
  double value, sigma;
} vista_estimate;

typedef struct vista_coherence_result {
  int32_t points, asked, found, agreeing; /* of the frame before; that should be seen, are found, agree with the fit */
  int32_t chosen; /* points of this frame */
  bool fitted; /* whether enough agree for what follows */
  double turn_rad[3], step_m[3]; /* that this frame's pose lacks, in the camera */
  double turn_sigma_rad, step_sigma_m;
  vista_estimate offset_px, velocity_m_s; /* means of the last seconds: of all disparities; that the poses lack */
  double jump_px; /* by which all disparities have changed at once and not back since; 0: by nothing */
  int32_t late; /* frames: the images show the turns of poses so many frames ago */
} vista_coherence_result;

/* How the world turned in the camera from one frame to the next, by the poses and by the images. */
typedef struct vista_coherent_turn {
  double posed_rad[3], shown_rad[3], sigma_rad;
  bool shown; /* enough points agree on it */
} vista_coherent_turn;

typedef struct vista_coherence {
  vista_camera camera;
  vista_level half[2], quarter;
  int32_t newest; /* of the halves */
  int32_t count; /* points of the newest image */
  vista_coherent_point points[VISTA_COHERENCE_POINTS];
  bool posed; /* the newest image has a pose */
  vista_pose pose;
  int64_t t_ns;
  double jump_px; /* as in the result */
  int32_t turned; /* frames of those that follow, the newest first */
  vista_coherent_turn turns[VISTA_COHERENCE_TURNS];
  /* Of what lasts, which are velocity and offset: the inverse of the covariance, and that times the values. */
  double information[VISTA_COHERENCE_LASTING][VISTA_COHERENCE_LASTING], weighted[VISTA_COHERENCE_LASTING];
} vista_coherence;

void vista_coherence_layout(vista_coherence *coherence, vista_arena *arena, const vista_camera *camera);

/* Forgets everything. */
void vista_coherence_reset(vista_coherence *coherence);

/* Takes a rectified left image, its words and the motion of its frame. */
void vista_coherence_update(vista_coherence *coherence, const vista_image *left, const int16_t *words,
                            const vista_motion *motion, int64_t t_ns, vista_coherence_result *result);

#endif
