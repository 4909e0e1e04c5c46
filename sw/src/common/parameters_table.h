/* Generated from sw/parameters.toml by scripts/make_parameters.py; do not edit. */
#ifndef VISTA_SRC_PARAMETERS_TABLE_H
#define VISTA_SRC_PARAMETERS_TABLE_H

#include <stddef.h>

#include "vista/parameters.h"

static const char *const stereo_prefilter_choices[] = {"xsobel", "none"};
static const char *const stereo_smooth_choices[] = {"off", "binomial3"};
static const char *const affinity_form_choices[] = {"product", "sum"};
static const char *const affinity_flow_encoding_choices[] = {"exponential", "linear"};
static const char *const segmentation_solver_choices[] = {"cut", "forest"};
static const char *const thin_find_choices[] = {"off", "on"};
static const char *const mavlink_autopilot_choices[] = {"px4", "ardupilot"};
static const char *const mavlink_sectors_choices[] = {"72", "36"};
static const char *const alignment_correct_choices[] = {"off", "on"};
static const char *const plan_vehicle_choices[] = {"multirotor", "fixed_wing"};

static const struct {
  vista_parameter info;
  size_t offset; /* in vista_parameters */
} parameter_table[] = {
    {{"stereo.num_disparities", "px", "Candidates 0 .. num_disparities - 1, a multiple of 16. The paper's Acadia had 32; 64 halve the blind zone. More to see nearer things, fewer for a faster engine.", VISTA_PARAMETER_INT, 64, 16, 256, "", 0, NULL}, offsetof(vista_parameters, stereo.num_disparities)},
    {{"stereo.block_size", "px", "Side of the matching block, odd. Smaller for thin things in clean images, larger for noisy ones.", VISTA_PARAMETER_INT, 11, 5, 21, "", 0, NULL}, offsetof(vista_parameters, stereo.block_size)},
    {{"stereo.prefilter", "", "What is matched: the horizontal Sobel response, or the grey levels themselves (the Acadia's plain SAD). Change it to measure the paper's engine; cameras of unequal exposure need xsobel.", VISTA_PARAMETER_CHOICE, 0, 0, 1, "", 2, stereo_prefilter_choices}, offsetof(vista_parameters, stereo.prefilter)},
    {{"stereo.prefilter_cap", "", "Clamp of the Sobel response. Change it to match hardware that clamps otherwise.", VISTA_PARAMETER_INT, 31, 1, 63, "", 0, NULL}, offsetof(vista_parameters, stereo.prefilter_cap)},
    {{"stereo.texture_threshold", "", "Blocks with less texture are invalid. Raise it for noisy cameras, lower it for dull scenes.", VISTA_PARAMETER_INT, 10, 0, 65535, "", 0, NULL}, offsetof(vista_parameters, stereo.texture_threshold)},
    {{"stereo.uniqueness_ratio", "percent", "Margin of the best match over all that do not adjoin it. Raise it where repeated patterns are mismatched, lower it where too little is matched.", VISTA_PARAMETER_INT, 15, 0, 100, "", 0, NULL}, offsetof(vista_parameters, stereo.uniqueness_ratio)},
    {{"stereo.lr_max_diff", "px", "Largest difference of the left and the right winner; -1: no left/right check. Switch it off for an engine without the check.", VISTA_PARAMETER_INT, 1, -1, 255, "", 0, NULL}, offsetof(vista_parameters, stereo.lr_max_diff)},
    {{"stereo.smooth", "", "Smoothing of both images before they are matched: none, or 1 2 1 in both directions. Switch it on for cameras with noise of several grey levels.", VISTA_PARAMETER_CHOICE, 0, 0, 1, "", 2, stereo_smooth_choices}, offsetof(vista_parameters, stereo.smooth)},
    {{"stereo.levels", "", "Levels of the image pyramid that are matched, each half the size of the one before. 1 for an engine without a pyramid; more to see nearer things.", VISTA_PARAMETER_INT, 3, 1, 4, "", 0, NULL}, offsetof(vista_parameters, stereo.levels)},
    {{"stereo.rectify_rows", "rows", "Line buffer (16, 32, 64 or 128 rows) of hardware that rectifies by a control grid; 0: exact rectification. Set it to what the hardware has.", VISTA_PARAMETER_INT, 0, 0, 128, "", 0, NULL}, offsetof(vista_parameters, stereo.rectify_rows)},
    {{"motion.velocity_smoothing_s", "s", "Time constant of velocity and turn rate from poses; 0: the last difference. Raise it for poses that jitter.", VISTA_PARAMETER_FLOAT, 0.3, 0.0, 60.0, "", 0, NULL}, offsetof(vista_parameters, motion.velocity_smoothing_s)},
    {{"motion.speed_max_m_s", "m/s", "A pose that only a faster vehicle could have reached is refused. Set it to what the vehicle can reach.", VISTA_PARAMETER_FLOAT, 150.0, 1.0, 10000.0, "", 0, NULL}, offsetof(vista_parameters, motion.speed_max_m_s)},
    {{"motion.drift_m_s", "m/s", "Error of the velocity over which a frame without a pose is carried on; adds to the uncertainty of all tracks. Set it to how far the vehicle's velocity is known.", VISTA_PARAMETER_FLOAT, 0.5, 0.0, 100.0, "", 0, NULL}, offsetof(vista_parameters, motion.drift_m_s)},
    {{"foveation.sector_count", "", "Sectors of the log-polar grid; rings grow by exp(2*pi/sector_count), which keeps cells square. More to segment finer, fewer for a slower computer.", VISTA_PARAMETER_INT, 128, 16, 256, "", 0, NULL}, offsetof(vista_parameters, foveation.sector_count)},
    {{"foveation.rho_0_px", "px", "Radius of the hub, the one cell at the centre. Change it with the resolution of the camera.", VISTA_PARAMETER_FLOAT, 4.0, 1.0, 64.0, "", 0, NULL}, offsetof(vista_parameters, foveation.rho_0_px)},
    {{"affinity.form", "", "How the feature terms combine: their weighted sum is the paper's equation 3, their product measures better. Change it to measure the paper as printed.", VISTA_PARAMETER_CHOICE, 0, 0, 1, "", 2, affinity_form_choices}, offsetof(vista_parameters, affinity.form)},
    {{"affinity.sigma_intensity", "grey levels", "Scale of the intensity term. Raise it for images of high contrast, lower it for dull ones.", VISTA_PARAMETER_FLOAT, 10.0, 0.1, 255.0, "", 0, NULL}, offsetof(vista_parameters, affinity.sigma_intensity)},
    {{"affinity.mu_disparity_px", "px", "Disparity difference that still counts as none between adjoining cells. Change it with the noise of the engine's disparities.", VISTA_PARAMETER_FLOAT, 0.5, 0.0, 16.0, "", 0, NULL}, offsetof(vista_parameters, affinity.mu_disparity_px)},
    {{"affinity.mu_depth_m", "m", "A disparity difference that means less depth than this counts as none: near things have relief. At most 6 % of the range. Change it with the relief of what is flown at.", VISTA_PARAMETER_FLOAT, 0.5, 0.0, 10.0, "", 0, NULL}, offsetof(vista_parameters, affinity.mu_depth_m)},
    {{"affinity.sigma_disparity_px", "px", "Scale of the disparity term. Change it with the noise of the engine's disparities.", VISTA_PARAMETER_FLOAT, 1.0, 0.05, 64.0, "", 0, NULL}, offsetof(vista_parameters, affinity.sigma_disparity_px)},
    {{"affinity.flow_encoding", "", "Capacity = scale * C^((w - 1) / 2), or the paper's print, scale * (w + 1) / 2. Change it to measure the paper as printed.", VISTA_PARAMETER_CHOICE, 0, 0, 1, "", 2, affinity_flow_encoding_choices}, offsetof(vista_parameters, affinity.flow_encoding)},
    {{"segmentation.seed_step_px", "px", "Largest disparity step inside a seed between adjoining cells. Raise it for an engine whose disparities step or are noisy.", VISTA_PARAMETER_FLOAT, 0.5, 0.05, 8.0, "", 0, NULL}, offsetof(vista_parameters, segmentation.seed_step_px)},
    {{"segmentation.seed_area_px2", "px2", "Smallest seed that is cut out. Lower it to look for smaller things, raise it for noisy images.", VISTA_PARAMETER_FLOAT, 60.0, 1.0, 1000000.0, "", 0, NULL}, offsetof(vista_parameters, segmentation.seed_area_px2)},
    {{"segmentation.reach", "cells", "A cut can take free cells less than this many steps from its seed. Raise it where large things have no texture; it costs time.", VISTA_PARAMETER_INT, 12, 1, 1000, "", 0, NULL}, offsetof(vista_parameters, segmentation.reach)},
    {{"segmentation.horizontal_link", "flow_scale", "Sink link of a cell on a horizontal surface. Raise it where obstacles take in the ground before them.", VISTA_PARAMETER_FLOAT, 0.3, 0.0, 100.0, "", 0, NULL}, offsetof(vista_parameters, segmentation.horizontal_link)},
    {{"segmentation.merge_ratio", "seed steps", "Edges across the boundary of two regions that step by less than this are smooth. Lower it where things are joined that stand one behind another.", VISTA_PARAMETER_FLOAT, 2.0, 0.0, 100.0, "", 0, NULL}, offsetof(vista_parameters, segmentation.merge_ratio)},
    {{"segmentation.solver", "", "What divides the free cells around a seed: the paper's minimum cut, or a maximum spanning forest of the same links. Change it to measure what the cuts are worth.", VISTA_PARAMETER_CHOICE, 0, 0, 1, "", 2, segmentation_solver_choices}, offsetof(vista_parameters, segmentation.solver)},
    {{"region.min_disparity_px", "px", "Regions with less are too far to say anything. Lower it to see farther, with more false alarms.", VISTA_PARAMETER_FLOAT, 2.5, 0.1, 255.0, "", 0, NULL}, offsetof(vista_parameters, region.min_disparity_px)},
    {{"region.min_size_m", "m", "Smallest larger side of an obstacle. At most 6 % of the range. Lower it to warn of smaller things, with more false alarms.", VISTA_PARAMETER_FLOAT, 0.35, 0.0, 100.0, "", 0, NULL}, offsetof(vista_parameters, region.min_size_m)},
    {{"region.min_inlier_fraction", "", "Edge consistency: part of the valid boundary pixels on one surface from which on the boundary speaks no more against an obstacle. Raise it against false alarms by chance matches, lower it where true things are refused.", VISTA_PARAMETER_FLOAT, 0.2, 0.0, 1.0, "", 0, NULL}, offsetof(vista_parameters, region.min_inlier_fraction)},
    {{"region.min_height_m", "m", "What is lower than this above the horizontal surface that it adjoins lies on it. At most 6 % of the range. Set it to what the vehicle may fly over.", VISTA_PARAMETER_FLOAT, 0.3, 0.01, 10.0, "", 0, NULL}, offsetof(vista_parameters, region.min_height_m)},
    {{"region.odds_prior", "ln odds", "Log-odds of a region that is an obstacle, before anything is known of it. Raise it to miss less, lower it to warn less.", VISTA_PARAMETER_FLOAT, -2.2, -100.0, 100.0, "", 0, NULL}, offsetof(vista_parameters, region.odds_prior)},
    {{"reconstruction.disparity_sigma_px", "px", "Noise of the boundary disparity that no averaging removes. Set it to the noise of another engine or camera.", VISTA_PARAMETER_FLOAT, 0.12, 0.01, 16.0, "", 0, NULL}, offsetof(vista_parameters, reconstruction.disparity_sigma_px)},
    {{"tracker.velocity_sigma_m_s", "m/s", "Prior of an obstacle's velocity, each axis: obstacles are mostly static. Raise it where most things move slowly.", VISTA_PARAMETER_FLOAT, 0.5, 0.001, 100.0, "", 0, NULL}, offsetof(vista_parameters, tracker.velocity_sigma_m_s)},
    {{"tracker.moving_sigma_m_s", "m/s", "Prior of the velocity of what moves, each axis: of a track seen once whose next detection no track explains as standing. Set it to the speed of what else flies or drives.", VISTA_PARAMETER_FLOAT, 6.0, 0.0, 1000.0, "", 0, NULL}, offsetof(vista_parameters, tracker.moving_sigma_m_s)},
    {{"tracker.attitude_sigma_deg", "deg", "Error of the pose's attitude, each axis; adds to the noise of u and v. Set it to the accuracy of the navigation filter.", VISTA_PARAMETER_FLOAT, 0.05, 0.0, 10.0, "", 0, NULL}, offsetof(vista_parameters, tracker.attitude_sigma_deg)},
    {{"tracker.gate_chi2", "", "Mahalanobis gate in (u, v, d): chi-square with 3 degrees of freedom, 11.34 holds 99 percent. Widen it when tracks break off, narrow it when they are mixed up.", VISTA_PARAMETER_FLOAT, 11.34, 0.1, 1000.0, "", 0, NULL}, offsetof(vista_parameters, tracker.gate_chi2)},
    {{"tracker.confirm_hits", "frames", "A track is confirmed at this many hits in confirm_window frames; at one more while own travel could tell, but does not yet, that it stands. Fewer warn sooner, more warn less often of nothing.", VISTA_PARAMETER_INT, 4, 1, 32, "tracker.confirm_window", 0, NULL}, offsetof(vista_parameters, tracker.confirm_hits)},
    {{"tracker.confirm_window", "frames", "Frames, in which the track could be seen, that count for its confirmation. Change it with the frame rate.", VISTA_PARAMETER_INT, 6, 1, 32, "", 0, NULL}, offsetof(vista_parameters, tracker.confirm_window)},
    {{"tracker.miss_max", "frames", "Misses in a row that a confirmed track survives. Change it with the frame rate.", VISTA_PARAMETER_INT, 4, 0, 1000, "", 0, NULL}, offsetof(vista_parameters, tracker.miss_max)},
    {{"tracker.range_max_m", "m", "Farther detections start no track. Set it to the range that the camera pair tells well.", VISTA_PARAMETER_FLOAT, 150.0, 1.0, 100000.0, "", 0, NULL}, offsetof(vista_parameters, tracker.range_max_m)},
    {{"blind_zone.confirm_hits", "frames", "It is reported when it was so in this many of confirm_window frames. Fewer warn sooner, more warn less often of nothing.", VISTA_PARAMETER_INT, 3, 1, 32, "blind_zone.confirm_window", 0, NULL}, offsetof(vista_parameters, blind_zone.confirm_hits)},
    {{"blind_zone.confirm_window", "frames", "Frames that count for that. Change it with the frame rate.", VISTA_PARAMETER_INT, 5, 1, 32, "", 0, NULL}, offsetof(vista_parameters, blind_zone.confirm_window)},
    {{"obstacle_map.collision_radius_m", "m", "Radius of the collision volume around the flight path. Set it to half the vehicle's span and the clearance that it needs.", VISTA_PARAMETER_FLOAT, 2.0, 0.01, 1000.0, "", 0, NULL}, offsetof(vista_parameters, obstacle_map.collision_radius_m)},
    {{"obstacle_map.collision_length_m", "m", "Length of the collision volume, from the camera. Set it to how far ahead a warning is of use.", VISTA_PARAMETER_FLOAT, 100.0, 0.1, 100000.0, "", 0, NULL}, offsetof(vista_parameters, obstacle_map.collision_length_m)},
    {{"obstacle_map.inflation_sigma", "", "Standard deviations of the bearing that are added to an obstacle's semi-axes. Raise it to keep clear of what is uncertain, 0 to warn of the best estimate alone.", VISTA_PARAMETER_FLOAT, 1.0, 0.0, 10.0, "", 0, NULL}, offsetof(vista_parameters, obstacle_map.inflation_sigma)},
    {{"obstacle_map.meet_s", "s", "What flies and moves across the flight path is in the collision volume as soon as it and the aircraft will meet within this time. Raise it for a vehicle that is slow to react to what flies.", VISTA_PARAMETER_FLOAT, 3.0, 0.0, 60.0, "", 0, NULL}, offsetof(vista_parameters, obstacle_map.meet_s)},
    {{"obstacle_map.thickness_ratio", "", "The middle of a thing lies this share of half its width behind the surface that is seen, uncertain by as much: 0 for a board, 1 for a ball. Its width counts up to twice its height, and up to 1 m. Change it for a world of boards or of balls.", VISTA_PARAMETER_FLOAT, 0.5, 0.0, 1.0, "", 0, NULL}, offsetof(vista_parameters, obstacle_map.thickness_ratio)},
    {{"obstacle_map.path_sigmas", "sigma of the flight path", "The collision volume is narrower by so many standard deviations of how far the aircraft may leave its path, down to half its radius: what is beside its rim far ahead is passed as often as not. 0 to warn of all that may be in the way, more to warn of less.", VISTA_PARAMETER_FLOAT, 0.25, 0.0, 10.0, "", 0, NULL}, offsetof(vista_parameters, obstacle_map.path_sigmas)},
    {{"health.degraded_fraction", "", "A frame is degraded when less than this of the pixels that can be matched has a disparity; in a noisy image one that another one, a block away, agrees with. Change it with the camera and the scene.", VISTA_PARAMETER_FLOAT, 0.1, 0.0, 1.0, "", 0, NULL}, offsetof(vista_parameters, health.degraded_fraction)},
    {{"health.blind_fraction", "", "With less than this it is blind. Change it with the camera and the scene.", VISTA_PARAMETER_FLOAT, 0.02, 0.0, 1.0, "health.degraded_fraction", 0, NULL}, offsetof(vista_parameters, health.blind_fraction)},
    {{"health.contrast_min", "grey levels", "It is blind, too, when the standard deviation of the cells' grey levels is smaller, without what is left of the image's noise. Change it with the camera's exposure.", VISTA_PARAMETER_FLOAT, 2.0, 0.0, 255.0, "", 0, NULL}, offsetof(vista_parameters, health.contrast_min)},
    {{"health.noise_min", "grey levels", "An image with more noise than this is noisy: chance matches part of it, and only disparities that agree with others count. Set it to the noise from which the camera's disparities are no longer good.", VISTA_PARAMETER_FLOAT, 6.0, 0.0, 255.0, "", 0, NULL}, offsetof(vista_parameters, health.noise_min)},
    {{"health.ground_fraction", "", "A frame is degraded, too, when less than this of what is below the horizon has a disparity where the flight leads to, as wide as the collision volume 30 m ahead: something that cannot be matched hides the ground. 0: never. Switch it off over water or snow.", VISTA_PARAMETER_FLOAT, 0.2, 0.0, 1.0, "", 0, NULL}, offsetof(vista_parameters, health.ground_fraction)},
    {{"words.cluster_px", "px", "Words that hang together and cover less, in pixels of their level, are dropped; 0: none are. Raise it for noisy cameras, lower it for small images.", VISTA_PARAMETER_INT, 150, 0, 1000000, "", 0, NULL}, offsetof(vista_parameters, words.cluster_px)},
    {{"words.filling_levels", "", "As many coarser levels fill surfaces where the finer ones have no word; the others only add what is too near for level 0. Raise it where large surfaces have little texture.", VISTA_PARAMETER_INT, 0, 0, 3, "", 0, NULL}, offsetof(vista_parameters, words.filling_levels)},
    {{"terrain.angle_min_deg", "deg", "The path meets the ground when it descends on it at this angle at least; at less it is flown along. Raise it for a vehicle that lands or follows terrain.", VISTA_PARAMETER_FLOAT, 2.5, 0.1, 90.0, "", 0, NULL}, offsetof(vista_parameters, terrain.angle_min_deg)},
    {{"terrain.clearance_share", "", "The collision volume reaches down by this share of the distance from the ground's surface at most: who flies low along it is no nearer to hitting it. Lower it to fly lower without warnings.", VISTA_PARAMETER_FLOAT, 0.8, 0.0, 1.0, "", 0, NULL}, offsetof(vista_parameters, terrain.clearance_share)},
    {{"thin.find", "", "Whether wires and thin poles are looked for. Switch it off to save time where there are none.", VISTA_PARAMETER_CHOICE, 1, 0, 1, "", 2, thin_find_choices}, offsetof(vista_parameters, thin.find)},
    {{"thin.contrast", "grey levels", "Contrast of a thin line to both of its sides that counts in full; more counts no more. Lower it for dull cameras, raise it against false lines.", VISTA_PARAMETER_FLOAT, 8.0, 3.5, 63.0, "", 0, NULL}, offsetof(vista_parameters, thin.contrast)},
    {{"host.threads", "threads", "With 2, a second thread takes part in every frame; vista_pipeline_destroy ends it. Set it to 2 where a second core is free.", VISTA_PARAMETER_INT, 1, 1, 2, "", 0, NULL}, offsetof(vista_parameters, host.threads)},
    {{"mavlink.autopilot", "", "Whose rules the messages follow: OBSTACLE_DISTANCE with unknown sectors, or OBSTACLE_DISTANCE_3D and silence. Set it to what flies.", VISTA_PARAMETER_CHOICE, 0, 0, 1, "", 2, mavlink_autopilot_choices}, offsetof(vista_parameters, mavlink.autopilot)},
    {{"mavlink.system_id", "", "That of the aircraft. Set it as the autopilot has it.", VISTA_PARAMETER_INT, 1, 1, 255, "", 0, NULL}, offsetof(vista_parameters, mavlink.system_id)},
    {{"mavlink.component_id", "", "Of the detector; 196 is obstacle avoidance. Change it when another component has it.", VISTA_PARAMETER_INT, 196, 1, 255, "", 0, NULL}, offsetof(vista_parameters, mavlink.component_id)},
    {{"mavlink.mount_roll_deg", "deg", "How the left camera hangs in the aircraft, turned by yaw first, then by pitch, then by roll. Roll: to the right. Set it as the camera is mounted.", VISTA_PARAMETER_FLOAT, 0.0, -180.0, 180.0, "", 0, NULL}, offsetof(vista_parameters, mavlink.mount_roll_deg)},
    {{"mavlink.mount_pitch_deg", "deg", "Upwards from level. Set it as the camera is mounted.", VISTA_PARAMETER_FLOAT, 0.0, -90.0, 90.0, "", 0, NULL}, offsetof(vista_parameters, mavlink.mount_pitch_deg)},
    {{"mavlink.mount_yaw_deg", "deg", "To the right from forward. Set it as the camera is mounted.", VISTA_PARAMETER_FLOAT, 0.0, -180.0, 180.0, "", 0, NULL}, offsetof(vista_parameters, mavlink.mount_yaw_deg)},
    {{"mavlink.min_distance_m", "m", "What is nearer, or too near to match, is reported at this distance, never at 0. Set it as the autopilot's sensor is set up.", VISTA_PARAMETER_FLOAT, 0.3, 0.05, 100.0, "mavlink.max_distance_m", 0, NULL}, offsetof(vista_parameters, mavlink.min_distance_m)},
    {{"mavlink.max_distance_m", "m", "What is farther is not reported. Clear means: seen to be free up to here, which is at most obstacle_map.collision_length_m. Set it as the autopilot's sensor is set up.", VISTA_PARAMETER_FLOAT, 40.0, 1.0, 655.0, "", 0, NULL}, offsetof(vista_parameters, mavlink.max_distance_m)},
    {{"mavlink.half_height_m", "m", "Sectors are about what reaches into the slice so far above and below the height of the camera. Set it to the vehicle's height and the clearance that it needs.", VISTA_PARAMETER_FLOAT, 2.0, 0.0, 1000.0, "", 0, NULL}, offsetof(vista_parameters, mavlink.half_height_m)},
    {{"mavlink.sectors", "", "72 sectors of 5 degrees, or 36 of 10 for versions of PX4 whose own map has 36: of 72 these read every second one only. Set it as the receiver expects it.", VISTA_PARAMETER_CHOICE, 0, 0, 1, "", 2, mavlink_sectors_choices}, offsetof(vista_parameters, mavlink.sectors)},
    {{"mavlink.angle_offset_deg", "deg", "Where the middle of sector 0 is, to the right from forward: a multiple of a sector. Some receivers ignore it. Set it as the receiver expects it.", VISTA_PARAMETER_FLOAT, 0.0, -180.0, 180.0, "", 0, NULL}, offsetof(vista_parameters, mavlink.angle_offset_deg)},
    {{"mavlink.stale_s", "s", "A frame that is older tells nothing any more. Change it with the frame rate and the delay of the link.", VISTA_PARAMETER_FLOAT, 0.3, 0.05, 0.5, "", 0, NULL}, offsetof(vista_parameters, mavlink.stale_s)},
    {{"alignment.correct", "", "Whether the right image is rectified anew when its rows no longer match those of the left one. Switch it on for a rig that may bend.", VISTA_PARAMETER_CHOICE, 0, 0, 1, "", 2, alignment_correct_choices}, offsetof(vista_parameters, alignment.correct)},
    {{"alignment.pitch_max_deg", "deg", "A larger turn about the camera's x axis is not corrected: an alarm is raised. A vertical shift of its image counts as pitch. Set it to what the rig may bend by.", VISTA_PARAMETER_FLOAT, 1.0, 0.05, 2.0, "", 0, NULL}, offsetof(vista_parameters, alignment.pitch_max_deg)},
    {{"alignment.roll_max_deg", "deg", "The same of a turn about the optical axis. Set it to what the rig may bend by.", VISTA_PARAMETER_FLOAT, 1.0, 0.05, 2.0, "", 0, NULL}, offsetof(vista_parameters, alignment.roll_max_deg)},
    {{"plan.vehicle", "", "Whose manoeuvres are flown. A multirotor ends them in a stop, a fixed wing in a circle. Set it to what flies.", VISTA_PARAMETER_CHOICE, 0, 0, 1, "", 2, plan_vehicle_choices}, offsetof(vista_parameters, plan.vehicle)},
    {{"plan.acceleration_max_m_s2", "m/s^2", "A multirotor speeds up, brakes and turns with this at most. Set it to what the vehicle follows with some reserve for wind.", VISTA_PARAMETER_FLOAT, 5.0, 0.5, 50.0, "", 0, NULL}, offsetof(vista_parameters, plan.acceleration_max_m_s2)},
    {{"plan.climb_max_m_s", "m/s", "Climbs and descents are no faster. Set it to what the vehicle can do; 0: it evades to the sides alone.", VISTA_PARAMETER_FLOAT, 3.0, 0.0, 50.0, "", 0, NULL}, offsetof(vista_parameters, plan.climb_max_m_s)},
    {{"plan.bank_max_deg", "deg", "A fixed wing turns with this at most. Set it to what the vehicle holds without losing height.", VISTA_PARAMETER_FLOAT, 40.0, 10.0, 75.0, "", 0, NULL}, offsetof(vista_parameters, plan.bank_max_deg)},
};

_Static_assert(sizeof(vista_stereo_params) == 256, "stereo may not grow");
_Static_assert(sizeof(vista_motion_params) == 256, "motion may not grow");
_Static_assert(sizeof(vista_foveation_params) == 256, "foveation may not grow");
_Static_assert(sizeof(vista_affinity_params) == 256, "affinity may not grow");
_Static_assert(sizeof(vista_segmentation_params) == 256, "segmentation may not grow");
_Static_assert(sizeof(vista_region_params) == 256, "region may not grow");
_Static_assert(sizeof(vista_reconstruction_params) == 256, "reconstruction may not grow");
_Static_assert(sizeof(vista_tracker_params) == 256, "tracker may not grow");
_Static_assert(sizeof(vista_blind_zone_params) == 256, "blind_zone may not grow");
_Static_assert(sizeof(vista_obstacle_map_params) == 256, "obstacle_map may not grow");
_Static_assert(sizeof(vista_health_params) == 256, "health may not grow");
_Static_assert(sizeof(vista_words_params) == 256, "words may not grow");
_Static_assert(sizeof(vista_terrain_params) == 256, "terrain may not grow");
_Static_assert(sizeof(vista_thin_params) == 256, "thin may not grow");
_Static_assert(sizeof(vista_host_params) == 256, "host may not grow");
_Static_assert(sizeof(vista_mavlink_params) == 256, "mavlink may not grow");
_Static_assert(sizeof(vista_alignment_params) == 256, "alignment may not grow");
_Static_assert(sizeof(vista_plan_params) == 256, "plan may not grow");

#endif
