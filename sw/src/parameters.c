/* Generated from sw/parameters.toml by scripts/make_parameters.py; do not edit. */
#include "vista/parameters.h"

#include <stdbool.h>
#include <stddef.h>
#include <string.h>

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
      .surface.horizontal_deg = 55.0,
      .surface.ground_step_px = 0.5,
      .surface.ground_step_m = 0.3,
      .segmentation.seed_step_px = 0.5,
      .segmentation.seed_step_slope = 0.02,
      .segmentation.seed_step_m = 0.5,
      .segmentation.seed_area_px2 = 60.0,
      .segmentation.bridge_m = 2.0,
      .segmentation.shell_px = 6.0,
      .segmentation.reach = 12,
      .segmentation.unknown_link = 0.03,
      .segmentation.mismatch_link = 0.5,
      .segmentation.horizontal_link = 0.3,
      .segmentation.merge_ratio = 2.0,
      .segmentation.merge_share = 0.1,
      .segmentation.rest_affinity = 0.7,
      .segmentation.rest_area_px2 = 60.0,
      .refinement.sigma_intensity = 10.0,
      .refinement.contrast_limit = 3.0,
      .refinement.mixed_penalty = 0.75,
      .refinement.compactness = 1.0,
      .region.boundary_px = 5.0,
      .region.tolerance_px = 1.0,
      .region.tolerance_m = 0.5,
      .region.min_inliers = 60,
      .region.min_disparity_px = 2.5,
      .region.min_size_m = 0.35,
      .region.min_valid_fraction = 0.33,
      .region.min_inlier_fraction = 0.5,
      .region.outline_fraction = 0.5,
      .region.foot_m = 0.75,
      .region.min_height_m = 0.3,
      .region.min_standing_fraction = 0.22,
      .reconstruction.center_sigma_px = 1.0,
      .reconstruction.center_sigma_ratio = 0.1,
      .reconstruction.disparity_sigma_px = 0.12,
      .reconstruction.correlated_pixels = 60.0,
      .reconstruction.disparity_min_px = 1.0,
      .tracker.velocity_sigma_m_s = 0.5,
      .tracker.moving_sigma_m_s = 6.0,
      .tracker.acceleration_psd_m2_s3 = 0.01,
      .tracker.position_psd_m2_s = 0.01,
      .tracker.attitude_sigma_deg = 0.05,
      .tracker.gate_chi2 = 11.34,
      .tracker.extent_sigma_ratio = 0.3,
      .tracker.extent_psd_1_s = 0.02,
      .tracker.overlap_sigma = 3.0,
      .tracker.overlap_scale = 1.2,
      .tracker.confirm_hits = 4,
      .tracker.confirm_window = 6,
      .tracker.moved_hits = 2,
      .tracker.volume_pixels = 8,
      .tracker.static_odds = 6.0,
      .tracker.static_tolerance = 0.05,
      .tracker.static_noise_hits = 1.4,
      .tracker.static_fade_m = 20.0,
      .tracker.static_speed_min_m_s = 0.5,
      .tracker.miss_max = 5,
      .tracker.out_of_view_s = 1.0,
      .tracker.blind_zone_s = 30.0,
      .tracker.range_max_m = 150.0,
      .blind_zone.contrast = 16,
      .blind_zone.textured_fraction = 0.05,
      .blind_zone.unmatched_fraction = 0.9,
      .blind_zone.confirm_hits = 3,
      .blind_zone.confirm_window = 5,
      .obstacle_map.collision_radius_m = 2.0,
      .obstacle_map.collision_length_m = 100.0,
      .obstacle_map.inflation_sigma = 1.0,
      .obstacle_map.lasting_disparity_px = 0.05,
      .obstacle_map.lasting_range_m = 0.05,
      .obstacle_map.lasting_center_px = 2.5,
      .obstacle_map.lasting_center_ratio = 0.08,
      .obstacle_map.velocity_smoothing_s = 0.3,
      .obstacle_map.speed_min_m_s = 0.5,
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
  else if (!within(p->surface.ground_step_px, 0.0, 64.0)) wrong = "surface.ground_step_px";
  else if (!within(p->surface.ground_step_m, 0.0, 10.0)) wrong = "surface.ground_step_m";
  else if (!within(p->segmentation.seed_step_px, 0.05, 8.0)) wrong = "segmentation.seed_step_px";
  else if (!within(p->segmentation.seed_step_slope, 0.0, 1.0)) wrong = "segmentation.seed_step_slope";
  else if (!within(p->segmentation.seed_step_m, 0.0, 10.0)) wrong = "segmentation.seed_step_m";
  else if (!within(p->segmentation.seed_area_px2, 1.0, 1000000.0)) wrong = "segmentation.seed_area_px2";
  else if (!within(p->segmentation.bridge_m, 0.0, 100.0)) wrong = "segmentation.bridge_m";
  else if (!within(p->segmentation.shell_px, 0.0, 64.0)) wrong = "segmentation.shell_px";
  else if (!within((double)p->segmentation.reach, 1, 1000)) wrong = "segmentation.reach";
  else if (!within(p->segmentation.unknown_link, 0.0, 10.0)) wrong = "segmentation.unknown_link";
  else if (!within(p->segmentation.mismatch_link, 0.0, 10.0)) wrong = "segmentation.mismatch_link";
  else if (!within(p->segmentation.horizontal_link, 0.0, 100.0)) wrong = "segmentation.horizontal_link";
  else if (!within(p->segmentation.merge_ratio, 0.0, 100.0)) wrong = "segmentation.merge_ratio";
  else if (!within(p->segmentation.merge_share, 0.0, 1.0)) wrong = "segmentation.merge_share";
  else if (!within(p->segmentation.rest_affinity, 0.0, 1.0)) wrong = "segmentation.rest_affinity";
  else if (!within(p->segmentation.rest_area_px2, 1.0, 1000000.0)) wrong = "segmentation.rest_area_px2";
  else if (!within(p->refinement.sigma_intensity, 0.1, 255.0)) wrong = "refinement.sigma_intensity";
  else if (!within(p->refinement.contrast_limit, 0.0, 100.0)) wrong = "refinement.contrast_limit";
  else if (!within(p->refinement.mixed_penalty, 0.0, 100.0)) wrong = "refinement.mixed_penalty";
  else if (!within(p->refinement.compactness, 0.0, 100.0)) wrong = "refinement.compactness";
  else if (!within(p->region.boundary_px, 0.0, 64.0)) wrong = "region.boundary_px";
  else if (!within(p->region.tolerance_px, 0.1, 16.0)) wrong = "region.tolerance_px";
  else if (!within(p->region.tolerance_m, 0.0, 10.0)) wrong = "region.tolerance_m";
  else if (!within((double)p->region.min_inliers, 1, 1000000)) wrong = "region.min_inliers";
  else if (!within(p->region.min_disparity_px, 0.1, 255.0)) wrong = "region.min_disparity_px";
  else if (!within(p->region.min_size_m, 0.0, 100.0)) wrong = "region.min_size_m";
  else if (!within(p->region.min_valid_fraction, 0.0, 1.0)) wrong = "region.min_valid_fraction";
  else if (!within(p->region.min_inlier_fraction, 0.0, 1.0)) wrong = "region.min_inlier_fraction";
  else if (!within(p->region.outline_fraction, 0.0, 1.0)) wrong = "region.outline_fraction";
  else if (!within(p->region.foot_m, 0.0, 10.0)) wrong = "region.foot_m";
  else if (!within(p->region.min_height_m, 0.0, 10.0)) wrong = "region.min_height_m";
  else if (!within(p->region.min_standing_fraction, 0.0, 1.0)) wrong = "region.min_standing_fraction";
  else if (!within(p->reconstruction.center_sigma_px, 0.01, 100.0)) wrong = "reconstruction.center_sigma_px";
  else if (!within(p->reconstruction.center_sigma_ratio, 0.0, 2.0)) wrong = "reconstruction.center_sigma_ratio";
  else if (!within(p->reconstruction.disparity_sigma_px, 0.01, 16.0)) wrong = "reconstruction.disparity_sigma_px";
  else if (!within(p->reconstruction.correlated_pixels, 1.0, 1000.0)) wrong = "reconstruction.correlated_pixels";
  else if (!within(p->reconstruction.disparity_min_px, 0.1, 255.0)) wrong = "reconstruction.disparity_min_px";
  else if (!within(p->tracker.velocity_sigma_m_s, 0.001, 100.0)) wrong = "tracker.velocity_sigma_m_s";
  else if (!within(p->tracker.moving_sigma_m_s, 0.0, 1000.0)) wrong = "tracker.moving_sigma_m_s";
  else if (!within(p->tracker.acceleration_psd_m2_s3, 0.0, 1000.0)) wrong = "tracker.acceleration_psd_m2_s3";
  else if (!within(p->tracker.position_psd_m2_s, 0.0, 100.0)) wrong = "tracker.position_psd_m2_s";
  else if (!within(p->tracker.attitude_sigma_deg, 0.0, 10.0)) wrong = "tracker.attitude_sigma_deg";
  else if (!within(p->tracker.gate_chi2, 0.1, 1000.0)) wrong = "tracker.gate_chi2";
  else if (!within(p->tracker.extent_sigma_ratio, 0.01, 10.0)) wrong = "tracker.extent_sigma_ratio";
  else if (!within(p->tracker.extent_psd_1_s, 0.0, 100.0)) wrong = "tracker.extent_psd_1_s";
  else if (!within(p->tracker.overlap_sigma, 0.1, 100.0)) wrong = "tracker.overlap_sigma";
  else if (!within(p->tracker.overlap_scale, 0.1, 10.0)) wrong = "tracker.overlap_scale";
  else if (!within((double)p->tracker.confirm_hits, 1, 32)) wrong = "tracker.confirm_hits";
  else if (!within((double)p->tracker.confirm_window, 1, 32)) wrong = "tracker.confirm_window";
  else if (!within((double)p->tracker.moved_hits, 0, 16)) wrong = "tracker.moved_hits";
  else if (!within((double)p->tracker.volume_pixels, 0, 1000000)) wrong = "tracker.volume_pixels";
  else if (!within(p->tracker.static_odds, 1.0, 1000000.0)) wrong = "tracker.static_odds";
  else if (!within(p->tracker.static_tolerance, 0.0, 1.0)) wrong = "tracker.static_tolerance";
  else if (!within(p->tracker.static_noise_hits, 1.0, 100.0)) wrong = "tracker.static_noise_hits";
  else if (!within(p->tracker.static_fade_m, 0.1, 100000.0)) wrong = "tracker.static_fade_m";
  else if (!within(p->tracker.static_speed_min_m_s, 0.0, 100.0)) wrong = "tracker.static_speed_min_m_s";
  else if (!within((double)p->tracker.miss_max, 0, 1000)) wrong = "tracker.miss_max";
  else if (!within(p->tracker.out_of_view_s, 0.0, 3600.0)) wrong = "tracker.out_of_view_s";
  else if (!within(p->tracker.blind_zone_s, 0.0, 3600.0)) wrong = "tracker.blind_zone_s";
  else if (!within(p->tracker.range_max_m, 1.0, 100000.0)) wrong = "tracker.range_max_m";
  else if (!within((double)p->blind_zone.contrast, 1, 255)) wrong = "blind_zone.contrast";
  else if (!within(p->blind_zone.textured_fraction, 0.001, 1.0)) wrong = "blind_zone.textured_fraction";
  else if (!within(p->blind_zone.unmatched_fraction, 0.0, 1.0)) wrong = "blind_zone.unmatched_fraction";
  else if (!within((double)p->blind_zone.confirm_hits, 1, 32)) wrong = "blind_zone.confirm_hits";
  else if (!within((double)p->blind_zone.confirm_window, 1, 32)) wrong = "blind_zone.confirm_window";
  else if (!within(p->obstacle_map.collision_radius_m, 0.01, 1000.0)) wrong = "obstacle_map.collision_radius_m";
  else if (!within(p->obstacle_map.collision_length_m, 0.1, 100000.0)) wrong = "obstacle_map.collision_length_m";
  else if (!within(p->obstacle_map.inflation_sigma, 0.0, 10.0)) wrong = "obstacle_map.inflation_sigma";
  else if (!within(p->obstacle_map.lasting_disparity_px, 0.0, 16.0)) wrong = "obstacle_map.lasting_disparity_px";
  else if (!within(p->obstacle_map.lasting_range_m, 0.0, 10.0)) wrong = "obstacle_map.lasting_range_m";
  else if (!within(p->obstacle_map.lasting_center_px, 0.0, 100.0)) wrong = "obstacle_map.lasting_center_px";
  else if (!within(p->obstacle_map.lasting_center_ratio, 0.0, 2.0)) wrong = "obstacle_map.lasting_center_ratio";
  else if (!within(p->obstacle_map.velocity_smoothing_s, 0.0, 60.0)) wrong = "obstacle_map.velocity_smoothing_s";
  else if (!within(p->obstacle_map.speed_min_m_s, 0.0, 100.0)) wrong = "obstacle_map.speed_min_m_s";
  else if (p->tracker.confirm_hits > p->tracker.confirm_window) wrong = "tracker.confirm_hits";
  else if (p->blind_zone.confirm_hits > p->blind_zone.confirm_window) wrong = "blind_zone.confirm_hits";
  if (culprit != NULL) *culprit = wrong;
  return wrong == NULL ? VISTA_OK : VISTA_ERROR_RANGE;
}

vista_status vista_parameters_set(vista_parameters *parameters, const char *name, double value) {
  if (parameters == NULL || name == NULL) return VISTA_ERROR_ARGUMENT;
  if (!within(value, -1e9, 1e9)) return VISTA_ERROR_RANGE;
  vista_parameters *const p = parameters;
  if (strcmp(name, "stereo.num_disparities") == 0) return p->stereo.num_disparities = (int32_t)value, VISTA_OK;
  if (strcmp(name, "stereo.block_size") == 0) return p->stereo.block_size = (int32_t)value, VISTA_OK;
  if (strcmp(name, "stereo.prefilter") == 0) return p->stereo.prefilter = (vista_stereo_prefilter)(int32_t)value, VISTA_OK;
  if (strcmp(name, "stereo.prefilter_cap") == 0) return p->stereo.prefilter_cap = (int32_t)value, VISTA_OK;
  if (strcmp(name, "stereo.texture_threshold") == 0) return p->stereo.texture_threshold = (int32_t)value, VISTA_OK;
  if (strcmp(name, "stereo.uniqueness_ratio") == 0) return p->stereo.uniqueness_ratio = (int32_t)value, VISTA_OK;
  if (strcmp(name, "stereo.lr_max_diff") == 0) return p->stereo.lr_max_diff = (int32_t)value, VISTA_OK;
  if (strcmp(name, "foveation.sector_count") == 0) return p->foveation.sector_count = (int32_t)value, VISTA_OK;
  if (strcmp(name, "foveation.rho_0_px") == 0) return p->foveation.rho_0_px = value, VISTA_OK;
  if (strcmp(name, "foveation.min_valid_fraction") == 0) return p->foveation.min_valid_fraction = value, VISTA_OK;
  if (strcmp(name, "affinity.form") == 0) return p->affinity.form = (vista_affinity_form)(int32_t)value, VISTA_OK;
  if (strcmp(name, "affinity.alpha_intensity") == 0) return p->affinity.alpha_intensity = value, VISTA_OK;
  if (strcmp(name, "affinity.mu_intensity") == 0) return p->affinity.mu_intensity = value, VISTA_OK;
  if (strcmp(name, "affinity.sigma_intensity") == 0) return p->affinity.sigma_intensity = value, VISTA_OK;
  if (strcmp(name, "affinity.mu_disparity_px") == 0) return p->affinity.mu_disparity_px = value, VISTA_OK;
  if (strcmp(name, "affinity.mu_disparity_slope") == 0) return p->affinity.mu_disparity_slope = value, VISTA_OK;
  if (strcmp(name, "affinity.mu_depth_m") == 0) return p->affinity.mu_depth_m = value, VISTA_OK;
  if (strcmp(name, "affinity.sigma_disparity_px") == 0) return p->affinity.sigma_disparity_px = value, VISTA_OK;
  if (strcmp(name, "affinity.flow_encoding") == 0) return p->affinity.flow_encoding = (vista_affinity_flow_encoding)(int32_t)value, VISTA_OK;
  if (strcmp(name, "affinity.flow_scale") == 0) return p->affinity.flow_scale = value, VISTA_OK;
  if (strcmp(name, "affinity.flow_constant") == 0) return p->affinity.flow_constant = value, VISTA_OK;
  if (strcmp(name, "surface.lever_px") == 0) return p->surface.lever_px = value, VISTA_OK;
  if (strcmp(name, "surface.horizontal_deg") == 0) return p->surface.horizontal_deg = value, VISTA_OK;
  if (strcmp(name, "surface.ground_step_px") == 0) return p->surface.ground_step_px = value, VISTA_OK;
  if (strcmp(name, "surface.ground_step_m") == 0) return p->surface.ground_step_m = value, VISTA_OK;
  if (strcmp(name, "segmentation.seed_step_px") == 0) return p->segmentation.seed_step_px = value, VISTA_OK;
  if (strcmp(name, "segmentation.seed_step_slope") == 0) return p->segmentation.seed_step_slope = value, VISTA_OK;
  if (strcmp(name, "segmentation.seed_step_m") == 0) return p->segmentation.seed_step_m = value, VISTA_OK;
  if (strcmp(name, "segmentation.seed_area_px2") == 0) return p->segmentation.seed_area_px2 = value, VISTA_OK;
  if (strcmp(name, "segmentation.bridge_m") == 0) return p->segmentation.bridge_m = value, VISTA_OK;
  if (strcmp(name, "segmentation.shell_px") == 0) return p->segmentation.shell_px = value, VISTA_OK;
  if (strcmp(name, "segmentation.reach") == 0) return p->segmentation.reach = (int32_t)value, VISTA_OK;
  if (strcmp(name, "segmentation.unknown_link") == 0) return p->segmentation.unknown_link = value, VISTA_OK;
  if (strcmp(name, "segmentation.mismatch_link") == 0) return p->segmentation.mismatch_link = value, VISTA_OK;
  if (strcmp(name, "segmentation.horizontal_link") == 0) return p->segmentation.horizontal_link = value, VISTA_OK;
  if (strcmp(name, "segmentation.merge_ratio") == 0) return p->segmentation.merge_ratio = value, VISTA_OK;
  if (strcmp(name, "segmentation.merge_share") == 0) return p->segmentation.merge_share = value, VISTA_OK;
  if (strcmp(name, "segmentation.rest_affinity") == 0) return p->segmentation.rest_affinity = value, VISTA_OK;
  if (strcmp(name, "segmentation.rest_area_px2") == 0) return p->segmentation.rest_area_px2 = value, VISTA_OK;
  if (strcmp(name, "refinement.sigma_intensity") == 0) return p->refinement.sigma_intensity = value, VISTA_OK;
  if (strcmp(name, "refinement.contrast_limit") == 0) return p->refinement.contrast_limit = value, VISTA_OK;
  if (strcmp(name, "refinement.mixed_penalty") == 0) return p->refinement.mixed_penalty = value, VISTA_OK;
  if (strcmp(name, "refinement.compactness") == 0) return p->refinement.compactness = value, VISTA_OK;
  if (strcmp(name, "region.boundary_px") == 0) return p->region.boundary_px = value, VISTA_OK;
  if (strcmp(name, "region.tolerance_px") == 0) return p->region.tolerance_px = value, VISTA_OK;
  if (strcmp(name, "region.tolerance_m") == 0) return p->region.tolerance_m = value, VISTA_OK;
  if (strcmp(name, "region.min_inliers") == 0) return p->region.min_inliers = (int32_t)value, VISTA_OK;
  if (strcmp(name, "region.min_disparity_px") == 0) return p->region.min_disparity_px = value, VISTA_OK;
  if (strcmp(name, "region.min_size_m") == 0) return p->region.min_size_m = value, VISTA_OK;
  if (strcmp(name, "region.min_valid_fraction") == 0) return p->region.min_valid_fraction = value, VISTA_OK;
  if (strcmp(name, "region.min_inlier_fraction") == 0) return p->region.min_inlier_fraction = value, VISTA_OK;
  if (strcmp(name, "region.outline_fraction") == 0) return p->region.outline_fraction = value, VISTA_OK;
  if (strcmp(name, "region.foot_m") == 0) return p->region.foot_m = value, VISTA_OK;
  if (strcmp(name, "region.min_height_m") == 0) return p->region.min_height_m = value, VISTA_OK;
  if (strcmp(name, "region.min_standing_fraction") == 0) return p->region.min_standing_fraction = value, VISTA_OK;
  if (strcmp(name, "reconstruction.center_sigma_px") == 0) return p->reconstruction.center_sigma_px = value, VISTA_OK;
  if (strcmp(name, "reconstruction.center_sigma_ratio") == 0) return p->reconstruction.center_sigma_ratio = value, VISTA_OK;
  if (strcmp(name, "reconstruction.disparity_sigma_px") == 0) return p->reconstruction.disparity_sigma_px = value, VISTA_OK;
  if (strcmp(name, "reconstruction.correlated_pixels") == 0) return p->reconstruction.correlated_pixels = value, VISTA_OK;
  if (strcmp(name, "reconstruction.disparity_min_px") == 0) return p->reconstruction.disparity_min_px = value, VISTA_OK;
  if (strcmp(name, "tracker.velocity_sigma_m_s") == 0) return p->tracker.velocity_sigma_m_s = value, VISTA_OK;
  if (strcmp(name, "tracker.moving_sigma_m_s") == 0) return p->tracker.moving_sigma_m_s = value, VISTA_OK;
  if (strcmp(name, "tracker.acceleration_psd_m2_s3") == 0) return p->tracker.acceleration_psd_m2_s3 = value, VISTA_OK;
  if (strcmp(name, "tracker.position_psd_m2_s") == 0) return p->tracker.position_psd_m2_s = value, VISTA_OK;
  if (strcmp(name, "tracker.attitude_sigma_deg") == 0) return p->tracker.attitude_sigma_deg = value, VISTA_OK;
  if (strcmp(name, "tracker.gate_chi2") == 0) return p->tracker.gate_chi2 = value, VISTA_OK;
  if (strcmp(name, "tracker.extent_sigma_ratio") == 0) return p->tracker.extent_sigma_ratio = value, VISTA_OK;
  if (strcmp(name, "tracker.extent_psd_1_s") == 0) return p->tracker.extent_psd_1_s = value, VISTA_OK;
  if (strcmp(name, "tracker.overlap_sigma") == 0) return p->tracker.overlap_sigma = value, VISTA_OK;
  if (strcmp(name, "tracker.overlap_scale") == 0) return p->tracker.overlap_scale = value, VISTA_OK;
  if (strcmp(name, "tracker.confirm_hits") == 0) return p->tracker.confirm_hits = (int32_t)value, VISTA_OK;
  if (strcmp(name, "tracker.confirm_window") == 0) return p->tracker.confirm_window = (int32_t)value, VISTA_OK;
  if (strcmp(name, "tracker.moved_hits") == 0) return p->tracker.moved_hits = (int32_t)value, VISTA_OK;
  if (strcmp(name, "tracker.volume_pixels") == 0) return p->tracker.volume_pixels = (int32_t)value, VISTA_OK;
  if (strcmp(name, "tracker.static_odds") == 0) return p->tracker.static_odds = value, VISTA_OK;
  if (strcmp(name, "tracker.static_tolerance") == 0) return p->tracker.static_tolerance = value, VISTA_OK;
  if (strcmp(name, "tracker.static_noise_hits") == 0) return p->tracker.static_noise_hits = value, VISTA_OK;
  if (strcmp(name, "tracker.static_fade_m") == 0) return p->tracker.static_fade_m = value, VISTA_OK;
  if (strcmp(name, "tracker.static_speed_min_m_s") == 0) return p->tracker.static_speed_min_m_s = value, VISTA_OK;
  if (strcmp(name, "tracker.miss_max") == 0) return p->tracker.miss_max = (int32_t)value, VISTA_OK;
  if (strcmp(name, "tracker.out_of_view_s") == 0) return p->tracker.out_of_view_s = value, VISTA_OK;
  if (strcmp(name, "tracker.blind_zone_s") == 0) return p->tracker.blind_zone_s = value, VISTA_OK;
  if (strcmp(name, "tracker.range_max_m") == 0) return p->tracker.range_max_m = value, VISTA_OK;
  if (strcmp(name, "blind_zone.contrast") == 0) return p->blind_zone.contrast = (int32_t)value, VISTA_OK;
  if (strcmp(name, "blind_zone.textured_fraction") == 0) return p->blind_zone.textured_fraction = value, VISTA_OK;
  if (strcmp(name, "blind_zone.unmatched_fraction") == 0) return p->blind_zone.unmatched_fraction = value, VISTA_OK;
  if (strcmp(name, "blind_zone.confirm_hits") == 0) return p->blind_zone.confirm_hits = (int32_t)value, VISTA_OK;
  if (strcmp(name, "blind_zone.confirm_window") == 0) return p->blind_zone.confirm_window = (int32_t)value, VISTA_OK;
  if (strcmp(name, "obstacle_map.collision_radius_m") == 0) return p->obstacle_map.collision_radius_m = value, VISTA_OK;
  if (strcmp(name, "obstacle_map.collision_length_m") == 0) return p->obstacle_map.collision_length_m = value, VISTA_OK;
  if (strcmp(name, "obstacle_map.inflation_sigma") == 0) return p->obstacle_map.inflation_sigma = value, VISTA_OK;
  if (strcmp(name, "obstacle_map.lasting_disparity_px") == 0) return p->obstacle_map.lasting_disparity_px = value, VISTA_OK;
  if (strcmp(name, "obstacle_map.lasting_range_m") == 0) return p->obstacle_map.lasting_range_m = value, VISTA_OK;
  if (strcmp(name, "obstacle_map.lasting_center_px") == 0) return p->obstacle_map.lasting_center_px = value, VISTA_OK;
  if (strcmp(name, "obstacle_map.lasting_center_ratio") == 0) return p->obstacle_map.lasting_center_ratio = value, VISTA_OK;
  if (strcmp(name, "obstacle_map.velocity_smoothing_s") == 0) return p->obstacle_map.velocity_smoothing_s = value, VISTA_OK;
  if (strcmp(name, "obstacle_map.speed_min_m_s") == 0) return p->obstacle_map.speed_min_m_s = value, VISTA_OK;
  return VISTA_ERROR_RANGE;
}
