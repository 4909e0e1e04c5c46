/* Generated from sw/parameters.toml by scripts/make_parameters.py; do not edit. */
#ifndef VISTA_PARAMETERS_H
#define VISTA_PARAMETERS_H

#include <stdint.h>

#include "vista/status.h"

/* The stereo engine (its contract: model/README.md). */
typedef enum vista_stereo_prefilter { VISTA_STEREO_PREFILTER_XSOBEL, VISTA_STEREO_PREFILTER_NONE } vista_stereo_prefilter;

typedef struct vista_stereo_params {
  int32_t num_disparities; /* Candidates 0 .. num_disparities - 1, a multiple of 16. The paper's Acadia had 32; 64 halve the blind zone. 16 .. 256 px. */
  int32_t block_size; /* Side of the matching block, odd. 5 .. 21 px. */
  vista_stereo_prefilter prefilter; /* What is matched: the horizontal Sobel response, or the grey levels themselves (the Acadia's plain SAD). */
  int32_t prefilter_cap; /* Clamp of the Sobel response. 1 .. 63. */
  int32_t texture_threshold; /* Blocks with less texture are invalid. 0 .. 65535. */
  int32_t uniqueness_ratio; /* Margin of the best match over all that do not adjoin it. 0 .. 100 percent. */
  int32_t lr_max_diff; /* Largest difference of the left and the right winner; -1: no left/right check. -1 .. 255 px. */
} vista_stereo_params;

/* Log-polar grid (paper, section II-B). */
typedef struct vista_foveation_params {
  int32_t sector_count; /* Sectors of the log-polar grid; rings grow by exp(2*pi/sector_count), which keeps cells square. 16 .. 256. */
  double rho_0_px; /* Radius of the hub, the one cell at the centre. Paper: rho_0. 1.0 .. 64.0 px. */
  double min_valid_fraction; /* A cell has a disparity when at least this fraction of its pixels has one. 0.0 .. 1.0. */
} vista_foveation_params;

/* Similarity of neighbouring cells (paper, equations 3 and 4) and its encoding as flow (equation 5). */
typedef enum vista_affinity_form { VISTA_AFFINITY_FORM_PRODUCT, VISTA_AFFINITY_FORM_SUM } vista_affinity_form;

typedef enum vista_affinity_flow_encoding { VISTA_AFFINITY_FLOW_ENCODING_EXPONENTIAL, VISTA_AFFINITY_FLOW_ENCODING_LINEAR } vista_affinity_flow_encoding;

typedef struct vista_affinity_params {
  vista_affinity_form form; /* How the feature terms combine: their weighted sum is the paper's equation 3, their product measures better. */
  double alpha_intensity; /* Weight of the intensity term in the sum form; the disparity term has the rest. Paper: alpha_d. 0.0 .. 1.0. */
  double mu_intensity; /* Intensity difference that still counts as none. Paper: mu_d. 0.0 .. 255.0 grey levels. */
  double sigma_intensity; /* Scale of the intensity term. Paper: sigma_d. 0.1 .. 255.0 grey levels. */
  double mu_disparity_px; /* Disparity difference that still counts as none between adjoining cells. Paper: mu_d. 0.0 .. 16.0 px. */
  double mu_disparity_slope; /* Added to mu_disparity_px per pixel between the cell centres: cells of the periphery lie farther apart. Paper: mu_d. 0.0 .. 1.0 px per px. */
  double mu_depth_m; /* A disparity difference that means less depth than this counts as none: near things have relief. Paper: mu_d. 0.0 .. 10.0 m. */
  double sigma_disparity_px; /* Scale of the disparity term. Paper: sigma_d. 0.05 .. 64.0 px. */
  vista_affinity_flow_encoding flow_encoding; /* Capacity = scale * C^((w - 1) / 2), or the paper's print, scale * (w + 1) / 2. */
  double flow_scale; /* Capacity of an edge of affinity 1. 10.0 .. 100000.0. */
  double flow_constant; /* Base of the exponential encoding: the square root of it is the ratio of strongest to weakest edge. Paper: C. 1.0 .. 100000000.0. */
} vista_affinity_params;

/* Inclination of the surface under each cell, from the disparities of the cells around it. */
typedef struct vista_surface_params {
  double lever_px; /* Cells at least this far apart are compared, so that the noise of a disparity does not tilt the surface. 1.0 .. 64.0 px. */
  double horizontal_deg; /* A surface that leans more than this from the vertical is one to fly along, not into. 10.0 .. 90.0 deg. */
} vista_surface_params;

/* Recursive minimum cuts (paper, section II-C). */
typedef struct vista_segmentation_params {
  double core_step_px; /* Largest disparity step inside a core between adjoining cells. 0.05 .. 8.0 px. */
  double core_step_slope; /* Added to core_step_px per pixel between the cell centres. 0.0 .. 1.0 px per px. */
  double core_step_m; /* A disparity step that means less depth than this is no step. 0.0 .. 10.0 m. */
  double core_area_px2; /* Smallest core that is cut out. 1.0 .. 1000000.0 px2. */
  int32_t reach; /* A cut takes in free cells up to this many steps from its core. 1 .. 1000 cells. */
  double unknown_link; /* Sink link of a cell without disparity: what it costs to take a textureless cell into an obstacle. Paper: D_p. 0.0 .. 10.0 flow_scale. */
  double mismatch_link; /* Sink link of a free cell per pixel of disparity beyond the core's own range, at most four times this. Paper: D_p. 0.0 .. 10.0 flow_scale. */
  double horizontal_link; /* Sink link of a cell on a horizontal surface. Paper: D_p. 0.0 .. 100.0 flow_scale. */
  double merge_ratio; /* Edges across the boundary of two regions that step by less than this are smooth. 0.0 .. 100.0 core steps. */
  double merge_share; /* Two regions are one if more than half of the edges between them, and this share of the shorter perimeter, are smooth. 0.0 .. 1.0. */
  double rest_affinity; /* Cells that no obstacle claims form cores of the rest along edges of at least this affinity. Paper: w_ij. 0.0 .. 1.0. */
  double rest_area_px2; /* Smallest core of the rest that is cut out. 1.0 .. 1000000.0 px2. */
} vista_segmentation_params;

/* Statistics of the regions and the tests that make obstacles of them (paper, section II-D). */
typedef struct vista_region_params {
  double tolerance_px; /* Boundary disparities within this of the region's surface are its inliers. 0.1 .. 16.0 px. */
  double tolerance_m; /* The same in depth; the larger of the two holds: near things have relief. 0.0 .. 10.0 m. */
  int32_t min_inliers; /* Fewest boundary inliers of an obstacle. 1 .. 1000000 pixels. */
  double min_disparity_px; /* Regions with less are too far to say anything. 0.1 .. 255.0 px. */
  double min_size_m; /* Smallest larger side of an obstacle. 0.0 .. 100.0 m. */
  double min_valid_fraction; /* Smallest valid fraction of the boundary. 0.0 .. 1.0. */
  double min_inlier_fraction; /* Edge consistency: smallest part of the valid boundary pixels that are inliers. 0.0 .. 1.0. */
  double max_sigma_ratio; /* Edge consistency: largest standard deviation of the boundary inliers; evenly spread ones have 0.58. 0.0 .. 1.0 tolerance. */
  double min_height_m; /* What is lower than this above the horizontal surface that it adjoins lies on it. 0.0 .. 10.0 m. */
  double min_standing_fraction; /* Smallest part of an obstacle's area that stands higher than that. 0.0 .. 1.0. */
} vista_region_params;

typedef struct vista_parameters {
  vista_stereo_params stereo;
  vista_foveation_params foveation;
  vista_affinity_params affinity;
  vista_surface_params surface;
  vista_segmentation_params segmentation;
  vista_region_params region;
} vista_parameters;

vista_parameters vista_parameters_default(void);

/* VISTA_OK, or VISTA_ERROR_RANGE (NaN included) with `culprit` set to "section.name"; culprit may be null. */
vista_status vista_parameters_check(const vista_parameters *parameters, const char **culprit);

#endif
