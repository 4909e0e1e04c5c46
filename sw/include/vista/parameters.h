/* Generated from sw/parameters.toml by scripts/make_parameters.py; do not edit. */
#ifndef VISTA_PARAMETERS_H
#define VISTA_PARAMETERS_H

#include <stddef.h>
#include <stdint.h>

#include "vista/api.h"
#include "vista/status.h"

VISTA_BEGIN

/* What is matched: the horizontal Sobel response, or the grey levels themselves (the Acadia's plain SAD). Change it to measure the paper's engine; cameras of unequal exposure need xsobel. */
typedef enum vista_stereo_prefilter { VISTA_STEREO_PREFILTER_XSOBEL, VISTA_STEREO_PREFILTER_NONE } vista_stereo_prefilter;

/* Smoothing of both images before they are matched: none, or 1 2 1 in both directions. Switch it on for cameras with noise of several grey levels. */
typedef enum vista_stereo_smooth { VISTA_STEREO_SMOOTH_OFF, VISTA_STEREO_SMOOTH_BINOMIAL3 } vista_stereo_smooth;

/* The stereo engine (its contract: doc/design/engine-contract.md). */
typedef struct vista_stereo_params {
  int32_t num_disparities; /* Candidates 0 .. num_disparities - 1, a multiple of 16. The paper's Acadia had 32; 64 halve the blind zone. More to see nearer things, fewer for a faster engine. 16 .. 256 px. */
  int32_t block_size; /* Side of the matching block, odd. Smaller for thin things in clean images, larger for noisy ones. 5 .. 21 px. */
  vista_stereo_prefilter prefilter; /* What is matched: the horizontal Sobel response, or the grey levels themselves (the Acadia's plain SAD). Change it to measure the paper's engine; cameras of unequal exposure need xsobel. */
  int32_t prefilter_cap; /* Clamp of the Sobel response. Change it to match hardware that clamps otherwise. 1 .. 63. */
  int32_t texture_threshold; /* Blocks with less texture are invalid. Raise it for noisy cameras, lower it for dull scenes. 0 .. 65535. */
  int32_t uniqueness_ratio; /* Margin of the best match over all that do not adjoin it. Raise it where repeated patterns are mismatched, lower it where too little is matched. 0 .. 100 percent. */
  int32_t lr_max_diff; /* Largest difference of the left and the right winner; -1: no left/right check. Switch it off for an engine without the check. -1 .. 255 px. */
  vista_stereo_smooth smooth; /* Smoothing of both images before they are matched: none, or 1 2 1 in both directions. Switch it on for cameras with noise of several grey levels. */
  int32_t levels; /* Levels of the image pyramid that are matched, each half the size of the one before. 1 for an engine without a pyramid; more to see nearer things. 1 .. 4. */
  int32_t rectify_rows; /* Line buffer (16, 32, 64 or 128 rows) of hardware that rectifies by a control grid; 0: exact rectification. Set it to what the hardware has. 0 .. 128 rows. */
  unsigned char reserved[216];
} vista_stereo_params;

/* The vehicle's own motion, from poses. */
typedef struct vista_motion_params {
  double velocity_smoothing_s; /* Time constant of velocity and turn rate from poses; 0: the last difference. Raise it for poses that jitter. 0.0 .. 60.0 s. */
  double speed_max_m_s; /* A pose that only a faster vehicle could have reached is refused. Set it to what the vehicle can reach. 1.0 .. 10000.0 m/s. */
  double drift_m_s; /* Error of the velocity over which a frame without a pose is carried on; adds to the uncertainty of all tracks. Set it to how far the vehicle's velocity is known. 0.0 .. 100.0 m/s. */
  unsigned char reserved[232];
} vista_motion_params;

/* Log-polar grid (paper, section II-B). */
typedef struct vista_foveation_params {
  int32_t sector_count; /* Sectors of the log-polar grid; rings grow by exp(2*pi/sector_count), which keeps cells square. More to segment finer, fewer for a slower computer. 16 .. 256. */
  double rho_0_px; /* Radius of the hub, the one cell at the centre. Change it with the resolution of the camera. Paper: rho_0. 1.0 .. 64.0 px. */
  unsigned char reserved[240];
} vista_foveation_params;

/* How the feature terms combine: their weighted sum is the paper's equation 3, their product measures better. Change it to measure the paper as printed. */
typedef enum vista_affinity_form { VISTA_AFFINITY_FORM_PRODUCT, VISTA_AFFINITY_FORM_SUM } vista_affinity_form;

/* Capacity = scale * C^((w - 1) / 2), or the paper's print, scale * (w + 1) / 2. Change it to measure the paper as printed. */
typedef enum vista_affinity_flow_encoding { VISTA_AFFINITY_FLOW_ENCODING_EXPONENTIAL, VISTA_AFFINITY_FLOW_ENCODING_LINEAR } vista_affinity_flow_encoding;

/* Similarity of neighbouring cells (paper, equations 3 and 4) and its encoding as flow (equation 5). */
typedef struct vista_affinity_params {
  vista_affinity_form form; /* How the feature terms combine: their weighted sum is the paper's equation 3, their product measures better. Change it to measure the paper as printed. */
  double sigma_intensity; /* Scale of the intensity term. Raise it for images of high contrast, lower it for dull ones. Paper: sigma_d. 0.1 .. 255.0 grey levels. */
  double mu_disparity_px; /* Disparity difference that still counts as none between adjoining cells. Change it with the noise of the engine's disparities. Paper: mu_d. 0.0 .. 16.0 px. */
  double mu_depth_m; /* A disparity difference that means less depth than this counts as none: near things have relief. At most 6 % of the range. Change it with the relief of what is flown at. Paper: mu_d. 0.0 .. 10.0 m. */
  double sigma_disparity_px; /* Scale of the disparity term. Change it with the noise of the engine's disparities. Paper: sigma_d. 0.05 .. 64.0 px. */
  vista_affinity_flow_encoding flow_encoding; /* Capacity = scale * C^((w - 1) / 2), or the paper's print, scale * (w + 1) / 2. Change it to measure the paper as printed. */
  unsigned char reserved[212];
} vista_affinity_params;

/* What divides the free cells around a seed: the paper's minimum cut, or a maximum spanning forest of the same links. Change it to measure what the cuts are worth. */
typedef enum vista_segmentation_solver { VISTA_SEGMENTATION_SOLVER_CUT, VISTA_SEGMENTATION_SOLVER_FOREST } vista_segmentation_solver;

/* Recursive minimum cuts (paper, section II-C). */
typedef struct vista_segmentation_params {
  double seed_step_px; /* Largest disparity step inside a seed between adjoining cells. Raise it for an engine whose disparities step or are noisy. 0.05 .. 8.0 px. */
  double seed_area_px2; /* Smallest seed that is cut out. Lower it to look for smaller things, raise it for noisy images. 1.0 .. 1000000.0 px2. */
  int32_t reach; /* A cut can take free cells less than this many steps from its seed. Raise it where large things have no texture; it costs time. 1 .. 1000 cells. */
  double horizontal_link; /* Sink link of a cell on a horizontal surface. Raise it where obstacles take in the ground before them. Paper: D_p. 0.0 .. 100.0 flow_scale. */
  double merge_ratio; /* Edges across the boundary of two regions that step by less than this are smooth. Lower it where things are joined that stand one behind another. 0.0 .. 100.0 seed steps. */
  vista_segmentation_solver solver; /* What divides the free cells around a seed: the paper's minimum cut, or a maximum spanning forest of the same links. Change it to measure what the cuts are worth. */
  unsigned char reserved[212];
} vista_segmentation_params;

/* Statistics of the regions and the tests that make obstacles of them (paper, section II-D). */
typedef struct vista_region_params {
  double min_disparity_px; /* Regions with less are too far to say anything. Lower it to see farther, with more false alarms. 0.1 .. 255.0 px. */
  double min_size_m; /* Smallest larger side of an obstacle. At most 6 % of the range. Lower it to warn of smaller things, with more false alarms. 0.0 .. 100.0 m. */
  double min_inlier_fraction; /* Edge consistency: part of the valid boundary pixels on one surface from which on the boundary speaks no more against an obstacle. Raise it against false alarms by chance matches, lower it where true things are refused. 0.0 .. 1.0. */
  double min_height_m; /* What is lower than this above the horizontal surface that it adjoins lies on it. At most 6 % of the range. Set it to what the vehicle may fly over. 0.01 .. 10.0 m. */
  double odds_prior; /* Log-odds of a region that is an obstacle, before anything is known of it. Raise it to miss less, lower it to warn less. -100.0 .. 100.0 ln odds. */
  unsigned char reserved[216];
} vista_region_params;

/* Regions to detections by linear triangulation (paper, section II-D). */
typedef struct vista_reconstruction_params {
  double disparity_sigma_px; /* Noise of the boundary disparity that no averaging removes. Set it to the noise of another engine or camera. 0.01 .. 16.0 px. */
  unsigned char reserved[248];
} vista_reconstruction_params;

/* One extended Kalman filter an obstacle, in the inertial frame (paper, section II-D). */
typedef struct vista_tracker_params {
  double velocity_sigma_m_s; /* Prior of an obstacle's velocity, each axis: obstacles are mostly static. Raise it where most things move slowly. 0.001 .. 100.0 m/s. */
  double moving_sigma_m_s; /* Prior of the velocity of what moves, each axis: of a track seen once whose next detection no track explains as standing. Set it to the speed of what else flies or drives. 0.0 .. 1000.0 m/s. */
  double attitude_sigma_deg; /* Error of the pose's attitude, each axis; adds to the noise of u and v. Set it to the accuracy of the navigation filter. 0.0 .. 10.0 deg. */
  double gate_chi2; /* Mahalanobis gate in (u, v, d): chi-square with 3 degrees of freedom, 11.34 holds 99 percent. Widen it when tracks break off, narrow it when they are mixed up. 0.1 .. 1000.0. */
  int32_t confirm_hits; /* A track is confirmed at this many hits in confirm_window frames; at one more while own travel could tell, but does not yet, that it stands. Fewer warn sooner, more warn less often of nothing. Paper: M. 1 .. 32 frames. At most confirm_window. */
  int32_t confirm_window; /* Frames, in which the track could be seen, that count for its confirmation. Change it with the frame rate. Paper: N. 1 .. 32 frames. */
  int32_t miss_max; /* Misses in a row that a confirmed track survives. Change it with the frame rate. 0 .. 1000 frames. */
  double range_max_m; /* Farther detections start no track. Set it to the range that the camera pair tells well. 1.0 .. 100000.0 m. */
  unsigned char reserved[200];
} vista_tracker_params;

/* Something in the way that is too near to match: texture without disparity. */
typedef struct vista_blind_zone_params {
  int32_t confirm_hits; /* It is reported when it was so in this many of confirm_window frames. Fewer warn sooner, more warn less often of nothing. Paper: M. 1 .. 32 frames. At most confirm_window. */
  int32_t confirm_window; /* Frames that count for that. Change it with the frame rate. Paper: N. 1 .. 32 frames. */
  unsigned char reserved[248];
} vista_blind_zone_params;

/* Obstacles against the flight path (paper, section II-D; companion). */
typedef struct vista_obstacle_map_params {
  double collision_radius_m; /* Radius of the collision volume around the flight path. Set it to half the vehicle's span and the clearance that it needs. 0.01 .. 1000.0 m. */
  double collision_length_m; /* Length of the collision volume, from the camera. Set it to how far ahead a warning is of use. 0.1 .. 100000.0 m. */
  double inflation_sigma; /* Standard deviations of the bearing that are added to an obstacle's semi-axes. Raise it to keep clear of what is uncertain, 0 to warn of the best estimate alone. 0.0 .. 10.0. */
  double meet_s; /* What flies and moves across the flight path is in the collision volume as soon as it and the aircraft will meet within this time. Raise it for a vehicle that is slow to react to what flies. 0.0 .. 60.0 s. */
  double thickness_ratio; /* The middle of a thing lies this share of half its width behind the surface that is seen, uncertain by as much: 0 for a board, 1 for a ball. Its width counts up to twice its height, and up to 1 m. Change it for a world of boards or of balls. 0.0 .. 1.0. */
  double path_sigmas; /* The collision volume is narrower by so many standard deviations of how far the aircraft may leave its path, down to half its radius: what is beside its rim far ahead is passed as often as not. 0 to warn of all that may be in the way, more to warn of less. 0.0 .. 10.0 sigma of the flight path. */
  unsigned char reserved[208];
} vista_obstacle_map_params;

/* Limits below which a view tells too little. */
typedef struct vista_health_params {
  double degraded_fraction; /* A frame is degraded when less than this of the pixels that can be matched has a disparity; in a noisy image one that another one, a block away, agrees with. Change it with the camera and the scene. 0.0 .. 1.0. */
  double blind_fraction; /* With less than this it is blind. Change it with the camera and the scene. 0.0 .. 1.0. At most degraded_fraction. */
  double contrast_min; /* It is blind, too, when the standard deviation of the cells' grey levels is smaller, without what is left of the image's noise. Change it with the camera's exposure. 0.0 .. 255.0 grey levels. */
  double noise_min; /* An image with more noise than this is noisy: chance matches part of it, and only disparities that agree with others count. Set it to the noise from which the camera's disparities are no longer good. 0.0 .. 255.0 grey levels. */
  double ground_fraction; /* A frame is degraded, too, when less than this of what is below the horizon has a disparity where the flight leads to, as wide as the collision volume 30 m ahead: something that cannot be matched hides the ground. 0: never. Switch it off over water or snow. 0.0 .. 1.0. */
  unsigned char reserved[216];
} vista_health_params;

/* The words of all pyramid levels, filtered and put together (extension of the paper). */
typedef struct vista_words_params {
  int32_t cluster_px; /* Words that hang together and cover less, in pixels of their level, are dropped; 0: none are. Raise it for noisy cameras, lower it for small images. 0 .. 1000000 px. */
  int32_t filling_levels; /* As many coarser levels fill surfaces where the finer ones have no word; the others only add what is too near for level 0. Raise it where large surfaces have little texture. 0 .. 3. */
  unsigned char reserved[248];
} vista_words_params;

/* Ground that the flight path meets (extension of the paper). */
typedef struct vista_terrain_params {
  double angle_min_deg; /* The path meets the ground when it descends on it at this angle at least; at less it is flown along. Raise it for a vehicle that lands or follows terrain. 0.1 .. 90.0 deg. */
  double clearance_share; /* The collision volume reaches down by this share of the distance from the ground's surface at most: who flies low along it is no nearer to hitting it. Lower it to fly lower without warnings. 0.0 .. 1.0. */
  unsigned char reserved[240];
} vista_terrain_params;

/* Whether wires and thin poles are looked for. Switch it off to save time where there are none. */
typedef enum vista_thin_find { VISTA_THIN_FIND_OFF, VISTA_THIN_FIND_ON } vista_thin_find;

/* Thin things, found at the resolution of the image: wires, thin poles (extension of the paper). */
typedef struct vista_thin_params {
  vista_thin_find find; /* Whether wires and thin poles are looked for. Switch it off to save time where there are none. */
  double contrast; /* Contrast of a thin line to both of its sides that counts in full; more counts no more. Lower it for dull cameras, raise it against false lines. 3.5 .. 63.0 grey levels. */
  unsigned char reserved[240];
} vista_thin_params;

/* How the host works; no result depends on it. */
typedef struct vista_host_params {
  int32_t threads; /* With 2, a second thread takes part in every frame; vista_pipeline_destroy ends it. Set it to 2 where a second core is free. 1 .. 2 threads. */
  unsigned char reserved[252];
} vista_host_params;

/* Whose rules the messages follow: OBSTACLE_DISTANCE with unknown sectors, or OBSTACLE_DISTANCE_3D and silence. Set it to what flies. */
typedef enum vista_mavlink_autopilot { VISTA_MAVLINK_AUTOPILOT_PX4, VISTA_MAVLINK_AUTOPILOT_ARDUPILOT } vista_mavlink_autopilot;

/* 72 sectors of 5 degrees, or 36 of 10 for versions of PX4 whose own map has 36: of 72 these read every second one only. Set it as the receiver expects it. */
typedef enum vista_mavlink_sectors { VISTA_MAVLINK_SECTORS_72, VISTA_MAVLINK_SECTORS_36 } vista_mavlink_sectors;

/* What an autopilot is told: vista mavlink, vista/mavlink.h. */
typedef struct vista_mavlink_params {
  vista_mavlink_autopilot autopilot; /* Whose rules the messages follow: OBSTACLE_DISTANCE with unknown sectors, or OBSTACLE_DISTANCE_3D and silence. Set it to what flies. */
  int32_t system_id; /* That of the aircraft. Set it as the autopilot has it. 1 .. 255. */
  int32_t component_id; /* Of the detector; 196 is obstacle avoidance. Change it when another component has it. 1 .. 255. */
  double mount_roll_deg; /* How the left camera hangs in the aircraft, turned by yaw first, then by pitch, then by roll. Roll: to the right. Set it as the camera is mounted. -180.0 .. 180.0 deg. */
  double mount_pitch_deg; /* Upwards from level. Set it as the camera is mounted. -90.0 .. 90.0 deg. */
  double mount_yaw_deg; /* To the right from forward. Set it as the camera is mounted. -180.0 .. 180.0 deg. */
  double min_distance_m; /* What is nearer, or too near to match, is reported at this distance, never at 0. Set it as the autopilot's sensor is set up. 0.05 .. 100.0 m. At most max_distance_m. */
  double max_distance_m; /* What is farther is not reported. Clear means: seen to be free up to here, which is at most obstacle_map.collision_length_m. Set it as the autopilot's sensor is set up. 1.0 .. 655.0 m. */
  double half_height_m; /* Sectors are about what reaches into the slice so far above and below the height of the camera. Set it to the vehicle's height and the clearance that it needs. 0.0 .. 1000.0 m. */
  vista_mavlink_sectors sectors; /* 72 sectors of 5 degrees, or 36 of 10 for versions of PX4 whose own map has 36: of 72 these read every second one only. Set it as the receiver expects it. */
  double angle_offset_deg; /* Where the middle of sector 0 is, to the right from forward: a multiple of a sector. Some receivers ignore it. Set it as the receiver expects it. -180.0 .. 180.0 deg. */
  double stale_s; /* A frame that is older tells nothing any more. Change it with the frame rate and the delay of the link. 0.05 .. 0.5 s. */
  unsigned char reserved[168];
} vista_mavlink_params;

/* Whether the right image is rectified anew when its rows no longer match those of the left one. Switch it on for a rig that may bend. */
typedef enum vista_alignment_correct { VISTA_ALIGNMENT_CORRECT_OFF, VISTA_ALIGNMENT_CORRECT_ON } vista_alignment_correct;

/* Correction of the right camera's turn against its calibration, in flight, from the rows of matched features. */
typedef struct vista_alignment_params {
  vista_alignment_correct correct; /* Whether the right image is rectified anew when its rows no longer match those of the left one. Switch it on for a rig that may bend. */
  double pitch_max_deg; /* A larger turn about the camera's x axis is not corrected: an alarm is raised. A vertical shift of its image counts as pitch. Set it to what the rig may bend by. 0.05 .. 2.0 deg. */
  double roll_max_deg; /* The same of a turn about the optical axis. Set it to what the rig may bend by. 0.05 .. 2.0 deg. */
  unsigned char reserved[232];
} vista_alignment_params;

/* Whose manoeuvres are flown. A multirotor ends them in a stop, a fixed wing in a circle. Set it to what flies. */
typedef enum vista_plan_vehicle { VISTA_PLAN_VEHICLE_MULTIROTOR, VISTA_PLAN_VEHICLE_FIXED_WING } vista_plan_vehicle;

/* The planner (vista/plan.h). The space that it keeps clear is obstacle_map.collision_radius_m wide. */
typedef struct vista_plan_params {
  vista_plan_vehicle vehicle; /* Whose manoeuvres are flown. A multirotor ends them in a stop, a fixed wing in a circle. Set it to what flies. */
  double acceleration_max_m_s2; /* A multirotor speeds up, brakes and turns with this at most. Set it to what the vehicle follows with some reserve for wind. 0.5 .. 50.0 m/s^2. */
  double climb_max_m_s; /* Climbs and descents are no faster. Set it to what the vehicle can do; 0: it evades to the sides alone. 0.0 .. 50.0 m/s. */
  double bank_max_deg; /* A fixed wing turns with this at most. Set it to what the vehicle holds without losing height. 10.0 .. 75.0 deg. */
  unsigned char reserved[224];
} vista_plan_params;

/* All parameters. vista_parameters_default makes the struct; change its members afterwards. A newer library
 * keeps its new parameters behind those of this header and in the reserved parts, and fills them in there. */
typedef struct vista_parameters {
  size_t struct_bytes; /* size of this struct in the caller's header */
  vista_stereo_params stereo;
  vista_motion_params motion;
  vista_foveation_params foveation;
  vista_affinity_params affinity;
  vista_segmentation_params segmentation;
  vista_region_params region;
  vista_reconstruction_params reconstruction;
  vista_tracker_params tracker;
  vista_blind_zone_params blind_zone;
  vista_obstacle_map_params obstacle_map;
  vista_health_params health;
  vista_words_params words;
  vista_terrain_params terrain;
  vista_thin_params thin;
  vista_host_params host;
  vista_mavlink_params mavlink;
  vista_alignment_params alignment;
  vista_plan_params plan;
} vista_parameters;

/* Writes the defaults into a struct of this size. VISTA_ERROR_SIZE: it is no size of this struct. */
VISTA_API vista_status vista_parameters_init(vista_parameters *parameters, size_t bytes);

/* Returns the default of every parameter. */
static inline vista_parameters vista_parameters_default(void) {
  vista_parameters parameters;
  (void)vista_parameters_init(&parameters, sizeof parameters);
  return parameters;
}

/* Checks every parameter against its range. VISTA_ERROR_SIZE: the struct was not made by
 * vista_parameters_default. VISTA_ERROR_RANGE: a parameter is out of its range or not a number; `culprit`,
 * which may be null, is then set to its "section.name". */
VISTA_API vista_status vista_parameters_check(const vista_parameters *parameters, const char **culprit);

/* Sets the parameter called "section.name"; a choice is set by its number. VISTA_ERROR_RANGE: there is no
 * such parameter, or no parameter can have this value. vista_parameters_check judges its own range. */
VISTA_API vista_status vista_parameters_set(vista_parameters *parameters, const char *name, double value);

/* Sets a choice by its name. VISTA_ERROR_RANGE: there is no such parameter or no such choice. */
VISTA_API vista_status vista_parameters_set_choice(vista_parameters *parameters, const char *name,
                                                   const char *choice);

/* Reads the parameter called "section.name"; a choice is read as its number. */
VISTA_API vista_status vista_parameters_get(const vista_parameters *parameters, const char *name,
                                            double *value);

/* The type of a parameter. */
typedef enum vista_parameter_type {
  VISTA_PARAMETER_INT,
  VISTA_PARAMETER_FLOAT,
  VISTA_PARAMETER_CHOICE
} vista_parameter_type;

/* The description of one parameter. Its texts are never null. */
typedef struct vista_parameter {
  const char *name; /* "section.name" */
  const char *unit, *doc;
  vista_parameter_type type;
  double default_value, min, max; /* for a choice: numbers */
  const char *at_most;            /* another parameter that it must not exceed, or "" */
  int32_t choice_count;
  const char *const *choices; /* choice_count names */
} vista_parameter;

/* The number of parameters. */
VISTA_API int32_t vista_parameter_count(void);

/* The description of a parameter by its index, in the order of the struct; null outside 0 .. count - 1. */
VISTA_API const vista_parameter *vista_parameter_info(int32_t index);

VISTA_END

#endif
