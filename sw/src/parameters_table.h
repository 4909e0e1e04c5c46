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

static const struct {
  vista_parameter info;
  size_t offset; /* in vista_parameters */
} parameter_table[] = {
    {{"stereo.num_disparities", "px", "Candidates 0 .. num_disparities - 1, a multiple of 16. The paper's Acadia had 32; 64 halve the blind zone.", VISTA_PARAMETER_INT, 64, 16, 256, "", 0, NULL}, offsetof(vista_parameters, stereo.num_disparities)},
    {{"stereo.block_size", "px", "Side of the matching block, odd.", VISTA_PARAMETER_INT, 11, 5, 21, "", 0, NULL}, offsetof(vista_parameters, stereo.block_size)},
    {{"stereo.prefilter", "", "What is matched: the horizontal Sobel response, or the grey levels themselves (the Acadia's plain SAD).", VISTA_PARAMETER_CHOICE, 0, 0, 1, "", 2, stereo_prefilter_choices}, offsetof(vista_parameters, stereo.prefilter)},
    {{"stereo.prefilter_cap", "", "Clamp of the Sobel response.", VISTA_PARAMETER_INT, 31, 1, 63, "", 0, NULL}, offsetof(vista_parameters, stereo.prefilter_cap)},
    {{"stereo.texture_threshold", "", "Blocks with less texture are invalid.", VISTA_PARAMETER_INT, 10, 0, 65535, "", 0, NULL}, offsetof(vista_parameters, stereo.texture_threshold)},
    {{"stereo.uniqueness_ratio", "percent", "Margin of the best match over all that do not adjoin it.", VISTA_PARAMETER_INT, 15, 0, 100, "", 0, NULL}, offsetof(vista_parameters, stereo.uniqueness_ratio)},
    {{"stereo.lr_max_diff", "px", "Largest difference of the left and the right winner; -1: no left/right check.", VISTA_PARAMETER_INT, 1, -1, 255, "", 0, NULL}, offsetof(vista_parameters, stereo.lr_max_diff)},
    {{"stereo.smooth", "", "Smoothing of both images before they are matched: none, or 1 2 1 in both directions.", VISTA_PARAMETER_CHOICE, 0, 0, 1, "", 2, stereo_smooth_choices}, offsetof(vista_parameters, stereo.smooth)},
    {{"stereo.levels", "", "Levels of the image pyramid that are matched, each half the size of the one before.", VISTA_PARAMETER_INT, 3, 1, 4, "", 0, NULL}, offsetof(vista_parameters, stereo.levels)},
    {{"motion.velocity_smoothing_s", "s", "Time constant of velocity and turn rate from poses; 0: the last difference.", VISTA_PARAMETER_FLOAT, 0.3, 0.0, 60.0, "", 0, NULL}, offsetof(vista_parameters, motion.velocity_smoothing_s)},
    {{"motion.speed_min_m_s", "m/s", "Slower, the flight direction is the optical axis.", VISTA_PARAMETER_FLOAT, 0.5, 0.0, 100.0, "", 0, NULL}, offsetof(vista_parameters, motion.speed_min_m_s)},
    {{"motion.speed_max_m_s", "m/s", "A pose that only a faster vehicle could have reached is refused.", VISTA_PARAMETER_FLOAT, 150.0, 1.0, 10000.0, "", 0, NULL}, offsetof(vista_parameters, motion.speed_max_m_s)},
    {{"motion.restart_poses", "poses", "As many refused poses in a row that agree with each other are believed: the world goes on there, without tracks.", VISTA_PARAMETER_INT, 3, 1, 100, "", 0, NULL}, offsetof(vista_parameters, motion.restart_poses)},
    {{"motion.drift_m_s", "m/s", "Error of the velocity over which a frame without a pose is carried on; adds to the uncertainty of all tracks.", VISTA_PARAMETER_FLOAT, 0.5, 0.0, 100.0, "", 0, NULL}, offsetof(vista_parameters, motion.drift_m_s)},
    {{"motion.path_turn_min_deg_s", "deg/s", "The path bends by what turns faster: nobody keeps to a straight line better than this.", VISTA_PARAMETER_FLOAT, 1.0, 0.0, 90.0, "", 0, NULL}, offsetof(vista_parameters, motion.path_turn_min_deg_s)},
    {{"motion.path_uncertainty", "", "Share by which the curvature of what is flown next may differ from that flown now; it bounds the length of the arc.", VISTA_PARAMETER_FLOAT, 0.25, 0.001, 1.0, "", 0, NULL}, offsetof(vista_parameters, motion.path_uncertainty)},
    {{"foveation.sector_count", "", "Sectors of the log-polar grid; rings grow by exp(2*pi/sector_count), which keeps cells square.", VISTA_PARAMETER_INT, 128, 16, 256, "", 0, NULL}, offsetof(vista_parameters, foveation.sector_count)},
    {{"foveation.rho_0_px", "px", "Radius of the hub, the one cell at the centre.", VISTA_PARAMETER_FLOAT, 4.0, 1.0, 64.0, "", 0, NULL}, offsetof(vista_parameters, foveation.rho_0_px)},
    {{"foveation.min_valid_fraction", "", "A cell has a disparity when at least this fraction of its pixels has one.", VISTA_PARAMETER_FLOAT, 0.3, 0.0, 1.0, "", 0, NULL}, offsetof(vista_parameters, foveation.min_valid_fraction)},
    {{"affinity.form", "", "How the feature terms combine: their weighted sum is the paper's equation 3, their product measures better.", VISTA_PARAMETER_CHOICE, 0, 0, 1, "", 2, affinity_form_choices}, offsetof(vista_parameters, affinity.form)},
    {{"affinity.alpha_intensity", "", "Weight of the intensity term in the sum form; the disparity term has the rest.", VISTA_PARAMETER_FLOAT, 0.5, 0.0, 1.0, "", 0, NULL}, offsetof(vista_parameters, affinity.alpha_intensity)},
    {{"affinity.mu_intensity", "grey levels", "Intensity difference that still counts as none.", VISTA_PARAMETER_FLOAT, 2.0, 0.0, 255.0, "", 0, NULL}, offsetof(vista_parameters, affinity.mu_intensity)},
    {{"affinity.sigma_intensity", "grey levels", "Scale of the intensity term.", VISTA_PARAMETER_FLOAT, 10.0, 0.1, 255.0, "", 0, NULL}, offsetof(vista_parameters, affinity.sigma_intensity)},
    {{"affinity.mu_disparity_px", "px", "Disparity difference that still counts as none between adjoining cells.", VISTA_PARAMETER_FLOAT, 0.5, 0.0, 16.0, "", 0, NULL}, offsetof(vista_parameters, affinity.mu_disparity_px)},
    {{"affinity.mu_disparity_slope", "px per px", "Added to mu_disparity_px per pixel between the cell centres: cells of the periphery lie farther apart.", VISTA_PARAMETER_FLOAT, 0.1, 0.0, 1.0, "", 0, NULL}, offsetof(vista_parameters, affinity.mu_disparity_slope)},
    {{"affinity.mu_depth_m", "m", "A disparity difference that means less depth than this counts as none: near things have relief. At most 6 % of the range.", VISTA_PARAMETER_FLOAT, 0.5, 0.0, 10.0, "", 0, NULL}, offsetof(vista_parameters, affinity.mu_depth_m)},
    {{"affinity.sigma_disparity_px", "px", "Scale of the disparity term.", VISTA_PARAMETER_FLOAT, 1.0, 0.05, 64.0, "", 0, NULL}, offsetof(vista_parameters, affinity.sigma_disparity_px)},
    {{"affinity.flow_encoding", "", "Capacity = scale * C^((w - 1) / 2), or the paper's print, scale * (w + 1) / 2.", VISTA_PARAMETER_CHOICE, 0, 0, 1, "", 2, affinity_flow_encoding_choices}, offsetof(vista_parameters, affinity.flow_encoding)},
    {{"affinity.flow_scale", "", "Capacity of an edge of affinity 1.", VISTA_PARAMETER_FLOAT, 10000.0, 10.0, 100000.0, "", 0, NULL}, offsetof(vista_parameters, affinity.flow_scale)},
    {{"affinity.flow_constant", "", "Base of the exponential encoding: the square root of it is the ratio of strongest to weakest edge.", VISTA_PARAMETER_FLOAT, 10000.0, 1.0, 100000000.0, "", 0, NULL}, offsetof(vista_parameters, affinity.flow_constant)},
    {{"affinity.mu_intensity_noise", "sigma of the image's noise", "mu_intensity is at least this many times the noise of the image.", VISTA_PARAMETER_FLOAT, 0.5, 0.0, 4.0, "", 0, NULL}, offsetof(vista_parameters, affinity.mu_intensity_noise)},
    {{"surface.lever_px", "px", "Cells at least this far apart are compared, so that the noise of a disparity does not tilt the surface.", VISTA_PARAMETER_FLOAT, 8.0, 1.0, 64.0, "", 0, NULL}, offsetof(vista_parameters, surface.lever_px)},
    {{"surface.horizontal_deg", "deg", "A surface that leans more than this from the vertical is one to fly along, not into.", VISTA_PARAMETER_FLOAT, 55.0, 10.0, 90.0, "", 0, NULL}, offsetof(vista_parameters, surface.horizontal_deg)},
    {{"surface.ground_step_px", "px", "Cells within this of the ground's plane are ground.", VISTA_PARAMETER_FLOAT, 0.5, 0.0, 64.0, "", 0, NULL}, offsetof(vista_parameters, surface.ground_step_px)},
    {{"surface.ground_step_m", "m", "Cells above the ground's plane by this, and by ground_step_px, stand. At most 6 % of the range.", VISTA_PARAMETER_FLOAT, 0.35, 0.0, 10.0, "", 0, NULL}, offsetof(vista_parameters, surface.ground_step_m)},
    {{"surface.ground_tilt_deg", "deg", "The ground below leans at most this from the horizontal.", VISTA_PARAMETER_FLOAT, 15.0, 0.0, 45.0, "", 0, NULL}, offsetof(vista_parameters, surface.ground_tilt_deg)},
    {{"surface.ground_share", "", "The ground's plane holds at least this share of the area below the horizon that has a disparity, after what lies below the plane is taken off.", VISTA_PARAMETER_FLOAT, 0.03, 0.0, 1.0, "", 0, NULL}, offsetof(vista_parameters, surface.ground_share)},
    {{"segmentation.seed_step_px", "px", "Largest disparity step inside a seed between adjoining cells.", VISTA_PARAMETER_FLOAT, 0.5, 0.05, 8.0, "", 0, NULL}, offsetof(vista_parameters, segmentation.seed_step_px)},
    {{"segmentation.seed_step_slope", "px per px", "Added to seed_step_px per pixel between the cell centres.", VISTA_PARAMETER_FLOAT, 0.02, 0.0, 1.0, "", 0, NULL}, offsetof(vista_parameters, segmentation.seed_step_slope)},
    {{"segmentation.seed_step_m", "m", "A disparity step that means less depth than this is no step. At most 6 % of the range.", VISTA_PARAMETER_FLOAT, 0.5, 0.0, 10.0, "", 0, NULL}, offsetof(vista_parameters, segmentation.seed_step_m)},
    {{"segmentation.seed_area_px2", "px2", "Smallest seed that is cut out.", VISTA_PARAMETER_FLOAT, 60.0, 1.0, 1000000.0, "", 0, NULL}, offsetof(vista_parameters, segmentation.seed_area_px2)},
    {{"segmentation.bridge_m", "m", "Parts up to this far apart, with only cells without disparity between them, are one seed; 0: never.", VISTA_PARAMETER_FLOAT, 2.0, 0.0, 100.0, "", 0, NULL}, offsetof(vista_parameters, segmentation.bridge_m)},
    {{"segmentation.shell_px", "px", "Cells of a seed this near to an edge of depth stay free in the cut; half the matching block.", VISTA_PARAMETER_FLOAT, 6.0, 0.0, 64.0, "", 0, NULL}, offsetof(vista_parameters, segmentation.shell_px)},
    {{"segmentation.reach", "cells", "A cut can take free cells less than this many steps from its seed.", VISTA_PARAMETER_INT, 12, 1, 1000, "", 0, NULL}, offsetof(vista_parameters, segmentation.reach)},
    {{"segmentation.unknown_link", "flow_scale", "Sink link of a cell without disparity: what it costs to take a textureless cell into an obstacle.", VISTA_PARAMETER_FLOAT, 0.03, 0.0, 10.0, "", 0, NULL}, offsetof(vista_parameters, segmentation.unknown_link)},
    {{"segmentation.mismatch_link", "flow_scale", "Sink link of a free cell per pixel of disparity beyond the seed's own range, at most four times this.", VISTA_PARAMETER_FLOAT, 0.5, 0.0, 10.0, "", 0, NULL}, offsetof(vista_parameters, segmentation.mismatch_link)},
    {{"segmentation.horizontal_link", "flow_scale", "Sink link of a cell on a horizontal surface.", VISTA_PARAMETER_FLOAT, 0.3, 0.0, 100.0, "", 0, NULL}, offsetof(vista_parameters, segmentation.horizontal_link)},
    {{"segmentation.merge_ratio", "seed steps", "Edges across the boundary of two regions that step by less than this are smooth.", VISTA_PARAMETER_FLOAT, 2.0, 0.0, 100.0, "", 0, NULL}, offsetof(vista_parameters, segmentation.merge_ratio)},
    {{"segmentation.merge_share", "", "Two regions are one if more than half of the edges between them, and this share of the shorter perimeter, are smooth.", VISTA_PARAMETER_FLOAT, 0.1, 0.0, 1.0, "", 0, NULL}, offsetof(vista_parameters, segmentation.merge_share)},
    {{"segmentation.rest_affinity", "", "Cells that no obstacle claims form seeds of the rest along edges of at least this affinity.", VISTA_PARAMETER_FLOAT, 0.7, 0.0, 1.0, "", 0, NULL}, offsetof(vista_parameters, segmentation.rest_affinity)},
    {{"segmentation.rest_area_px2", "px2", "Smallest seed of the rest that is cut out.", VISTA_PARAMETER_FLOAT, 60.0, 1.0, 1000000.0, "", 0, NULL}, offsetof(vista_parameters, segmentation.rest_area_px2)},
    {{"segmentation.solver", "", "What divides the free cells around a seed: the paper's minimum cut, or a maximum spanning forest of the same links.", VISTA_PARAMETER_CHOICE, 0, 0, 1, "", 2, segmentation_solver_choices}, offsetof(vista_parameters, segmentation.solver)},
    {{"refinement.sigma_intensity", "grey levels", "Difference of a pixel from a cell that weighs as much as one cell of distance at compactness 1.", VISTA_PARAMETER_FLOAT, 10.0, 0.1, 255.0, "", 0, NULL}, offsetof(vista_parameters, refinement.sigma_intensity)},
    {{"refinement.contrast_limit", "sigma_intensity", "A larger difference weighs no more than this.", VISTA_PARAMETER_FLOAT, 3.0, 0.0, 100.0, "", 0, NULL}, offsetof(vista_parameters, refinement.contrast_limit)},
    {{"refinement.mixed_penalty", "", "Cost of a cell at a border: it may show parts of both regions.", VISTA_PARAMETER_FLOAT, 0.75, 0.0, 100.0, "", 0, NULL}, offsetof(vista_parameters, refinement.mixed_penalty)},
    {{"refinement.compactness", "", "Cost of a pixel one cell's size away from the centre of a cell; 0: by intensity alone.", VISTA_PARAMETER_FLOAT, 1.0, 0.0, 100.0, "", 0, NULL}, offsetof(vista_parameters, refinement.compactness)},
    {{"refinement.sigma_intensity_noise", "sigma of the image's noise", "sigma_intensity is at least this many times the noise of the image.", VISTA_PARAMETER_FLOAT, 1.5, 0.0, 4.0, "", 0, NULL}, offsetof(vista_parameters, refinement.sigma_intensity_noise)},
    {{"region.boundary_px", "px", "Cells this near to a cell on the boundary belong to it; half the matching block.", VISTA_PARAMETER_FLOAT, 5.0, 0.0, 64.0, "", 0, NULL}, offsetof(vista_parameters, region.boundary_px)},
    {{"region.tolerance_px", "px", "Boundary disparities within this of the region's surface are its inliers.", VISTA_PARAMETER_FLOAT, 1.0, 0.1, 16.0, "", 0, NULL}, offsetof(vista_parameters, region.tolerance_px)},
    {{"region.tolerance_m", "m", "The same in depth; the larger of the two holds: near things have relief. At most 6 % of the range.", VISTA_PARAMETER_FLOAT, 0.5, 0.0, 10.0, "", 0, NULL}, offsetof(vista_parameters, region.tolerance_m)},
    {{"region.min_inliers", "pixels", "Fewest boundary inliers of an obstacle, but no more than one of min_size_m has pixels at its range.", VISTA_PARAMETER_INT, 60, 1, 1000000, "", 0, NULL}, offsetof(vista_parameters, region.min_inliers)},
    {{"region.min_disparity_px", "px", "Regions with less are too far to say anything.", VISTA_PARAMETER_FLOAT, 2.5, 0.1, 255.0, "", 0, NULL}, offsetof(vista_parameters, region.min_disparity_px)},
    {{"region.min_size_m", "m", "Smallest larger side of an obstacle. At most 6 % of the range.", VISTA_PARAMETER_FLOAT, 0.35, 0.0, 100.0, "", 0, NULL}, offsetof(vista_parameters, region.min_size_m)},
    {{"region.min_valid_fraction", "", "A region with a smaller fraction of valid pixels cannot be judged by them: it is unknown.", VISTA_PARAMETER_FLOAT, 0.15, 0.0, 1.0, "", 0, NULL}, offsetof(vista_parameters, region.min_valid_fraction)},
    {{"region.min_inlier_fraction", "", "Edge consistency: part of the valid boundary pixels on one surface from which on the boundary speaks no more against an obstacle.", VISTA_PARAMETER_FLOAT, 0.2, 0.0, 1.0, "", 0, NULL}, offsetof(vista_parameters, region.min_inlier_fraction)},
    {{"region.outline_fraction", "", "Smallest part of its left edge, right edge and foot that has to agree on the depth of a region without disparities.", VISTA_PARAMETER_FLOAT, 0.5, 0.0, 1.0, "", 0, NULL}, offsetof(vista_parameters, region.outline_fraction)},
    {{"region.foot_m", "m", "The foot of such a region is within this of the ground's plane. At most 6 % of the range.", VISTA_PARAMETER_FLOAT, 0.75, 0.0, 10.0, "", 0, NULL}, offsetof(vista_parameters, region.foot_m)},
    {{"region.min_height_m", "m", "What is lower than this above the horizontal surface that it adjoins lies on it. At most 6 % of the range.", VISTA_PARAMETER_FLOAT, 0.3, 0.0, 10.0, "", 0, NULL}, offsetof(vista_parameters, region.min_height_m)},
    {{"region.min_standing_fraction", "", "A region of which a smaller part stands min_height_m above the ground lies on it.", VISTA_PARAMETER_FLOAT, 0.3, 0.0, 1.0, "", 0, NULL}, offsetof(vista_parameters, region.min_standing_fraction)},
    {{"region.top_height_m", "m", "Words higher than this above the ground weigh more. At most in proportion to min_height_m.", VISTA_PARAMETER_FLOAT, 0.8, 0.01, 100.0, "", 0, NULL}, offsetof(vista_parameters, region.top_height_m)},
    {{"region.odds_prior", "ln odds", "Log-odds of a region that is an obstacle, before anything is known of it.", VISTA_PARAMETER_FLOAT, -2.2, -100.0, 100.0, "", 0, NULL}, offsetof(vista_parameters, region.odds_prior)},
    {{"region.odds_standing", "ln odds", "Log-odds added by words that all stand min_height_m above the ground.", VISTA_PARAMETER_FLOAT, 2.2, -100.0, 100.0, "", 0, NULL}, offsetof(vista_parameters, region.odds_standing)},
    {{"region.odds_top", "ln odds", "Log-odds added by words that all stand top_height_m above the ground.", VISTA_PARAMETER_FLOAT, 1.4, -100.0, 100.0, "", 0, NULL}, offsetof(vista_parameters, region.odds_top)},
    {{"region.odds_boundary", "ln odds", "Log-odds added by a boundary none of whose words lie on one surface (edge consistency); in proportion for fewer than min_inlier_fraction.", VISTA_PARAMETER_FLOAT, -4.0, -100.0, 100.0, "", 0, NULL}, offsetof(vista_parameters, region.odds_boundary)},
    {{"region.odds_support", "ln odds", "Log-odds added by a boundary whose pixels all have a word.", VISTA_PARAMETER_FLOAT, 0.4, -100.0, 100.0, "", 0, NULL}, offsetof(vista_parameters, region.odds_support)},
    {{"region.odds_size", "ln odds", "Log-odds added by each tenfold of a metre in size.", VISTA_PARAMETER_FLOAT, 0.4, -100.0, 100.0, "", 0, NULL}, offsetof(vista_parameters, region.odds_size)},
    {{"region.odds_unseeded", "ln odds", "Log-odds added to a region that grew from no disparity of its own.", VISTA_PARAMETER_FLOAT, -0.4, -100.0, 100.0, "", 0, NULL}, offsetof(vista_parameters, region.odds_unseeded)},
    {{"region.odds_lean", "ln odds", "Log-odds added by a surface that lies flat, 15 degrees and more beyond surface.horizontal_deg.", VISTA_PARAMETER_FLOAT, -1.0, -100.0, 100.0, "", 0, NULL}, offsetof(vista_parameters, region.odds_lean)},
    {{"reconstruction.center_sigma_px", "px", "Noise of a region's centre, along u and v each.", VISTA_PARAMETER_FLOAT, 1.0, 0.01, 100.0, "", 0, NULL}, offsetof(vista_parameters, reconstruction.center_sigma_px)},
    {{"reconstruction.center_sigma_ratio", "", "The same as a share of the region's half width or height: the segmentation moves the centre of a large region by more.", VISTA_PARAMETER_FLOAT, 0.1, 0.0, 2.0, "", 0, NULL}, offsetof(vista_parameters, reconstruction.center_sigma_ratio)},
    {{"reconstruction.disparity_sigma_px", "px", "Noise of the boundary disparity that no averaging removes.", VISTA_PARAMETER_FLOAT, 0.12, 0.01, 16.0, "", 0, NULL}, offsetof(vista_parameters, reconstruction.disparity_sigma_px)},
    {{"reconstruction.correlated_pixels", "pixels", "Boundary inliers that share one matching block: n / this of them count as independent.", VISTA_PARAMETER_FLOAT, 60.0, 1.0, 1000.0, "", 0, NULL}, offsetof(vista_parameters, reconstruction.correlated_pixels)},
    {{"reconstruction.disparity_min_px", "px", "Smaller disparities are not reconstructed.", VISTA_PARAMETER_FLOAT, 1.0, 0.1, 255.0, "", 0, NULL}, offsetof(vista_parameters, reconstruction.disparity_min_px)},
    {{"tracker.velocity_sigma_m_s", "m/s", "Prior of an obstacle's velocity, each axis: obstacles are mostly static.", VISTA_PARAMETER_FLOAT, 0.5, 0.001, 100.0, "", 0, NULL}, offsetof(vista_parameters, tracker.velocity_sigma_m_s)},
    {{"tracker.moving_sigma_m_s", "m/s", "Prior of the velocity of what moves, each axis: of a track seen once whose next detection no track explains as standing.", VISTA_PARAMETER_FLOAT, 6.0, 0.0, 1000.0, "", 0, NULL}, offsetof(vista_parameters, tracker.moving_sigma_m_s)},
    {{"tracker.acceleration_psd_m2_s3", "m2/s3", "Spectral density of the white acceleration, each axis.", VISTA_PARAMETER_FLOAT, 0.01, 0.0, 1000.0, "", 0, NULL}, offsetof(vista_parameters, tracker.acceleration_psd_m2_s3)},
    {{"tracker.position_psd_m2_s", "m2/s", "Random walk of the point that stands for the obstacle: regions change from frame to frame.", VISTA_PARAMETER_FLOAT, 0.01, 0.0, 100.0, "", 0, NULL}, offsetof(vista_parameters, tracker.position_psd_m2_s)},
    {{"tracker.attitude_sigma_deg", "deg", "Error of the pose's attitude, each axis; adds to the noise of u and v.", VISTA_PARAMETER_FLOAT, 0.05, 0.0, 10.0, "", 0, NULL}, offsetof(vista_parameters, tracker.attitude_sigma_deg)},
    {{"tracker.gate_chi2", "", "Mahalanobis gate in (u, v, d): chi-square with 3 degrees of freedom, 11.34 holds 99 percent.", VISTA_PARAMETER_FLOAT, 11.34, 0.1, 1000.0, "", 0, NULL}, offsetof(vista_parameters, tracker.gate_chi2)},
    {{"tracker.extent_sigma_ratio", "", "Noise of the natural logarithm of a measured width or height.", VISTA_PARAMETER_FLOAT, 0.3, 0.01, 10.0, "", 0, NULL}, offsetof(vista_parameters, tracker.extent_sigma_ratio)},
    {{"tracker.extent_psd_1_s", "1/s", "Random walk of the logarithm of width and height.", VISTA_PARAMETER_FLOAT, 0.02, 0.0, 100.0, "", 0, NULL}, offsetof(vista_parameters, tracker.extent_psd_1_s)},
    {{"tracker.overlap_sigma", "", "Depth gate for lying within a track, standard deviations of the disparity difference.", VISTA_PARAMETER_FLOAT, 3.0, 0.1, 100.0, "", 0, NULL}, offsetof(vista_parameters, tracker.overlap_sigma)},
    {{"tracker.overlap_scale", "", "Half extents around a track's centre that count as within it.", VISTA_PARAMETER_FLOAT, 1.2, 0.1, 10.0, "", 0, NULL}, offsetof(vista_parameters, tracker.overlap_scale)},
    {{"tracker.confirm_hits", "frames", "A track is confirmed at this many hits in confirm_window frames; at one more while own travel could tell, but does not yet, that it stands.", VISTA_PARAMETER_INT, 4, 1, 32, "tracker.confirm_window", 0, NULL}, offsetof(vista_parameters, tracker.confirm_hits)},
    {{"tracker.confirm_window", "frames", "Frames, in which the track could be seen, that count for its confirmation.", VISTA_PARAMETER_INT, 6, 1, 32, "", 0, NULL}, offsetof(vista_parameters, tracker.confirm_window)},
    {{"tracker.moved_hits", "frames", "A track that moves needs this many hits, and has this many frames, more to be confirmed.", VISTA_PARAMETER_INT, 2, 0, 16, "", 0, NULL}, offsetof(vista_parameters, tracker.moved_hits)},
    {{"tracker.volume_pixels", "pixels", "A region is in the collision volume when at least this many of its pixels are.", VISTA_PARAMETER_INT, 8, 0, 1000000, "", 0, NULL}, offsetof(vista_parameters, tracker.volume_pixels)},
    {{"tracker.static_odds", "", "Likelihood ratio at which a track is held to stand still, or, inverted, to move with the aircraft as a mismatched texture does.", VISTA_PARAMETER_FLOAT, 6.0, 1.0, 1000000.0, "", 0, NULL}, offsetof(vista_parameters, tracker.static_odds)},
    {{"tracker.static_tolerance", "", "Motion along the line of sight, as a share of own travel, that what stands may seem to make: regions change on approach.", VISTA_PARAMETER_FLOAT, 0.05, 0.0, 1.0, "", 0, NULL}, offsetof(vista_parameters, tracker.static_tolerance)},
    {{"tracker.static_noise_hits", "hits", "Hits in a row whose range errors are about the same: they count as one.", VISTA_PARAMETER_FLOAT, 1.4, 1.0, 100.0, "", 0, NULL}, offsetof(vista_parameters, tracker.static_noise_hits)},
    {{"tracker.static_fade_m", "m", "Own travel over which earlier hits lose their say about that.", VISTA_PARAMETER_FLOAT, 20.0, 0.1, 100000.0, "", 0, NULL}, offsetof(vista_parameters, tracker.static_fade_m)},
    {{"tracker.static_speed_min_m_s", "m/s", "Slower than this along its line of sight, own travel tells nothing of a track: single frames have to do.", VISTA_PARAMETER_FLOAT, 0.5, 0.0, 100.0, "", 0, NULL}, offsetof(vista_parameters, tracker.static_speed_min_m_s)},
    {{"tracker.miss_max", "frames", "Misses in a row that a confirmed track survives.", VISTA_PARAMETER_INT, 4, 0, 1000, "", 0, NULL}, offsetof(vista_parameters, tracker.miss_max)},
    {{"tracker.out_of_view_s", "s", "A track outside the matched part of the image, which is not in the way, coasts for this long.", VISTA_PARAMETER_FLOAT, 0.3, 0.0, 3600.0, "", 0, NULL}, offsetof(vista_parameters, tracker.out_of_view_s)},
    {{"tracker.blind_zone_s", "s", "A track nearer than the engine matches coasts for this long, unless it is passed before.", VISTA_PARAMETER_FLOAT, 30.0, 0.0, 3600.0, "", 0, NULL}, offsetof(vista_parameters, tracker.blind_zone_s)},
    {{"tracker.range_max_m", "m", "Farther detections start no track.", VISTA_PARAMETER_FLOAT, 150.0, 1.0, 100000.0, "", 0, NULL}, offsetof(vista_parameters, tracker.range_max_m)},
    {{"tracker.follow_s", "s", "A track without a detection, not in the way, is followed by the words at its place for this long.", VISTA_PARAMETER_FLOAT, 1.0, 0.0, 3600.0, "", 0, NULL}, offsetof(vista_parameters, tracker.follow_s)},
    {{"tracker.hold_s", "s", "A track whose place shows no words coasts for this long before it counts as missed.", VISTA_PARAMETER_FLOAT, 0.3, 0.0, 3600.0, "", 0, NULL}, offsetof(vista_parameters, tracker.hold_s)},
    {{"blind_zone.contrast", "grey levels", "A pixel whose two neighbours along the row differ by this has texture.", VISTA_PARAMETER_INT, 16, 1, 255, "", 0, NULL}, offsetof(vista_parameters, blind_zone.contrast)},
    {{"blind_zone.textured_fraction", "", "With less of the disc textured, nothing can be said.", VISTA_PARAMETER_FLOAT, 0.05, 0.001, 1.0, "", 0, NULL}, offsetof(vista_parameters, blind_zone.textured_fraction)},
    {{"blind_zone.unmatched_fraction", "", "Something is too near when this share of the texture is not matched; in ordinary views it is 0.03 to 0.6.", VISTA_PARAMETER_FLOAT, 0.9, 0.0, 1.0, "", 0, NULL}, offsetof(vista_parameters, blind_zone.unmatched_fraction)},
    {{"blind_zone.confirm_hits", "frames", "It is reported when it was so in this many of confirm_window frames.", VISTA_PARAMETER_INT, 3, 1, 32, "blind_zone.confirm_window", 0, NULL}, offsetof(vista_parameters, blind_zone.confirm_hits)},
    {{"blind_zone.confirm_window", "frames", "Frames that count for that.", VISTA_PARAMETER_INT, 5, 1, 32, "", 0, NULL}, offsetof(vista_parameters, blind_zone.confirm_window)},
    {{"blind_zone.contrast_noise", "sigma of the image's noise", "The same against the noise of the image; the larger of the two holds. Of pure noise, one pixel in 200 exceeds 4.", VISTA_PARAMETER_FLOAT, 4.0, 0.0, 100.0, "", 0, NULL}, offsetof(vista_parameters, blind_zone.contrast_noise)},
    {{"blind_zone.repeated_fraction", "", "Nothing is reported when this share of the unmatched texture repeats itself along its rows, as windows do: it is ambiguous at any range.", VISTA_PARAMETER_FLOAT, 0.5, 0.0, 1.0, "", 0, NULL}, offsetof(vista_parameters, blind_zone.repeated_fraction)},
    {{"obstacle_map.collision_radius_m", "m", "Radius of the collision volume around the flight path.", VISTA_PARAMETER_FLOAT, 2.0, 0.01, 1000.0, "", 0, NULL}, offsetof(vista_parameters, obstacle_map.collision_radius_m)},
    {{"obstacle_map.collision_length_m", "m", "Length of the collision volume, from the camera.", VISTA_PARAMETER_FLOAT, 100.0, 0.1, 100000.0, "", 0, NULL}, offsetof(vista_parameters, obstacle_map.collision_length_m)},
    {{"obstacle_map.inflation_sigma", "", "Standard deviations of the bearing that are added to an obstacle's semi-axes.", VISTA_PARAMETER_FLOAT, 1.0, 0.0, 10.0, "", 0, NULL}, offsetof(vista_parameters, obstacle_map.inflation_sigma)},
    {{"obstacle_map.lasting_disparity_px", "px", "Error of an obstacle's disparity that lasts from frame to frame: no filter averages it out; adds to the covariance.", VISTA_PARAMETER_FLOAT, 0.02, 0.0, 16.0, "", 0, NULL}, offsetof(vista_parameters, obstacle_map.lasting_disparity_px)},
    {{"obstacle_map.lasting_range_m", "m", "The same in depth, of the surface that the region's boundary shows; the larger part near the camera.", VISTA_PARAMETER_FLOAT, 0.02, 0.0, 10.0, "", 0, NULL}, offsetof(vista_parameters, obstacle_map.lasting_range_m)},
    {{"obstacle_map.lasting_center_px", "px", "The same of its centre: matching widens a thing more to one side than to the other.", VISTA_PARAMETER_FLOAT, 0.5, 0.0, 100.0, "", 0, NULL}, offsetof(vista_parameters, obstacle_map.lasting_center_px)},
    {{"obstacle_map.lasting_center_ratio", "", "The same, as a share of half of what its longer side has more than the shorter one: a region may lack the end of a long thing all along.", VISTA_PARAMETER_FLOAT, 0.15, 0.0, 2.0, "", 0, NULL}, offsetof(vista_parameters, obstacle_map.lasting_center_ratio)},
    {{"obstacle_map.closing_min_m_s", "m/s", "No time to collision is given for what closes slower than this.", VISTA_PARAMETER_FLOAT, 0.5, 0.0, 100.0, "", 0, NULL}, offsetof(vista_parameters, obstacle_map.closing_min_m_s)},
    {{"obstacle_map.outline_px", "px", "Pixels by which matching widens a thing to each side: so much nearer to the path has a pixel to be, to be in the collision volume.", VISTA_PARAMETER_FLOAT, 3.5, 0.0, 100.0, "", 0, NULL}, offsetof(vista_parameters, obstacle_map.outline_px)},
    {{"obstacle_map.lasting_scatter", "", "The same in u, v and disparity, as a share of the scatter of its detections: a region that wanders may be wrong for long.", VISTA_PARAMETER_FLOAT, 0.3, 0.0, 10.0, "", 0, NULL}, offsetof(vista_parameters, obstacle_map.lasting_scatter)},
    {{"obstacle_map.thickness_ratio", "", "The middle of a thing lies this share of half its smaller side behind the surface that is seen, uncertain by as much: 0 for a board, 1 for a ball.", VISTA_PARAMETER_FLOAT, 0.5, 0.0, 1.0, "", 0, NULL}, offsetof(vista_parameters, obstacle_map.thickness_ratio)},
    {{"obstacle_map.seen_min_fraction", "", "The flight path is seen as far as this share of the collision volume's cross-section has disparities in regions that could be judged.", VISTA_PARAMETER_FLOAT, 0.2, 0.0, 1.0, "", 0, NULL}, offsetof(vista_parameters, obstacle_map.seen_min_fraction)},
    {{"health.degraded_fraction", "", "A frame is degraded when less than this of the pixels that can be matched has a disparity; in a noisy image one that another one, a block away, agrees with.", VISTA_PARAMETER_FLOAT, 0.1, 0.0, 1.0, "", 0, NULL}, offsetof(vista_parameters, health.degraded_fraction)},
    {{"health.blind_fraction", "", "With less than this it is blind.", VISTA_PARAMETER_FLOAT, 0.02, 0.0, 1.0, "health.degraded_fraction", 0, NULL}, offsetof(vista_parameters, health.blind_fraction)},
    {{"health.contrast_min", "grey levels", "It is blind, too, when the standard deviation of the cells' grey levels is smaller, without what is left of the image's noise.", VISTA_PARAMETER_FLOAT, 2.0, 0.0, 255.0, "", 0, NULL}, offsetof(vista_parameters, health.contrast_min)},
    {{"health.noise_min", "grey levels", "An image with more noise than this is noisy: chance matches part of it, and only disparities that agree with others count.", VISTA_PARAMETER_FLOAT, 6.0, 0.0, 255.0, "", 0, NULL}, offsetof(vista_parameters, health.noise_min)},
    {{"words.cluster_px", "px", "Words that hang together and cover less, in pixels of their level, are dropped; 0: none are.", VISTA_PARAMETER_INT, 150, 0, 1000000, "", 0, NULL}, offsetof(vista_parameters, words.cluster_px)},
    {{"words.support", "", "A word of a coarser level is taken where at least this share of the 5x5 pixels around it has a word.", VISTA_PARAMETER_FLOAT, 0.92, 0.0, 1.0, "", 0, NULL}, offsetof(vista_parameters, words.support)},
    {{"words.contradiction_px", "px", "A word gives way to that of the next coarser level when they differ by more, in pixels of that level.", VISTA_PARAMETER_FLOAT, 2.0, 0.0, 256.0, "", 0, NULL}, offsetof(vista_parameters, words.contradiction_px)},
    {{"words.filling_levels", "", "As many coarser levels fill surfaces where the finer ones have no word; the others only add what is too near for level 0.", VISTA_PARAMETER_INT, 0, 0, 3, "", 0, NULL}, offsetof(vista_parameters, words.filling_levels)},
    {{"words.gap_px", "px", "Words of a row hang together across gaps up to twice this wide.", VISTA_PARAMETER_INT, 3, 0, 16, "", 0, NULL}, offsetof(vista_parameters, words.gap_px)},
    {{"words.cluster_px_noise", "px per grey level", "cluster_px is at least this times the image's noise: chance matches of a noisy image are larger.", VISTA_PARAMETER_FLOAT, 35.0, 0.0, 100000.0, "", 0, NULL}, offsetof(vista_parameters, words.cluster_px_noise)},
    {{"terrain.lean_min_deg", "deg", "A surface below the path that leans more than this from the vertical is ground; steeper ones are things that stand.", VISTA_PARAMETER_FLOAT, 35.0, 0.0, 90.0, "", 0, NULL}, offsetof(vista_parameters, terrain.lean_min_deg)},
    {{"terrain.angle_min_deg", "deg", "The path meets the ground when it descends on it at this angle at least; at less it is flown along.", VISTA_PARAMETER_FLOAT, 2.5, 0.1, 90.0, "", 0, NULL}, offsetof(vista_parameters, terrain.angle_min_deg)},
    {{"terrain.clearance_share", "", "The collision volume reaches down by this share of the distance from the ground's surface at most: who flies low along it is no nearer to hitting it.", VISTA_PARAMETER_FLOAT, 0.8, 0.0, 1.0, "", 0, NULL}, offsetof(vista_parameters, terrain.clearance_share)},
    {{"terrain.agree_fraction", "", "Of the words where the volume meets the ground, this share has to lie on its surface.", VISTA_PARAMETER_FLOAT, 0.6, 0.0, 1.0, "", 0, NULL}, offsetof(vista_parameters, terrain.agree_fraction)},
    {{"thin.find", "", "Whether they are looked for.", VISTA_PARAMETER_CHOICE, 1, 0, 1, "", 2, thin_find_choices}, offsetof(vista_parameters, thin.find)},
    {{"thin.contrast", "grey levels", "Contrast of a thin line to both of its sides that counts in full; more counts no more.", VISTA_PARAMETER_FLOAT, 8.0, 1.0, 255.0, "", 0, NULL}, offsetof(vista_parameters, thin.contrast)},
    {{"thin.contrast_noise", "sigma of the image's noise", "The same against the noise of the image; the larger of the two holds.", VISTA_PARAMETER_FLOAT, 3.0, 0.0, 100.0, "", 0, NULL}, offsetof(vista_parameters, thin.contrast_noise)},
    {{"thin.piece_sum", "", "Sixteen rows of a line are a piece of it when their contrasts add up to at least this share of the full ones.", VISTA_PARAMETER_FLOAT, 0.55, 0.0, 1.0, "", 0, NULL}, offsetof(vista_parameters, thin.piece_sum)},
    {{"thin.pieces_min", "pieces", "A line has at least so many pieces.", VISTA_PARAMETER_INT, 5, 2, 1000, "", 0, NULL}, offsetof(vista_parameters, thin.pieces_min)},
    {{"thin.piece_share", "", "From its first to its last piece, a line has one in at least this share of the sixteens of rows.", VISTA_PARAMETER_FLOAT, 0.3, 0.0, 1.0, "", 0, NULL}, offsetof(vista_parameters, thin.piece_share)},
    {{"thin.straight_px", "px", "Largest root mean square distance of a line's pieces from the straight line through them, along the row.", VISTA_PARAMETER_FLOAT, 0.9, 0.0, 100.0, "", 0, NULL}, offsetof(vista_parameters, thin.straight_px)},
    {{"thin.ridge_share", "", "Smallest share of a line's rows that show it.", VISTA_PARAMETER_FLOAT, 0.4, 0.0, 1.0, "", 0, NULL}, offsetof(vista_parameters, thin.ridge_share)},
    {{"thin.apart_px", "px", "A word on the line tells of a thin thing when it is nearer by this than those beside it.", VISTA_PARAMETER_FLOAT, 1.0, 0.0, 256.0, "", 0, NULL}, offsetof(vista_parameters, thin.apart_px)},
    {{"thin.agree_px", "px", "Such words agree with a straight line in space within this.", VISTA_PARAMETER_FLOAT, 0.6, 0.01, 16.0, "", 0, NULL}, offsetof(vista_parameters, thin.agree_px)},
    {{"thin.agree_share", "", "Smallest share of these words that agree.", VISTA_PARAMETER_FLOAT, 0.7, 0.0, 1.0, "", 0, NULL}, offsetof(vista_parameters, thin.agree_share)},
    {{"thin.rows_min", "rows", "Fewest rows whose words agree.", VISTA_PARAMETER_INT, 24, 2, 100000, "", 0, NULL}, offsetof(vista_parameters, thin.rows_min)},
    {{"thin.row_share", "", "Smallest share of the line's rows whose words agree.", VISTA_PARAMETER_FLOAT, 0.1, 0.0, 1.0, "", 0, NULL}, offsetof(vista_parameters, thin.row_share)},
    {{"thin.word_share", "", "Smallest share of the rows with any word on the line whose words agree; the others are of what is behind.", VISTA_PARAMETER_FLOAT, 0.27, 0.0, 1.0, "", 0, NULL}, offsetof(vista_parameters, thin.word_share)},
    {{"thin.rows_sure", "rows", "So many rows whose words agree are enough, whatever share of the words that is.", VISTA_PARAMETER_INT, 40, 2, 100000, "", 0, NULL}, offsetof(vista_parameters, thin.rows_sure)},
    {{"thin.level_share", "", "Largest share of the line's rows that have something beside it as near as itself: a line on a surface is no thing of its own.", VISTA_PARAMETER_FLOAT, 0.25, 0.0, 1.0, "", 0, NULL}, offsetof(vista_parameters, thin.level_share)},
    {{"thin.length_m", "m", "Shortest line.", VISTA_PARAMETER_FLOAT, 1.5, 0.0, 1000.0, "", 0, NULL}, offsetof(vista_parameters, thin.length_m)},
    {{"thin.height_m", "m", "More than half of a line stands at least this far above the ground.", VISTA_PARAMETER_FLOAT, 0.5, 0.0, 100.0, "", 0, NULL}, offsetof(vista_parameters, thin.height_m)},
};

_Static_assert(sizeof(vista_stereo_params) == 256, "stereo may not grow");
_Static_assert(sizeof(vista_motion_params) == 256, "motion may not grow");
_Static_assert(sizeof(vista_foveation_params) == 256, "foveation may not grow");
_Static_assert(sizeof(vista_affinity_params) == 256, "affinity may not grow");
_Static_assert(sizeof(vista_surface_params) == 256, "surface may not grow");
_Static_assert(sizeof(vista_segmentation_params) == 256, "segmentation may not grow");
_Static_assert(sizeof(vista_refinement_params) == 256, "refinement may not grow");
_Static_assert(sizeof(vista_region_params) == 256, "region may not grow");
_Static_assert(sizeof(vista_reconstruction_params) == 256, "reconstruction may not grow");
_Static_assert(sizeof(vista_tracker_params) == 256, "tracker may not grow");
_Static_assert(sizeof(vista_blind_zone_params) == 256, "blind_zone may not grow");
_Static_assert(sizeof(vista_obstacle_map_params) == 256, "obstacle_map may not grow");
_Static_assert(sizeof(vista_health_params) == 256, "health may not grow");
_Static_assert(sizeof(vista_words_params) == 256, "words may not grow");
_Static_assert(sizeof(vista_terrain_params) == 256, "terrain may not grow");
_Static_assert(sizeof(vista_thin_params) == 256, "thin may not grow");

#endif
