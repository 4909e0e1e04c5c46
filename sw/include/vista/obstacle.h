/* What libvista reports: obstacles, the nearest that the aircraft would collide with, and its own motion. */
#ifndef VISTA_OBSTACLE_H
#define VISTA_OBSTACLE_H

#include <stdbool.h>
#include <stdint.h>

#include "vista/api.h"
#include "vista/types.h"

VISTA_BEGIN

typedef struct vista_ellipse {
  double center_u_px, center_v_px;
  double axis_a_px, axis_b_px; /* semi-axes, a >= b >= 0 */
  double angle_deg;            /* of axis a, clockwise from +u as seen on the screen (v down), in (-90, 90] */
} vista_ellipse;

/* Of the static-world test: does the track stand still in the world, or does it move with the aircraft, as the image of
 * a texture that was matched one period off does? */
typedef enum vista_world_verdict {
  VISTA_WORLD_OPEN = 0, /* the aircraft has travelled too little to tell */
  VISTA_WORLD_STANDS,   /* or comes nearer: whatever it is, it is there */
  VISTA_WORLD_MOVES,    /* across the line of sight, by itself */
  VISTA_WORLD_REFUTED,  /* moves with the aircraft: the image of a periodic texture */
  VISTA_WORLD_VERDICT_COUNT
} vista_world_verdict;

/* Upper-case name of a verdict; never null. */
VISTA_API const char *vista_world_verdict_name(vista_world_verdict verdict);

/* Why a region of the image is not an obstacle; the first reason that applies, in this order. */
typedef enum vista_region_verdict {
  VISTA_REGION_ACCEPTED = 0,
  VISTA_REGION_BACKGROUND,     /* grown from no disparity of its own and not plain: sky, bare ground */
  VISTA_REGION_TOO_FEW_PIXELS, /* too few boundary inliers to say anything */
  VISTA_REGION_LOW_SUPPORT,    /* valid fraction of the boundary too small */
  VISTA_REGION_INCONSISTENT,   /* boundary disparity does not vary smoothly (edge consistency) */
  VISTA_REGION_HORIZONTAL,     /* a surface to fly above, or flat on one: ground, road, water */
  VISTA_REGION_TOO_FAR,        /* disparity below the smallest that is reconstructed */
  VISTA_REGION_TOO_SMALL,      /* metric size below the smallest obstacle */
  VISTA_REGION_VERDICT_COUNT
} vista_region_verdict;

/* Upper-case name of a verdict; never null. */
VISTA_API const char *vista_region_verdict_name(vista_region_verdict verdict);

typedef struct vista_obstacle {
  int32_t id;                /* of the track; 0: too near to match, no track */
  bool confirmed;            /* seen in M of N frames, and not refuted by the static-world test */
  bool coasting;             /* not seen in this frame: the position is a prediction */
  bool in_blind_zone;        /* nearer than the engine matches */
  vista_world_verdict world; /* of the static-world test */
  int32_t age_frames;
  double position_m[3];     /* world */
  double covariance_m2[9];  /* of position_m, row-major: the filter's, and that of errors which last */
  double distance_m;        /* from the camera */
  double extent_m[2];       /* width, height */
  vista_ellipse ellipse; /* of this frame's detection, or the last one carried on to the predicted place and range */
  double disparity_px; /* of the state in this frame */
  bool in_collision_volume; /* it may be warned of, and is in the volume around the flight path */
} vista_obstacle;

typedef struct vista_nearest_collision {
  bool valid; /* false: nothing confirmed meets the collision volume, the rest is zero */
  int32_t id;
  double position_m[3];
  double distance_m;
  double time_to_collision_s; /* distance along the flight direction / closing speed; NaN: that is below
                                 obstacle_map.closing_min_m_s, or unknown */
} vista_nearest_collision;

/* Where the camera's pose in this frame comes from. */
typedef enum vista_motion_source {
  VISTA_MOTION_UNTOLD = 0, /* no pose up to now: the world is the first camera */
  VISTA_MOTION_POSE,       /* the frame's own */
  VISTA_MOTION_STANDS,     /* no pose; the caller says that the camera has not moved since the last frame */
  VISTA_MOTION_CARRIED_ON, /* no pose, after others: the last motion goes on */
  VISTA_MOTION_REFUSED,    /* the frame's pose is out of reach: the last motion goes on */
  VISTA_MOTION_SOURCE_COUNT
} vista_motion_source;

/* Upper-case name of a source; never null. */
VISTA_API const char *vista_motion_source_name(vista_motion_source source);

/* The vehicle's own motion as the detector worked with it. */
typedef struct vista_motion {
  bool known; /* POSE or STANDS: positions in world are good; else they rest on a guess of where the camera is */
  bool restarted;                  /* the poses went on elsewhere: all tracks were given up */
  bool velocity_known;             /* else it is zero, or the last one that was known */
  vista_motion_source source;
  vista_pose pose;                 /* of the camera in world */
  double velocity_m_s[3];          /* world */
  double turn_rate_rad_s[3];       /* axis times rate, world */
  double speed_m_s;
  double direction[3]; /* of flight, unit length, world: along the velocity, else the optical axis */
  double drift_m;      /* standard deviation that this frame adds to the position, in a frame carried on */
} vista_motion;

VISTA_END

#endif
