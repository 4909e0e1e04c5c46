#include "stages/health.h"

#include <math.h>
#include <stddef.h>

#include "common/frame.h"
#include "common/median.h"
#include "common/parameters_check.h"

typedef struct entry {
  const char *name, *text;
  uint32_t blinding; /* 1: what has this reason is blind */
} entry;

static const entry reasons[VISTA_HEALTH_REASON_COUNT] = {
    {"few_disparities", "few pixels have a disparity", 0},
    {"no_disparities", "hardly any pixel has a disparity", 1},
    {"no_contrast", "the image is hardly more than one grey level", 1},
    {"motion_unknown", "the pose is missing: positions rest on the last known motion", 0},
    {"pose_jump", "the pose jumped farther than the vehicle can have moved", 0},
};

static const char *const state_names[VISTA_HEALTH_STATE_COUNT] = {"healthy", "degraded", "blind"};

const char *vista_health_state_name(vista_health_state state) {
  return (unsigned)state < VISTA_HEALTH_STATE_COUNT ? state_names[state] : "unknown";
}

const char *vista_health_reason_name(vista_health_reason reason) {
  return (unsigned)reason < VISTA_HEALTH_REASON_COUNT ? reasons[reason].name : "unknown";
}

const char *vista_health_reason_text(vista_health_reason reason) {
  return (unsigned)reason < VISTA_HEALTH_REASON_COUNT ? reasons[reason].text : "unknown reason";
}

/* Standard deviation of the cells' grey levels, by the pixels that they own. */
static double contrast_of(const vista_foveation *foveation, const vista_cells *cells) {
  double pixels = 0.0, sum = 0.0, squares = 0.0;
  for (int32_t i = 0; i < foveation->node_count; ++i) {
    const double weight = foveation->pixel_count[i], grey = (double)cells->intensity[i];
    pixels += weight;
    sum += weight * grey;
    squares += weight * grey * grey;
  }
  const double mean = sum / pixels;
  return sqrt(fmax(squares / pixels - mean * mean, 0.0));
}

typedef struct valid_pixels {
  int64_t image, matched, matched_area;
} valid_pixels;

static valid_pixels count(const vista_matched_area *matched, const vista_disparity_image *disparity) {
  const int32_t margin = (int32_t)matched->margin_px, first = (int32_t)matched->margin_left_px;
  const int32_t end = disparity->width_px - margin;
  valid_pixels sum = {0};
  for (int32_t v = 0; v < disparity->height_px; ++v) {
    const int16_t *const row = disparity->data + v * disparity->stride;
    sum.image += vista_count_valid(row, disparity->width_px);
    if (v < margin || v >= disparity->height_px - margin || first >= end) continue;
    sum.matched += vista_count_valid(row + first, end - first);
    sum.matched_area += end - first;
  }
  return sum;
}

vista_status vista_health_judge(const vista_health_params *params, const vista_foveation *foveation,
                                const vista_matched_area *matched, const vista_cells *cells,
                                const vista_disparity_image *disparity, const vista_motion *motion,
                                vista_health *health, double *valid_fraction) {
  if (params == NULL || foveation == NULL || matched == NULL || cells == NULL || disparity == NULL || motion == NULL ||
      health == NULL || valid_fraction == NULL)
    return VISTA_ERROR_ARGUMENT;
  vista_status status = VISTA_CHECK_SECTION(health, params);
  if (status == VISTA_OK) status = vista_matched_area_check(matched);
  if (status == VISTA_OK) status = vista_frame_check_disparity(disparity, foveation->width_px, foveation->height_px);
  if (status != VISTA_OK) return status;
  const valid_pixels valid = count(matched, disparity);
  *valid_fraction = (double)valid.image / ((double)disparity->width_px * disparity->height_px);
  vista_health h = {
      .matched_fraction = valid.matched_area > 0 ? (double)valid.matched / (double)valid.matched_area : 0.0,
      .contrast = contrast_of(foveation, cells)};
  const bool none = h.matched_fraction < params->blind_fraction;
  const bool holds[VISTA_HEALTH_REASON_COUNT] = {
      [VISTA_HEALTH_FEW_DISPARITIES] = h.matched_fraction < params->degraded_fraction && !none,
      [VISTA_HEALTH_NO_DISPARITIES] = none,
      [VISTA_HEALTH_NO_CONTRAST] = h.contrast < params->contrast_min,
      [VISTA_HEALTH_MOTION_UNKNOWN] = motion->source == VISTA_MOTION_CARRIED_ON,
      [VISTA_HEALTH_POSE_JUMP] = motion->source == VISTA_MOTION_REFUSED || motion->restarted,
  };
  for (int k = 0; k < VISTA_HEALTH_REASON_COUNT; ++k) {
    if (!holds[k]) continue;
    h.reasons |= UINT32_C(1) << k;
    if (h.state != VISTA_HEALTH_BLIND) h.state = reasons[k].blinding ? VISTA_HEALTH_BLIND : VISTA_HEALTH_DEGRADED;
  }
  *health = h;
  return VISTA_OK;
}
