/* The vehicle's own motion: the first stage, from the frame and its own state alone.
 *
 * Velocity and turn rate are finite differences of accepted poses over the time between those two, low-passed. A frame
 * without a pose is carried on from the frame before: by the velocity that the caller states, else by the last known
 * one, and by the last turn rate. So one missing pose moves nothing: tracks stay where they are in the world.
 *
 * A pose that repeats the last one to the bit while the vehicle moves is an old one: nothing stops within a frame, and
 * no new one has come. So it counts as missing, for a second; then the vehicle does stand.
 *
 * A pose that is farther from the last one than speed_max_m_s reaches is refused, and the frame carried on likewise.
 * When restart_poses of them in a row agree with each other, the source means it: the world goes on there. Whatever was
 * placed by the old one has lost its meaning (`restarted`).
 *
 * Path: what is flown next, for the collision volume. It bends as the turn rate says, if the velocity turns as well: a
 * camera may look about on a straight path, and wind may push an aircraft aside that keeps its heading. A turn that is
 * slow and lasts is told by the mean over a longer time, in which the camera's own sway counts less. What the poses'
 * noise explains, or less than path_turn_min_deg_s, is straight. Nobody keeps to an arc for long: with c its curvature,
 * uncertain by a share path_uncertainty, it is followed up to where that is a miss of the collision radius,
 * share c s^2 / 2 = radius, and for a quarter of a circle at most. Likewise what camera and velocity turn by alike, but
 * by too little to stand out from noise: a path that may be bending is straight only up to where that matters.
 * How well its direction is known is measured: gusts and the camera's own sway move the velocity of the last moments
 * about its mean over a longer time, and over the next 15 to 40 m the path leaves it by PATH_SWAY times as much.
 *
 * Without any pose the world is the first camera, and its motion is not known; unless the caller says
 * that it stands. */
#ifndef VISTA_MOTION_H
#define VISTA_MOTION_H

#include <stdbool.h>
#include <stdint.h>

#include "common/flight_path.h"
#include "vista/obstacle.h"
#include "vista/parameters.h"
#include "vista/status.h"
#include "vista/types.h"

#define VISTA_SPEED_MIN_M_S 0.5 /* slower, the flight direction is the optical axis */

/* What the caller says of one frame. */
typedef struct vista_motion_input {
  const vista_pose *pose;     /* null: not known */
  const double *velocity_m_s; /* 3, world; null: not known */
  bool stationary;            /* without a pose: the camera has not moved since the last frame */
  int64_t t_ns;
} vista_motion_input;

/* What is kept from frame to frame; starts as zeros. */
typedef struct vista_motion_state {
  bool started;
  int64_t t_ns;     /* of the last frame */
  vista_pose pose;  /* that it was given, or carried on to */
  bool posed;       /* one was accepted: */
  int64_t posed_t_ns;
  vista_pose posed_at;
  bool repeats;     /* the last one was accepted though it repeats the one before */
  bool rates_known; /* from two accepted poses: */
  double velocity_m_s[3], turn_rate_rad_s[3]; /* world, smoothed */
  double slow_velocity_m_s[3]; /* the same velocity, smoothed over PATH_S */
  int32_t differences; /* that these are means of */
  double known_s; /* for how long */
  double velocity_variance, turn_variance; /* of a single difference around the smoothed one, each axis */
  double lag_s, slow_lag_s; /* how far the smoothed values lag behind the last difference: less in the first second */
  double averaged; /* the variance of the smoothed rates over that of a difference */
  double last_dt_s;
  int32_t refused_count; /* in a row that agree with each other; the last one of them: */
  int64_t refused_t_ns;
  vista_pose refused_at;
  double slow_turn_rate_rad_s[3]; /* the same turn rate, smoothed over PATH_S */
  double slow_averaged;           /* its variance over that of a difference */
  double sway2; /* rad^2, each axis: mean square of the angle between the two velocities, less the turn */
} vista_motion_state;

/* Updates the motion with a frame; an error changes nothing. VISTA_ERROR_ORDER: the time is not after that of the last
 * frame, which is judged first; VISTA_ERROR_NUMBER: pose or velocity not finite; VISTA_ERROR_RANGE: no rotation, a
 * velocity above speed_max_m_s. */
vista_status vista_motion_update(const vista_motion_params *params, const vista_motion_input *input,
                                 vista_motion_state *state, vista_motion *motion);

/* The path from the camera on, in world. Where it is straight it leads along motion.direction and is length_m long. */
vista_flight_path vista_motion_path(const vista_motion_state *state, const vista_motion *motion, double length_m,
                                    double radius_m);

#endif
