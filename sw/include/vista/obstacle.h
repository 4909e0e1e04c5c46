/* What libvista reports: obstacles, the nearest that the aircraft would collide with, its own motion and health. */
#ifndef VISTA_OBSTACLE_H
#define VISTA_OBSTACLE_H

#include <stdbool.h>
#include <stdint.h>

#include "vista/api.h"
#include "vista/types.h"

VISTA_BEGIN

/* An ellipse in the rectified left image. */
typedef struct vista_ellipse {
  double center_u_px, center_v_px;
  double axis_a_px, axis_b_px; /* semi-axes, a >= b >= 0 */
  double angle_deg; /* direction of axis a, clockwise from +u as seen on the screen (v down), in (-90, 90] */
} vista_ellipse;

/* The verdict of the static-world test: does the track stand still in the world, or does it move with the aircraft, as
 * the image of a texture does that is matched one texture period off? */
typedef enum vista_world_verdict {
  VISTA_WORLD_OPEN = 0, /* the aircraft has travelled too little to tell */
  VISTA_WORLD_STANDS, /* or comes nearer: whatever it is, it is there */
  VISTA_WORLD_MOVES, /* across the line of sight, by itself */
  VISTA_WORLD_REFUTED, /* moves with the aircraft: the image of a periodic texture */
  VISTA_WORLD_VERDICT_COUNT
} vista_world_verdict;

/* The name of a verdict, in upper case; never null. */
VISTA_API const char *vista_world_verdict_name(vista_world_verdict verdict);

/* Why a region of the image is not an obstacle: the first reason that applies, in this order. */
typedef enum vista_region_verdict {
  VISTA_REGION_ACCEPTED = 0,
  VISTA_REGION_UNKNOWN, /* hardly any disparity in it: it cannot be judged. Sky, bare walls and roads, dark places */
  VISTA_REGION_TOO_FEW_PIXELS, /* too few boundary inliers to say anything */
  VISTA_REGION_INCONSISTENT, /* the evidence against it outweighs that for it: disparities matched by chance */
  VISTA_REGION_HORIZONTAL, /* a surface to fly above, or flat on one: ground, road, water */
  VISTA_REGION_TOO_FAR, /* disparity below the smallest that is reconstructed */
  VISTA_REGION_TOO_SMALL, /* metric size below the smallest obstacle */
  VISTA_REGION_VERDICT_COUNT
} vista_region_verdict;

/* The name of a verdict, in upper case; never null. */
VISTA_API const char *vista_region_verdict_name(vista_region_verdict verdict);

/* What an obstacle is. */
typedef enum vista_obstacle_kind {
  VISTA_OBSTACLE_THING = 0, /* something that stands on the ground or flies; it has a track */
  VISTA_OBSTACLE_TOO_NEAR,  /* something too near to match; id VISTA_ID_TOO_NEAR */
  VISTA_OBSTACLE_GROUND,    /* the ground, where the flight path meets it; id VISTA_ID_GROUND */
  VISTA_OBSTACLE_PLACE,     /* something on the flight path that no track stands for; id VISTA_ID_PLACE */
  VISTA_OBSTACLE_KIND_COUNT
} vista_obstacle_kind;

/* Ids of obstacles that have no track. There is at most one of each in a frame. */
#define VISTA_ID_TOO_NEAR 0
#define VISTA_ID_GROUND (-1)
#define VISTA_ID_PLACE (-2)

/* The name of a kind, in lower case, such as "ground"; never null. */
VISTA_API const char *vista_obstacle_kind_name(vista_obstacle_kind kind);

/* One obstacle, as the track that it belongs to estimates it in this frame. */
typedef struct vista_obstacle {
  int32_t id; /* number of the track, from 1; VISTA_ID_TOO_NEAR, VISTA_ID_GROUND or VISTA_ID_PLACE without one */
  bool confirmed; /* seen in M of N frames, and not refuted by the static-world test */
  bool coasting; /* not seen in this frame: the position is a prediction */
  bool in_blind_zone; /* nearer than the engine matches */
  vista_world_verdict world; /* verdict of the static-world test */
  int32_t age_frames;
  double position_m[3]; /* of the thing's middle, in the world; obstacle_map.thickness_ratio tells how far that is
                           behind the surface that is seen */
  double covariance_m2[9]; /* of position_m, row-major; includes errors that last while the obstacle is in view */
  double distance_m; /* of position_m from the camera */
  double extent_m[2]; /* width, height */
  vista_ellipse ellipse; /* of this frame's detection; while coasting, of the last one, where that is by now */
  double disparity_px; /* at the estimated position */
  bool in_collision_volume; /* it can cause a warning and is in the volume around the flight path, or about to enter */
  vista_obstacle_kind kind; /* of ground, position_m is the point that the volume meets first, extent_m twice the width
                               of the volume there, and the height under which that part of the slope is seen; of a
                               place, position_m is the middle of what was matched there, extent_m the volume's width */
} vista_obstacle;

/* The nearest confirmed obstacle that meets the collision volume. */
typedef struct vista_nearest_collision {
  bool valid; /* false: there is none, and all other members are zero */
  int32_t id;
  double position_m[3]; /* that the path meets; of what is up to 3 m large, half way from its middle to that point */
  double distance_m; /* of position_m from the camera */
  double time_to_collision_s; /* distance along the flight direction over closing speed; NaN if that speed is below
                                 0.5 m/s, or unknown */
  double covariance_m2[9]; /* of position_m, row-major: that of the obstacle, and of which point of it is met first */
} vista_nearest_collision;

/* The source of the camera's pose in this frame. */
typedef enum vista_motion_source {
  VISTA_MOTION_UNTOLD = 0, /* no pose so far: the world is the camera of the first frame */
  VISTA_MOTION_POSE, /* the frame has a pose */
  VISTA_MOTION_STANDS, /* no pose; the caller says that the camera has not moved since the last frame */
  VISTA_MOTION_CARRIED_ON, /* no pose, but earlier frames had one: the last motion goes on */
  VISTA_MOTION_REFUSED, /* the pose of the frame is impossible: the last motion goes on */
  VISTA_MOTION_SOURCE_COUNT
} vista_motion_source;

/* The name of a source, in upper case; never null. */
VISTA_API const char *vista_motion_source_name(vista_motion_source source);

/* The vehicle's own motion as the detector worked with it. */
typedef struct vista_motion {
  bool known; /* true for POSE and STANDS; otherwise positions in the world rest on a guess of the camera's pose */
  bool restarted; /* the poses continued at another place, so all tracks were dropped */
  bool velocity_known; /* otherwise the velocity is zero, or the last one that was known */
  vista_motion_source source;
  vista_pose pose; /* of the camera in the world */
  double velocity_m_s[3]; /* in the world */
  double turn_rate_rad_s[3]; /* axis times rate, in the world */
  double speed_m_s;
  double direction[3]; /* of flight, unit length, world: along the velocity if it is known, else the optical axis */
  double drift_m; /* standard deviation that this frame adds to the position while the last motion goes on */
} vista_motion;

/* Whether the view tells anything. An empty list of obstacles means "clear" only in a frame that is healthy. */
typedef enum vista_health_state {
  VISTA_HEALTH_HEALTHY = 0,
  VISTA_HEALTH_DEGRADED, /* seen in part, or at a place that rests on a guess */
  VISTA_HEALTH_BLIND, /* the view tells nothing; tracks are carried on */
  VISTA_HEALTH_STATE_COUNT
} vista_health_state;

/* What was found wrong with a frame. */
typedef enum vista_health_reason {
  VISTA_HEALTH_FEW_DISPARITIES = 0, /* fewer of the matched pixels than health.degraded_fraction have one */
  VISTA_HEALTH_NO_DISPARITIES, /* fewer than health.blind_fraction: blind */
  VISTA_HEALTH_NO_CONTRAST, /* the image varies by less than health.contrast_min: blind */
  VISTA_HEALTH_MOTION_UNKNOWN, /* no pose, after others */
  VISTA_HEALTH_POSE_JUMP, /* the pose was refused, or believed anew: motion.restarted */
  VISTA_HEALTH_NOISE, /* noise above health.noise_min, and too few disparities that another one agrees with */
  VISTA_HEALTH_GROUND_UNSEEN, /* fewer than health.ground_fraction where the flight leads to, below the horizon */
  VISTA_HEALTH_ALIGNMENT_LOST, /* the cameras are turned against each other by more than is corrected, or unknown: given
                                  by vista_alignment_judge, not by the pipeline */
  VISTA_HEALTH_ROWS_MISALIGNED, /* matching features lie apart in rows: given by vista_alignment_judge, too */
  /* Given by vista/detector.h, which sees pairs and what was seen before them: */
  VISTA_HEALTH_IMAGES_FROZEN, /* an image is the one of the pair before, while the vehicle moves: blind */
  VISTA_HEALTH_VIEW_STUCK, /* where the flight leads, part of an image is as it was, while the vehicle moves */
  VISTA_HEALTH_MOMENTS_DIFFER, /* the rows of features of both images agree on no turn of the cameras: blind */
  VISTA_HEALTH_WORDS_DIFFER, /* words from elsewhere are not those of the images */
  VISTA_HEALTH_MOTION_DOUBTFUL, /* the image moves otherwise than the poses say */
  VISTA_HEALTH_DISPARITIES_OFF, /* disparities do not change as the motion says: a turn in yaw, or a wrong baseline */
  VISTA_HEALTH_TIME_JUMP, /* the times went back, or far ahead: what was seen before is of no use */
  VISTA_HEALTH_CROWDED, /* more things are seen than are followed: the farthest were left out */
  VISTA_HEALTH_IMAGE_MISSING, /* words came without an image: what only an image tells is not judged */
  VISTA_HEALTH_REASON_COUNT
} vista_health_reason;

/* How far a frame can be trusted. */
typedef struct vista_health {
  vista_health_state state;
  uint32_t reasons; /* bit k: the reason with number k */
  double matched_fraction; /* of the pixels where the engine can find a disparity, those that have one */
  double contrast; /* standard deviation of the cells, grey levels, without the noise that is left in them */
} vista_health;

/* The name of a state, in lower case, such as "blind"; never null. */
VISTA_API const char *vista_health_state_name(vista_health_state state);

/* The name of a reason, in lower case, such as "no_contrast"; never null. */
VISTA_API const char *vista_health_reason_name(vista_health_reason reason);

/* A reason as one line of text; never null. */
VISTA_API const char *vista_health_reason_text(vista_health_reason reason);

VISTA_END

#endif
