/* Generated from sw/parameters.toml by scripts/make_parameters.py; do not edit. */
#ifndef VISTA_PARAMETERS_H
#define VISTA_PARAMETERS_H

#include <stddef.h>
#include <stdint.h>

#include "vista/api.h"
#include "vista/status.h"

VISTA_BEGIN

/* What is matched: the horizontal Sobel response, or the grey levels themselves (the Acadia's plain SAD). */
typedef enum vista_stereo_prefilter { VISTA_STEREO_PREFILTER_XSOBEL, VISTA_STEREO_PREFILTER_NONE } vista_stereo_prefilter;

/* Smoothing of both images before they are matched: none, or 1 2 1 in both directions. */
typedef enum vista_stereo_smooth { VISTA_STEREO_SMOOTH_OFF, VISTA_STEREO_SMOOTH_BINOMIAL3 } vista_stereo_smooth;

/* The stereo engine (its contract: doc/design/engine-contract.md). */
typedef struct vista_stereo_params {
  int32_t num_disparities; /* Candidates 0 .. num_disparities - 1, a multiple of 16. The paper's Acadia had 32; 64 halve the blind zone. 16 .. 256 px. */
  int32_t block_size; /* Side of the matching block, odd. 5 .. 21 px. */
  vista_stereo_prefilter prefilter; /* What is matched: the horizontal Sobel response, or the grey levels themselves (the Acadia's plain SAD). */
  int32_t prefilter_cap; /* Clamp of the Sobel response. 1 .. 63. */
  int32_t texture_threshold; /* Blocks with less texture are invalid. 0 .. 65535. */
  int32_t uniqueness_ratio; /* Margin of the best match over all that do not adjoin it. 0 .. 100 percent. */
  int32_t lr_max_diff; /* Largest difference of the left and the right winner; -1: no left/right check. -1 .. 255 px. */
  vista_stereo_smooth smooth; /* Smoothing of both images before they are matched: none, or 1 2 1 in both directions. */
  int32_t levels; /* Levels of the image pyramid that are matched, each half the size of the one before. 1 .. 4. */
  int32_t rectify_rows; /* Line buffer (16, 32, 64 or 128 rows) of hardware that rectifies by a control grid; 0: exact rectification. 0 .. 128 rows. */
  unsigned char reserved[216];
} vista_stereo_params;

/* The vehicle's own motion, from poses. */
typedef struct vista_motion_params {
  double velocity_smoothing_s; /* Time constant of velocity and turn rate from poses; 0: the last difference. 0.0 .. 60.0 s. */
  double speed_min_m_s; /* Slower, the flight direction is the optical axis. 0.0 .. 100.0 m/s. */
  double speed_max_m_s; /* A pose that only a faster vehicle could have reached is refused. 1.0 .. 10000.0 m/s. */
  int32_t restart_poses; /* As many refused poses in a row that agree with each other are believed: the world goes on there, without tracks. 1 .. 100 poses. */
  double drift_m_s; /* Error of the velocity over which a frame without a pose is carried on; adds to the uncertainty of all tracks. 0.0 .. 100.0 m/s. */
  double path_turn_min_deg_s; /* The path bends by what turns faster: nobody keeps to a straight line better than this. 0.0 .. 90.0 deg/s. */
  double path_uncertainty; /* Share by which the curvature of what is flown next may differ from that flown now; it bounds the length of the arc. 0.001 .. 1.0. */
  unsigned char reserved[200];
} vista_motion_params;

/* Log-polar grid (paper, section II-B). */
typedef struct vista_foveation_params {
  int32_t sector_count; /* Sectors of the log-polar grid; rings grow by exp(2*pi/sector_count), which keeps cells square. 16 .. 256. */
  double rho_0_px; /* Radius of the hub, the one cell at the centre. Paper: rho_0. 1.0 .. 64.0 px. */
  double min_valid_fraction; /* A cell has a disparity when at least this fraction of its pixels has one. 0.0 .. 1.0. */
  unsigned char reserved[232];
} vista_foveation_params;

/* How the feature terms combine: their weighted sum is the paper's equation 3, their product measures better. */
typedef enum vista_affinity_form { VISTA_AFFINITY_FORM_PRODUCT, VISTA_AFFINITY_FORM_SUM } vista_affinity_form;

/* Capacity = scale * C^((w - 1) / 2), or the paper's print, scale * (w + 1) / 2. */
typedef enum vista_affinity_flow_encoding { VISTA_AFFINITY_FLOW_ENCODING_EXPONENTIAL, VISTA_AFFINITY_FLOW_ENCODING_LINEAR } vista_affinity_flow_encoding;

/* Similarity of neighbouring cells (paper, equations 3 and 4) and its encoding as flow (equation 5). */
typedef struct vista_affinity_params {
  vista_affinity_form form; /* How the feature terms combine: their weighted sum is the paper's equation 3, their product measures better. */
  double alpha_intensity; /* Weight of the intensity term in the sum form; the disparity term has the rest. Paper: alpha_d. 0.0 .. 1.0. */
  double mu_intensity; /* Intensity difference that still counts as none. Paper: mu_d. 0.0 .. 255.0 grey levels. */
  double sigma_intensity; /* Scale of the intensity term. Paper: sigma_d. 0.1 .. 255.0 grey levels. */
  double mu_disparity_px; /* Disparity difference that still counts as none between adjoining cells. Paper: mu_d. 0.0 .. 16.0 px. */
  double mu_disparity_slope; /* Added to mu_disparity_px per pixel between the cell centres: cells of the periphery lie farther apart. Paper: mu_d. 0.0 .. 1.0 px per px. */
  double mu_depth_m; /* A disparity difference that means less depth than this counts as none: near things have relief. At most 6 % of the range. Paper: mu_d. 0.0 .. 10.0 m. */
  double sigma_disparity_px; /* Scale of the disparity term. Paper: sigma_d. 0.05 .. 64.0 px. */
  vista_affinity_flow_encoding flow_encoding; /* Capacity = scale * C^((w - 1) / 2), or the paper's print, scale * (w + 1) / 2. */
  double flow_scale; /* Capacity of an edge of affinity 1. 10.0 .. 100000.0. */
  double flow_constant; /* Base of the exponential encoding: the square root of it is the ratio of strongest to weakest edge. Paper: C. 1.0 .. 100000000.0. */
  double mu_intensity_noise; /* mu_intensity is at least this many times the noise of the image. Paper: mu_d. 0.0 .. 4.0 sigma of the image's noise. */
  unsigned char reserved[160];
} vista_affinity_params;

/* Inclination of the surface under each cell, from the disparities of the cells around it. */
typedef struct vista_surface_params {
  double lever_px; /* Cells at least this far apart are compared, so that the noise of a disparity does not tilt the surface. 1.0 .. 64.0 px. */
  double horizontal_deg; /* A surface that leans more than this from the vertical is one to fly along, not into. 10.0 .. 90.0 deg. */
  double ground_step_px; /* Cells within this of the ground's plane are ground. 0.0 .. 64.0 px. */
  double ground_step_m; /* Cells above the ground's plane by this, and by ground_step_px, stand. At most 6 % of the range. 0.0 .. 10.0 m. */
  double ground_tilt_deg; /* The ground below leans at most this from the horizontal. 0.0 .. 45.0 deg. */
  double ground_share; /* The ground's plane holds at least this share of the area below the horizon that has a disparity, after what lies below the plane is taken off. 0.0 .. 1.0. */
  unsigned char reserved[208];
} vista_surface_params;

/* What divides the free cells around a seed: the paper's minimum cut, or a maximum spanning forest of the same links. */
typedef enum vista_segmentation_solver { VISTA_SEGMENTATION_SOLVER_CUT, VISTA_SEGMENTATION_SOLVER_FOREST } vista_segmentation_solver;

/* Recursive minimum cuts (paper, section II-C). */
typedef struct vista_segmentation_params {
  double seed_step_px; /* Largest disparity step inside a seed between adjoining cells. 0.05 .. 8.0 px. */
  double seed_step_slope; /* Added to seed_step_px per pixel between the cell centres. 0.0 .. 1.0 px per px. */
  double seed_step_m; /* A disparity step that means less depth than this is no step. At most 6 % of the range. 0.0 .. 10.0 m. */
  double seed_area_px2; /* Smallest seed that is cut out. 1.0 .. 1000000.0 px2. */
  double bridge_m; /* Parts up to this far apart, with only cells without disparity between them, are one seed; 0: never. 0.0 .. 100.0 m. */
  double shell_px; /* Cells of a seed this near to an edge of depth stay free in the cut; half the matching block. 0.0 .. 64.0 px. */
  int32_t reach; /* A cut can take free cells less than this many steps from its seed. 1 .. 1000 cells. */
  double unknown_link; /* Sink link of a cell without disparity: what it costs to take a textureless cell into an obstacle. Paper: D_p. 0.0 .. 10.0 flow_scale. */
  double mismatch_link; /* Sink link of a free cell per pixel of disparity beyond the seed's own range, at most four times this. Paper: D_p. 0.0 .. 10.0 flow_scale. */
  double horizontal_link; /* Sink link of a cell on a horizontal surface. Paper: D_p. 0.0 .. 100.0 flow_scale. */
  double merge_ratio; /* Edges across the boundary of two regions that step by less than this are smooth. 0.0 .. 100.0 seed steps. */
  double merge_share; /* Two regions are one if more than half of the edges between them, and this share of the shorter perimeter, are smooth. 0.0 .. 1.0. */
  double rest_affinity; /* Cells that no obstacle claims form seeds of the rest along edges of at least this affinity. Paper: w_ij. 0.0 .. 1.0. */
  double rest_area_px2; /* Smallest seed of the rest that is cut out. 1.0 .. 1000000.0 px2. */
  vista_segmentation_solver solver; /* What divides the free cells around a seed: the paper's minimum cut, or a maximum spanning forest of the same links. */
  unsigned char reserved[140];
} vista_segmentation_params;

/* Regions at the resolution of the image: pixels of cells at a border join the cell that they resemble. */
typedef struct vista_refinement_params {
  double sigma_intensity; /* Difference of a pixel from a cell that weighs as much as one cell of distance at compactness 1. 0.1 .. 255.0 grey levels. */
  double contrast_limit; /* A larger difference weighs no more than this. 0.0 .. 100.0 sigma_intensity. */
  double mixed_penalty; /* Cost of a cell at a border: it may show parts of both regions. 0.0 .. 100.0. */
  double compactness; /* Cost of a pixel one cell's size away from the centre of a cell; 0: by intensity alone. 0.0 .. 100.0. */
  double sigma_intensity_noise; /* sigma_intensity is at least this many times the noise of the image. 0.0 .. 4.0 sigma of the image's noise. */
  double sigma_disparity_px; /* By how much a pixel is farther than a cell that weighs as much as one sigma_intensity; a nearer one costs nothing. 0.05 .. 64.0 px. */
  double disparity_limit; /* A larger difference in disparity weighs no more than this; 0: the disparities of pixels are not looked at. 0.0 .. 100.0 sigma_disparity_px. */
  unsigned char reserved[200];
} vista_refinement_params;

/* Statistics of the regions and the tests that make obstacles of them (paper, section II-D). */
typedef struct vista_region_params {
  double boundary_px; /* Cells this near to a cell on the boundary belong to it; half the matching block. 0.0 .. 64.0 px. */
  double tolerance_px; /* Boundary disparities within this of the region's surface are its inliers. 0.1 .. 16.0 px. */
  double tolerance_m; /* The same in depth; the larger of the two holds: near things have relief. At most 6 % of the range. 0.0 .. 10.0 m. */
  int32_t min_inliers; /* Fewest boundary inliers of an obstacle, but no more than one of min_size_m has pixels at its range. 1 .. 1000000 pixels. */
  double min_disparity_px; /* Regions with less are too far to say anything. 0.1 .. 255.0 px. */
  double min_size_m; /* Smallest larger side of an obstacle. At most 6 % of the range. 0.0 .. 100.0 m. */
  double min_valid_fraction; /* A region with a smaller fraction of valid pixels cannot be judged by them: it is unknown. 0.0 .. 1.0. */
  double min_inlier_fraction; /* Edge consistency: part of the valid boundary pixels on one surface from which on the boundary speaks no more against an obstacle. 0.0 .. 1.0. */
  double outline_fraction; /* Part of its foot, and of its upright edges or its upper edge, that has to lie on one upright surface for a region without disparities to be a plain wall. 0.0 .. 1.0. */
  double foot_m; /* The foot of such a region is within this of the ground's plane. At most 6 % of the range. 0.0 .. 10.0 m. */
  double min_height_m; /* What is lower than this above the horizontal surface that it adjoins lies on it. At most 6 % of the range. 0.01 .. 10.0 m. */
  double min_standing_fraction; /* A region of which a smaller part stands min_height_m above the ground lies on it. 0.0 .. 1.0. */
  double top_height_m; /* Words higher than this above the ground weigh more. At most in proportion to min_height_m. 0.01 .. 100.0 m. */
  double odds_prior; /* Log-odds of a region that is an obstacle, before anything is known of it. -100.0 .. 100.0 ln odds. */
  double odds_standing; /* Log-odds added by words that all stand min_height_m above the ground. -100.0 .. 100.0 ln odds. */
  double odds_top; /* Log-odds added by words that all stand top_height_m above the ground. -100.0 .. 100.0 ln odds. */
  double odds_boundary; /* Log-odds added by a boundary none of whose words lie on one surface (edge consistency); in proportion for fewer than min_inlier_fraction. -100.0 .. 100.0 ln odds. */
  double odds_support; /* Log-odds added by a boundary whose pixels all have a word. -100.0 .. 100.0 ln odds. */
  double odds_size; /* Log-odds added by each tenfold of a metre in size. -100.0 .. 100.0 ln odds. */
  double odds_unseeded; /* Log-odds added to a region that grew from no disparity of its own. -100.0 .. 100.0 ln odds. */
  double odds_lean; /* Log-odds added by a surface that lies flat, 15 degrees and more beyond surface.horizontal_deg. -100.0 .. 100.0 ln odds. */
  double ground_height_m; /* Pixels of an obstacle whose word is less than this above the ground's plane are the ground at its foot. At most 6 % of the range. 0.0 .. 10.0 m. */
  double row_edge_ratio; /* A region whose grey levels change at least this many times as much from row to row as along the rows is unknown: edges along the rows do not tell their disparity. 1.0 .. 1000.0. */
  unsigned char reserved[72];
} vista_region_params;

/* Regions to detections by linear triangulation (paper, section II-D). */
typedef struct vista_reconstruction_params {
  double center_sigma_px; /* Noise of a region's centre, along u and v each. 0.01 .. 100.0 px. */
  double center_sigma_ratio; /* The same as a share of the region's half width or height: the segmentation moves the centre of a large region by more. 0.0 .. 2.0. */
  double disparity_sigma_px; /* Noise of the boundary disparity that no averaging removes. 0.01 .. 16.0 px. */
  double correlated_pixels; /* Boundary inliers that share one matching block: n / this of them count as independent. 1.0 .. 1000.0 pixels. */
  double disparity_min_px; /* Smaller disparities are not reconstructed. 0.1 .. 255.0 px. */
  unsigned char reserved[216];
} vista_reconstruction_params;

/* One extended Kalman filter an obstacle, in the inertial frame (paper, section II-D). */
typedef struct vista_tracker_params {
  double velocity_sigma_m_s; /* Prior of an obstacle's velocity, each axis: obstacles are mostly static. 0.001 .. 100.0 m/s. */
  double moving_sigma_m_s; /* Prior of the velocity of what moves, each axis: of a track seen once whose next detection no track explains as standing. 0.0 .. 1000.0 m/s. */
  double acceleration_psd_m2_s3; /* Spectral density of the white acceleration, each axis. Paper: Q. 0.0 .. 1000.0 m2/s3. */
  double position_psd_m2_s; /* Random walk of the point that stands for the obstacle: regions change from frame to frame. Paper: Q. 0.0 .. 100.0 m2/s. */
  double attitude_sigma_deg; /* Error of the pose's attitude, each axis; adds to the noise of u and v. 0.0 .. 10.0 deg. */
  double gate_chi2; /* Mahalanobis gate in (u, v, d): chi-square with 3 degrees of freedom, 11.34 holds 99 percent. 0.1 .. 1000.0. */
  double extent_sigma_ratio; /* Noise of the natural logarithm of a measured width or height. 0.01 .. 10.0. */
  double extent_psd_1_s; /* Random walk of the logarithm of width and height. 0.0 .. 100.0 1/s. */
  double overlap_sigma; /* Depth gate for lying within a track, standard deviations of the disparity difference. 0.1 .. 100.0. */
  double overlap_scale; /* Half extents around a track's centre that count as within it. 0.1 .. 10.0. */
  int32_t confirm_hits; /* A track is confirmed at this many hits in confirm_window frames; at one more while own travel could tell, but does not yet, that it stands. Paper: M. 1 .. 32 frames. At most confirm_window. */
  int32_t confirm_window; /* Frames, in which the track could be seen, that count for its confirmation. Paper: N. 1 .. 32 frames. */
  int32_t moved_hits; /* A track that moves needs this many hits, and has this many frames, more to be confirmed. 0 .. 16 frames. */
  int32_t volume_pixels; /* A region is in the collision volume when at least this many of its pixels are. 0 .. 1000000 pixels. */
  double static_odds; /* Likelihood ratio at which a track is held to stand still, or, inverted, to move with the aircraft as a mismatched texture does. 1.0 .. 1000000.0. */
  double static_tolerance; /* Motion along the line of sight, as a share of own travel, that what stands may seem to make: regions change on approach. 0.0 .. 1.0. */
  double static_noise_hits; /* Hits in a row whose range errors are about the same: they count as one. 1.0 .. 100.0 hits. */
  double static_fade_m; /* Own travel over which earlier hits lose their say about that. 0.1 .. 100000.0 m. */
  double static_speed_min_m_s; /* Slower than this along its line of sight, own travel tells nothing of a track: single frames have to do. 0.0 .. 100.0 m/s. */
  int32_t miss_max; /* Misses in a row that a confirmed track survives. 0 .. 1000 frames. */
  double out_of_view_s; /* A track outside the matched part of the image, which is not in the way, coasts for this long. 0.0 .. 3600.0 s. */
  double blind_zone_s; /* A track nearer than the engine matches coasts for this long, unless it is passed before. 0.0 .. 3600.0 s. */
  double range_max_m; /* Farther detections start no track. 1.0 .. 100000.0 m. */
  double follow_s; /* A track without a detection, not in the way, is followed by the words at its place for this long. 0.0 .. 3600.0 s. */
  double hold_s; /* A track whose place shows no words coasts for this long before it counts as missed. 0.0 .. 3600.0 s. */
  double hold_px; /* A track at whose place nothing is matched, confirmed or not, coasts until its disparity has moved by this since its last detection, if that takes no longer than follow_s: between two whole disparities sharp textures are hard to match. 0.0 .. 16.0 px. */
  unsigned char reserved[64];
} vista_tracker_params;

/* Something in the way that is too near to match: texture without disparity. */
typedef struct vista_blind_zone_params {
  int32_t contrast; /* A pixel whose two neighbours along the row differ by this has texture. 1 .. 255 grey levels. */
  double textured_fraction; /* With less of the disc textured, nothing can be said. 0.001 .. 1.0. */
  double unmatched_fraction; /* Something is too near when this share of the texture is not matched; in ordinary views it is 0.03 to 0.6. 0.0 .. 1.0. */
  int32_t confirm_hits; /* It is reported when it was so in this many of confirm_window frames. Paper: M. 1 .. 32 frames. At most confirm_window. */
  int32_t confirm_window; /* Frames that count for that. Paper: N. 1 .. 32 frames. */
  double contrast_noise; /* The same against the noise of the image; the larger of the two holds. Of pure noise, one pixel in 200 exceeds 4. 0.0 .. 100.0 sigma of the image's noise. */
  double repeated_fraction; /* Nothing is reported when this share of the unmatched texture repeats itself along its rows, as windows do: it is ambiguous at any range. 0.0 .. 1.0. */
  unsigned char reserved[208];
} vista_blind_zone_params;

/* Obstacles against the flight path (paper, section II-D; companion). */
typedef struct vista_obstacle_map_params {
  double collision_radius_m; /* Radius of the collision volume around the flight path. 0.01 .. 1000.0 m. */
  double collision_length_m; /* Length of the collision volume, from the camera. 0.1 .. 100000.0 m. */
  double inflation_sigma; /* Standard deviations of the bearing that are added to an obstacle's semi-axes. 0.0 .. 10.0. */
  double lasting_disparity_px; /* Error of an obstacle's disparity that lasts from frame to frame: no filter averages it out; adds to the covariance. 0.0 .. 16.0 px. */
  double lasting_range_m; /* The same in depth, of the surface that the region's boundary shows; the larger part near the camera. 0.0 .. 10.0 m. */
  double lasting_center_px; /* The same of its centre: matching widens a thing more to one side than to the other. 0.0 .. 100.0 px. */
  double lasting_center_ratio; /* The same, as a share of half of what its longer side has more than twice the shorter one: a region may lack the end of a long thing all along. 0.0 .. 2.0. */
  double closing_min_m_s; /* No time to collision is given for what closes slower than this. 0.0 .. 100.0 m/s. */
  double outline_px; /* Pixels by which matching widens a thing to each side: so much nearer to the path has a pixel to be, to be in the collision volume. 0.0 .. 100.0 px. */
  double lasting_scatter; /* The same in u, v and disparity, as a share of the scatter of its detections beyond what noise explains: a region that wanders may be wrong for long. 0.0 .. 10.0. */
  double thickness_ratio; /* The middle of a thing lies this share of half its width behind the surface that is seen, uncertain by as much: 0 for a board, 1 for a ball. Its width counts up to twice its height, and up to 1 m. 0.0 .. 1.0. */
  double seen_min_fraction; /* The flight path is seen as far as this share of the collision volume's cross-section has disparities in regions that could be judged. 0.0 .. 1.0. */
  double approach_s; /* What moves across the flight path is in the collision volume as soon as it will be within this time. 0.0 .. 60.0 s. */
  double meet_s; /* What flies and moves across the flight path is in the collision volume as soon as it and the aircraft will meet within this time. 0.0 .. 60.0 s. */
  double path_sigmas; /* The collision volume is narrower by so many standard deviations of how far the aircraft may leave its path, down to half its radius: what is beside its rim far ahead is passed as often as not. 0.0 .. 10.0 sigma of the flight path. */
  unsigned char reserved[136];
} vista_obstacle_map_params;

/* Limits below which a view tells too little. */
typedef struct vista_health_params {
  double degraded_fraction; /* A frame is degraded when less than this of the pixels that can be matched has a disparity; in a noisy image one that another one, a block away, agrees with. 0.0 .. 1.0. */
  double blind_fraction; /* With less than this it is blind. 0.0 .. 1.0. At most degraded_fraction. */
  double contrast_min; /* It is blind, too, when the standard deviation of the cells' grey levels is smaller, without what is left of the image's noise. 0.0 .. 255.0 grey levels. */
  double noise_min; /* An image with more noise than this is noisy: chance matches part of it, and only disparities that agree with others count. 0.0 .. 255.0 grey levels. */
  double ground_fraction; /* A frame is degraded, too, when less than this of what is below the horizon has a disparity where the flight leads to, as wide as the collision volume 30 m ahead: something that cannot be matched hides the ground. 0: never. 0.0 .. 1.0. */
  unsigned char reserved[216];
} vista_health_params;

/* The words of all pyramid levels, filtered and put together (extension of the paper). */
typedef struct vista_words_params {
  int32_t cluster_px; /* Words that hang together and cover less, in pixels of their level, are dropped; 0: none are. 0 .. 1000000 px. */
  double support; /* A word of a coarser level is taken where at least this share of the 5x5 pixels around it has a word. 0.0 .. 1.0. */
  double contradiction_px; /* A word gives way to that of the next coarser level when they differ by more, in pixels of that level. 0.0 .. 256.0 px. */
  int32_t filling_levels; /* As many coarser levels fill surfaces where the finer ones have no word; the others only add what is too near for level 0. 0 .. 3. */
  int32_t gap_px; /* Words of a row hang together across gaps up to twice this wide. 0 .. 16 px. */
  double cluster_px_noise; /* cluster_px is at least this times the image's noise: chance matches of a noisy image are larger. 0.0 .. 100000.0 px per grey level. */
  double cluster_m2; /* A cluster that covers this area at its distance is kept though it covers less than cluster_px. 0.0 .. 100.0 m2. */
  int32_t cluster_far_px; /* A small cluster that is kept covers at least as many pixels; in a noisy image as many as cluster_px_noise asks for. 0 .. 1000000 px. */
  double cluster_far_disparity_px; /* A small cluster that is kept has a disparity of at least this: where nothing can be matched, chance matches are mostly smaller and cover much at their distance. 0.0 .. 4096.0 px. */
  unsigned char reserved[192];
} vista_words_params;

/* Ground that the flight path meets (extension of the paper). */
typedef struct vista_terrain_params {
  double lean_min_deg; /* A surface below the path that leans more than this from the vertical is ground; steeper ones are things that stand. 0.0 .. 90.0 deg. */
  double angle_min_deg; /* The path meets the ground when it descends on it at this angle at least; at less it is flown along. 0.1 .. 90.0 deg. */
  double clearance_share; /* The collision volume reaches down by this share of the distance from the ground's surface at most: who flies low along it is no nearer to hitting it. 0.0 .. 1.0. */
  double agree_fraction; /* Of the words where the volume meets the ground, this share has to lie on its surface. 0.0 .. 1.0. */
  unsigned char reserved[224];
} vista_terrain_params;

/* Whether wires and thin poles are looked for. */
typedef enum vista_thin_find { VISTA_THIN_FIND_OFF, VISTA_THIN_FIND_ON } vista_thin_find;

/* Thin things, found at the resolution of the image: wires, thin poles (extension of the paper). */
typedef struct vista_thin_params {
  vista_thin_find find; /* Whether wires and thin poles are looked for. */
  double contrast; /* Contrast of a thin line to both of its sides that counts in full; more counts no more. 3.5 .. 63.0 grey levels. */
  double contrast_noise; /* The same against the noise of the image; the larger of the two holds. 0.0 .. 100.0 sigma of the image's noise. */
  double piece_sum; /* Sixteen rows of a line are a piece of it when their contrasts add up to at least this share of the full ones. 0.0 .. 1.0. */
  int32_t pieces_min; /* A line has at least so many pieces. 2 .. 1000 pieces. */
  double piece_share; /* From its first to its last piece, a line has one in at least this share of the strips of 16 rows. 0.0 .. 1.0. */
  double straight_px; /* Largest root mean square distance of a line's pieces from the straight line through them, along the row. 0.0 .. 100.0 px. */
  double ridge_share; /* Smallest share of a line's rows that show it. 0.0 .. 1.0. */
  double apart_px; /* A word on the line tells of a thin thing when it is nearer by this than those beside it. 0.0 .. 256.0 px. */
  double agree_px; /* Such words agree with a straight line in space within this. 0.01 .. 16.0 px. */
  double agree_share; /* Smallest share of these words that agree. 0.0 .. 1.0. */
  int32_t rows_min; /* Fewest rows whose words agree. 2 .. 100000 rows. */
  double row_share; /* Smallest share of the line's rows whose words agree. 0.0 .. 1.0. */
  double word_share; /* Smallest share of the rows with any word on the line whose words agree; the others are of what is behind. 0.0 .. 1.0. */
  int32_t rows_sure; /* So many rows whose words agree are enough, whatever share of the words that is. 2 .. 100000 rows. */
  double level_share; /* Largest share of the line's rows that have something beside it as near as itself: a line on a surface is no thing of its own. 0.0 .. 1.0. */
  double length_m; /* Shortest line. 0.0 .. 1000.0 m. */
  double height_m; /* More than half of a line stands at least this far above the ground. 0.0 .. 100.0 m. */
  unsigned char reserved[112];
} vista_thin_params;

/* How the host works; no result depends on it. */
typedef struct vista_host_params {
  int32_t threads; /* With 2, a second thread takes part in every frame; vista_pipeline_destroy ends it. 1 .. 2 threads. */
  unsigned char reserved[252];
} vista_host_params;

/* Whose rules the messages follow: OBSTACLE_DISTANCE with unknown sectors, or OBSTACLE_DISTANCE_3D and silence. */
typedef enum vista_mavlink_autopilot { VISTA_MAVLINK_AUTOPILOT_PX4, VISTA_MAVLINK_AUTOPILOT_ARDUPILOT } vista_mavlink_autopilot;

/* 72 sectors of 5 degrees, or 36 of 10 for versions of PX4 whose own map has 36: of 72 these read every second one only. */
typedef enum vista_mavlink_sectors { VISTA_MAVLINK_SECTORS_72, VISTA_MAVLINK_SECTORS_36 } vista_mavlink_sectors;

/* What an autopilot is told: vista mavlink, vista/mavlink.h. */
typedef struct vista_mavlink_params {
  vista_mavlink_autopilot autopilot; /* Whose rules the messages follow: OBSTACLE_DISTANCE with unknown sectors, or OBSTACLE_DISTANCE_3D and silence. */
  int32_t system_id; /* That of the aircraft. 1 .. 255. */
  int32_t component_id; /* Of the detector; 196 is obstacle avoidance. 1 .. 255. */
  double mount_roll_deg; /* How the left camera hangs in the aircraft, turned by yaw first, then by pitch, then by roll. Roll: to the right. -180.0 .. 180.0 deg. */
  double mount_pitch_deg; /* Upwards from level. -90.0 .. 90.0 deg. */
  double mount_yaw_deg; /* To the right from forward. -180.0 .. 180.0 deg. */
  double min_distance_m; /* What is nearer, or too near to match, is reported at this distance, never at 0. 0.05 .. 100.0 m. At most max_distance_m. */
  double max_distance_m; /* What is farther is not reported. Clear means: seen to be free up to here, which is at most obstacle_map.collision_length_m. 1.0 .. 655.0 m. */
  double half_height_m; /* Sectors are about what reaches into the slice so far above and below the height of the camera. 0.0 .. 1000.0 m. */
  vista_mavlink_sectors sectors; /* 72 sectors of 5 degrees, or 36 of 10 for versions of PX4 whose own map has 36: of 72 these read every second one only. */
  double angle_offset_deg; /* Where the middle of sector 0 is, to the right from forward: a multiple of a sector. Some receivers ignore it. -180.0 .. 180.0 deg. */
  double stale_s; /* A frame that is older tells nothing any more. 0.05 .. 0.5 s. */
  unsigned char reserved[168];
} vista_mavlink_params;

/* Whether the right image is rectified anew when its rows no longer match those of the left one. */
typedef enum vista_alignment_correct { VISTA_ALIGNMENT_CORRECT_OFF, VISTA_ALIGNMENT_CORRECT_ON } vista_alignment_correct;

/* Correction of the right camera's turn against its calibration, in flight, from the rows of matched features. */
typedef struct vista_alignment_params {
  vista_alignment_correct correct; /* Whether the right image is rectified anew when its rows no longer match those of the left one. */
  double pitch_max_deg; /* A larger turn about the camera's x axis is not corrected: an alarm is raised. A vertical shift of its image counts as pitch. 0.05 .. 2.0 deg. */
  double roll_max_deg; /* The same of a turn about the optical axis. 0.05 .. 2.0 deg. */
  double step_px; /* The correction is changed when that moves rows by more than this, root mean square over the image: below, a calibration is left as it is. 0.02 .. 2.0 px. */
  double drift_deg; /* Standard deviation of how far pitch and roll drift in a second: smaller values average for longer. Sudden turns are followed whatever it is. 0.0 .. 1.0 deg. */
  double lost_s; /* The alarm is raised, too, when the images have texture but their rows agree on no turn for so long. 0.1 .. 60.0 s. */
  unsigned char reserved[208];
} vista_alignment_params;

/* All parameters. vista_parameters_default makes the struct; change its members afterwards. A newer library
 * keeps its new parameters behind those of this header and in the reserved parts, and fills them in there. */
typedef struct vista_parameters {
  size_t struct_bytes; /* size of this struct in the caller's header */
  vista_stereo_params stereo;
  vista_motion_params motion;
  vista_foveation_params foveation;
  vista_affinity_params affinity;
  vista_surface_params surface;
  vista_segmentation_params segmentation;
  vista_refinement_params refinement;
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
