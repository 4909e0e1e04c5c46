#include "space/free_view.h"

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include "common/frame.h"
#include "common/numbers.h"
#include "space/told.h"

#define STATIONS 20
#define SAMPLES 9 /* of a station, from the bottom to the top */
#define LEVEL_MIN 0.2 /* sine of camera axis and vertical: a camera that looks up or down sees no level direction */
#define TOLD_MIN 0.2 /* share of the points of a line; as many that are blocked end the direction */
#define NEARER 0.9 /* than the station by this: before it */

typedef struct view {
  vista_told told;
  const vista_camera *camera;
  const vista_matched_area *matched;
  double radius_m, least;
  double ahead[3], right[3], up[3]; /* level axes, in the camera */
} view;

static bool make_axes(view *v, const double up[3]) {
  if (!(sqrt(1.0 - up[2] * up[2]) >= LEVEL_MIN)) return false;
  memcpy(v->up, up, sizeof v->up);
  vista_frame_level_axes(up, v->ahead, v->right);
  return true;
}

typedef enum sight { OUTSIDE, DARK, BLOCKED, OPEN } sight;

/* nearer: how much nearer than the point its line of sight ends, of 1; for BLOCKED only. */
static sight look_at(const view *v, const double point_m[3], double *nearer) {
  const vista_camera *const c = v->camera;
  if (!(point_m[2] > 0.0)) return OUTSIDE;
  const double scale = c->focal_px / point_m[2];
  const double u = c->center_u_px + scale * point_m[0], w = c->center_v_px + scale * point_m[1];
  const double disparity_px = scale * c->baseline_m;
  if (!vista_matched_holds(v->matched, c, u, w, disparity_px)) return OUTSIDE;
  const int32_t column = (int32_t)lround(u), row = (int32_t)lround(w);
  const vista_region *const region = vista_told_region(&v->told, column, row);
  if (region == NULL) return DARK;
  if (region->verdict != VISTA_REGION_ACCEPTED) return OPEN;
  const int16_t word = v->told.disparity->data[row * v->told.disparity->stride + column];
  const double own_px = region->plain ? vista_region_surface_px(region, u, w) : (double)word / VISTA_DISPARITY_SCALE;
  if (!(NEARER * own_px > disparity_px)) return OPEN;
  *nearer = disparity_px / own_px;
  return BLOCKED;
}

/* blocked_m: where the direction ends, if this station is not free because of what stands before it; else as it was. */
static bool is_free(const view *v, const double direction[3], double distance_m, float *blocked_m) {
  int32_t counts[4] = {0};
  double nearer[SAMPLES];
  for (int k = 0; k < SAMPLES; ++k) {
    const double height_m = v->radius_m * ((2.0 * k + 1.0) / SAMPLES - 1.0);
    double point_m[3];
    for (int i = 0; i < 3; ++i) point_m[i] = distance_m * direction[i] + height_m * v->up[i];
    ++counts[look_at(v, point_m, &nearer[counts[BLOCKED]])];
  }
  const double inside = SAMPLES - counts[OUTSIDE], least = v->least * inside;
  if (counts[BLOCKED] > 0 && counts[BLOCKED] >= least) {
    *blocked_m = (float)(distance_m * vista_lower_median(nearer, counts[BLOCKED]));
    return false;
  }
  return inside > 0.0 && counts[OPEN] + counts[BLOCKED] >= least;
}

void vista_free_view(const vista_frame_view *frame, const vista_told *told, vista_directions *directions) {
  const vista_obstacle_map_params *const params = &frame->params->obstacle_map;
  const vista_camera *const camera = frame->camera;
  const vista_matched_area *const matched = &frame->matched;
  *directions = (vista_directions){.up_known = frame->up_known};
  memcpy(directions->up_camera, frame->up_camera, sizeof directions->up_camera);
  view v = {
      .told = *told, .camera = camera, .matched = matched, .radius_m = params->collision_radius_m, .least = TOLD_MIN};
  if (!make_axes(&v, directions->up_camera)) return;
  const double nearest_m = camera->focal_px * camera->baseline_m / matched->disparity_max_px;
  for (int column = 0; column < VISTA_DIRECTIONS; ++column) {
    const double azimuth = (VISTA_DIRECTIONS_FIRST_DEG + column + 0.5) * VISTA_RADIANS_PER_DEGREE;
    double direction[3];
    for (int i = 0; i < 3; ++i) direction[i] = cos(azimuth) * v.ahead[i] + sin(azimuth) * v.right[i];
    for (int k = 1; k <= STATIONS; ++k) {
      const double distance_m = params->collision_length_m * k / STATIONS;
      /* Nearer than anything is matched the view is as good as at the nearest range. */
      if (distance_m < nearest_m && k < STATIONS) continue;
      if (!is_free(&v, direction, distance_m, &directions->blocked_m[column])) break;
      directions->free_m[column] = (float)distance_m;
    }
  }
}
