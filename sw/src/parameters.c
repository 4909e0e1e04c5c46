/* Generated from sw/parameters.toml by scripts/make_parameters.py; do not edit. */
#include "vista/parameters.h"

#include <stdbool.h>
#include <stddef.h>

vista_parameters vista_parameters_default(void) {
  return (vista_parameters){
      .stereo.num_disparities = 64,
      .stereo.block_size = 11,
      .stereo.prefilter = VISTA_STEREO_PREFILTER_XSOBEL,
      .stereo.prefilter_cap = 31,
      .stereo.texture_threshold = 10,
      .stereo.uniqueness_ratio = 15,
      .stereo.lr_max_diff = 1,
      .foveation.sector_count = 128,
      .foveation.rho_0_px = 4.0,
      .foveation.min_valid_fraction = 0.3,
      .affinity.form = VISTA_AFFINITY_FORM_PRODUCT,
      .affinity.alpha_intensity = 0.5,
      .affinity.mu_intensity = 2.0,
      .affinity.sigma_intensity = 10.0,
      .affinity.mu_disparity_px = 0.5,
      .affinity.mu_disparity_slope = 0.1,
      .affinity.mu_depth_m = 0.5,
      .affinity.sigma_disparity_px = 1.0,
      .affinity.flow_encoding = VISTA_AFFINITY_FLOW_ENCODING_EXPONENTIAL,
      .affinity.flow_scale = 10000.0,
      .affinity.flow_constant = 10000.0,
      .surface.lever_px = 8.0,
      .surface.horizontal_deg = 65.0,
      .segmentation.core_step_px = 0.5,
      .segmentation.core_step_slope = 0.03,
      .segmentation.core_step_m = 0.5,
      .segmentation.core_area_px2 = 60.0,
      .segmentation.reach = 12,
      .segmentation.unknown_link = 0.03,
      .segmentation.mismatch_link = 0.5,
      .segmentation.horizontal_link = 2.0,
      .segmentation.merge_ratio = 2.0,
      .segmentation.merge_share = 0.1,
      .segmentation.rest_affinity = 0.5,
      .segmentation.rest_area_px2 = 400.0,
      .region.tolerance_px = 1.0,
      .region.tolerance_m = 0.5,
      .region.min_inliers = 60,
      .region.min_disparity_px = 2.5,
      .region.min_size_m = 0.35,
      .region.min_valid_fraction = 0.25,
      .region.min_inlier_fraction = 0.5,
      .region.max_sigma_ratio = 0.55,
      .region.min_height_m = 0.3,
      .region.min_standing_fraction = 0.3,
  };
}

static bool within(double value, double low, double high) { return value >= low && value <= high; }

vista_status vista_parameters_check(const vista_parameters *parameters, const char **culprit) {
  if (parameters == NULL) return VISTA_ERROR_ARGUMENT;
  const vista_parameters *const p = parameters;
  const char *wrong = NULL;
  if (!within((double)p->stereo.num_disparities, 16, 256)) wrong = "stereo.num_disparities";
  else if (!within((double)p->stereo.block_size, 5, 21)) wrong = "stereo.block_size";
  else if (!within((double)p->stereo.prefilter, 0, 1)) wrong = "stereo.prefilter";
  else if (!within((double)p->stereo.prefilter_cap, 1, 63)) wrong = "stereo.prefilter_cap";
  else if (!within((double)p->stereo.texture_threshold, 0, 65535)) wrong = "stereo.texture_threshold";
  else if (!within((double)p->stereo.uniqueness_ratio, 0, 100)) wrong = "stereo.uniqueness_ratio";
  else if (!within((double)p->stereo.lr_max_diff, -1, 255)) wrong = "stereo.lr_max_diff";
  else if (!within((double)p->foveation.sector_count, 16, 256)) wrong = "foveation.sector_count";
  else if (!within(p->foveation.rho_0_px, 1.0, 64.0)) wrong = "foveation.rho_0_px";
  else if (!within(p->foveation.min_valid_fraction, 0.0, 1.0)) wrong = "foveation.min_valid_fraction";
  else if (!within((double)p->affinity.form, 0, 1)) wrong = "affinity.form";
  else if (!within(p->affinity.alpha_intensity, 0.0, 1.0)) wrong = "affinity.alpha_intensity";
  else if (!within(p->affinity.mu_intensity, 0.0, 255.0)) wrong = "affinity.mu_intensity";
  else if (!within(p->affinity.sigma_intensity, 0.1, 255.0)) wrong = "affinity.sigma_intensity";
  else if (!within(p->affinity.mu_disparity_px, 0.0, 16.0)) wrong = "affinity.mu_disparity_px";
  else if (!within(p->affinity.mu_disparity_slope, 0.0, 1.0)) wrong = "affinity.mu_disparity_slope";
  else if (!within(p->affinity.mu_depth_m, 0.0, 10.0)) wrong = "affinity.mu_depth_m";
  else if (!within(p->affinity.sigma_disparity_px, 0.05, 64.0)) wrong = "affinity.sigma_disparity_px";
  else if (!within((double)p->affinity.flow_encoding, 0, 1)) wrong = "affinity.flow_encoding";
  else if (!within(p->affinity.flow_scale, 10.0, 100000.0)) wrong = "affinity.flow_scale";
  else if (!within(p->affinity.flow_constant, 1.0, 100000000.0)) wrong = "affinity.flow_constant";
  else if (!within(p->surface.lever_px, 1.0, 64.0)) wrong = "surface.lever_px";
  else if (!within(p->surface.horizontal_deg, 10.0, 90.0)) wrong = "surface.horizontal_deg";
  else if (!within(p->segmentation.core_step_px, 0.05, 8.0)) wrong = "segmentation.core_step_px";
  else if (!within(p->segmentation.core_step_slope, 0.0, 1.0)) wrong = "segmentation.core_step_slope";
  else if (!within(p->segmentation.core_step_m, 0.0, 10.0)) wrong = "segmentation.core_step_m";
  else if (!within(p->segmentation.core_area_px2, 1.0, 1000000.0)) wrong = "segmentation.core_area_px2";
  else if (!within((double)p->segmentation.reach, 1, 1000)) wrong = "segmentation.reach";
  else if (!within(p->segmentation.unknown_link, 0.0, 10.0)) wrong = "segmentation.unknown_link";
  else if (!within(p->segmentation.mismatch_link, 0.0, 10.0)) wrong = "segmentation.mismatch_link";
  else if (!within(p->segmentation.horizontal_link, 0.0, 100.0)) wrong = "segmentation.horizontal_link";
  else if (!within(p->segmentation.merge_ratio, 0.0, 100.0)) wrong = "segmentation.merge_ratio";
  else if (!within(p->segmentation.merge_share, 0.0, 1.0)) wrong = "segmentation.merge_share";
  else if (!within(p->segmentation.rest_affinity, 0.0, 1.0)) wrong = "segmentation.rest_affinity";
  else if (!within(p->segmentation.rest_area_px2, 1.0, 1000000.0)) wrong = "segmentation.rest_area_px2";
  else if (!within(p->region.tolerance_px, 0.1, 16.0)) wrong = "region.tolerance_px";
  else if (!within(p->region.tolerance_m, 0.0, 10.0)) wrong = "region.tolerance_m";
  else if (!within((double)p->region.min_inliers, 1, 1000000)) wrong = "region.min_inliers";
  else if (!within(p->region.min_disparity_px, 0.1, 255.0)) wrong = "region.min_disparity_px";
  else if (!within(p->region.min_size_m, 0.0, 100.0)) wrong = "region.min_size_m";
  else if (!within(p->region.min_valid_fraction, 0.0, 1.0)) wrong = "region.min_valid_fraction";
  else if (!within(p->region.min_inlier_fraction, 0.0, 1.0)) wrong = "region.min_inlier_fraction";
  else if (!within(p->region.max_sigma_ratio, 0.0, 1.0)) wrong = "region.max_sigma_ratio";
  else if (!within(p->region.min_height_m, 0.0, 10.0)) wrong = "region.min_height_m";
  else if (!within(p->region.min_standing_fraction, 0.0, 1.0)) wrong = "region.min_standing_fraction";
  if (culprit != NULL) *culprit = wrong;
  return wrong == NULL ? VISTA_OK : VISTA_ERROR_RANGE;
}
