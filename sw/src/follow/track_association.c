#include "follow/track_association.h"

#include <math.h>
#include <stddef.h>

#include "follow/assignment.h"

#define OVERLAP_SIGMA 3.0 /* depth gate for lying within a track, standard deviations of the disparity difference */
#define OVERLAP_SCALE 1.2 /* half extents around a track's centre that count as within it */
#define MOVED_EXTENT_CHI2 5.99 /* 95 percent of 2 degrees: what is linked by place so loosely has to be of one size */

typedef enum pass {
  CONFIRMED_IN_GATE,
  CONFIRMED_RESHAPED,
  TENTATIVE_IN_GATE,
  MOVING_IN_GATE,
  NEWBORN_MOVED,
  PASS_COUNT
} pass;

struct vista_track_association {
  bool *claimed;  /* per detection */
  bool *reshaped;    /* per track */
  int32_t *moved_to; /* per track: detection or -1 */
  int32_t *row_track, *column_detection; /* what stands in the cost matrix */
  int32_t *column_of_row;
  double *cost;
  vista_assignment *assignment;
};

vista_status vista_track_association_layout(int32_t max_tracks, int32_t max_detections, vista_arena *arena,
                                            vista_track_association **association) {
  *association = NULL;
  const size_t tracks = (size_t)max_tracks;
  const size_t detections = (size_t)max_detections;
  vista_track_association *made = vista_arena_take(arena, 1, sizeof *made);
  vista_track_association parts = {.claimed = vista_arena_take(arena, detections, sizeof(bool)),
                                   .reshaped = vista_arena_take(arena, tracks, sizeof(bool)),
                                   .moved_to = vista_arena_take(arena, tracks, sizeof(int32_t)),
                                   .row_track = vista_arena_take(arena, tracks, sizeof(int32_t)),
                                   .column_detection = vista_arena_take(arena, detections, sizeof(int32_t)),
                                   .column_of_row = vista_arena_take(arena, tracks, sizeof(int32_t)),
                                   .cost = vista_arena_take(arena, tracks * (detections + tracks), sizeof(double))};
  const vista_status status =
      vista_assignment_layout(max_tracks, max_detections + max_tracks, arena, &parts.assignment);
  if (status != VISTA_OK || arena->base == NULL) return status;
  *made = parts;
  *association = made;
  return VISTA_OK;
}

bool vista_track_association_reshaped(const vista_track_association *association, int32_t track) {
  return association->reshaped[track];
}

int32_t vista_track_association_moved_to(const vista_track_association *association, int32_t track) {
  return association->moved_to[track];
}

bool vista_track_association_claimed(const vista_track_association *association, int32_t detection) {
  return association->claimed[detection];
}

/* Compares two disparities and their inverses, which stand for depth: near the camera the former have no certainty
 * left, far from it the latter. */
static bool same_depth(double d1, double variance1, double d2, double variance2) {
  const double disparity_sigma = sqrt(variance1 + variance2);
  const double inverse_sigma = sqrt(variance1 / (d1 * d1 * d1 * d1) + variance2 / (d2 * d2 * d2 * d2));
  return fabs(d1 - d2) <= OVERLAP_SIGMA * disparity_sigma && fabs(1.0 / d1 - 1.0 / d2) <= OVERLAP_SIGMA * inverse_sigma;
}

/* Squared distance from the outer centre in units of its widened half extent: up to 1 is inside. The inner
 * centre's own noise widens it, so that thin objects are not missed by a pixel. Another depth: INFINITY. */
static double within2(const double inner_px[3], const double inner_variance_px2[3], const vista_track_view *outer) {
  if (!same_depth(inner_px[2], inner_variance_px2[2], outer->measurement_px[2], outer->covariance_px2[8]))
    return INFINITY;
  double sum = 0.0;
  for (int i = 0; i < 2; ++i) {
    const double half_px = OVERLAP_SCALE * outer->half_px[i] + sqrt(inner_variance_px2[i]);
    const double ratio = (inner_px[i] - outer->measurement_px[i]) / half_px;
    sum += ratio * ratio;
  }
  return sum;
}

bool vista_track_within(const vista_track_view *inner, const vista_track_view *outer) {
  const double variance_px2[3] = {inner->covariance_px2[0], inner->covariance_px2[4], inner->covariance_px2[8]};
  return within2(inner->measurement_px, variance_px2, outer) <= 1.0;
}

/* y^T S^-1 y >= y_i^2 / S_ii, for each i: most pairs are out of the gate without an inversion. */
static bool surely_outside(double gate_chi2, const vista_track_view *view, const double covariance_px2[9],
                           const vista_detection *detection, const double variance_px2[3]) {
  const double measured_px[3] = {detection->u_px, detection->v_px, detection->disparity_px};
  for (int i = 0; i < 3; ++i) {
    const double y = measured_px[i] - view->measurement_px[i];
    if (y * y > gate_chi2 * (covariance_px2[4 * i] + variance_px2[i])) return true;
  }
  return false;
}

/* Who takes part in a step. What moves comes last, so that it takes nothing from what stands. */
static bool takes_part(pass step, const vista_track *track) {
  switch (step) {
    case CONFIRMED_IN_GATE:
    case CONFIRMED_RESHAPED:
      return track->confirmed;
    case TENTATIVE_IN_GATE:
      return !track->confirmed && !track->moved;
    case MOVING_IN_GATE:
      return !track->confirmed && track->moved;
    case NEWBORN_MOVED:
      return !track->confirmed && track->hits == 1;
    case PASS_COUNT:
      break;
  }
  return false;
}

/* What the left or right border cuts has its centre anywhere on the far side of it, hence a wide gate; but its visible
 * part does not reach to a track beside it. */
static bool beside_what_is_cut(const vista_track_view *view, const vista_detection *detection) {
  const double du_px = fabs(view->measurement_px[0] - detection->ellipse.center_u_px);
  return detection->cut_u && du_px > detection->ellipse.axis_a_px + view->half_px[0];
}

/* Never above miss_cost: a track rather takes a detection in its gate than none. */
static double pair_cost(pass step, const vista_track_frame *frame, const vista_track *track,
                        const vista_track_view *view, const vista_detection *detection) {
  const vista_tracker_params *const params = frame->params;
  double variance_px2[3];
  if (beside_what_is_cut(view, detection)) return INFINITY;
  vista_track_filter_noise(params, frame->camera, detection, view, false, variance_px2);
  if (step == CONFIRMED_RESHAPED) {
    const double measured_px[3] = {detection->u_px, detection->v_px, detection->disparity_px};
    const double distance2 = within2(measured_px, variance_px2, view);
    return distance2 <= 1.0 ? distance2 * params->gate_chi2 : INFINITY;
  }
  const double *const covariance_px2 = step == NEWBORN_MOVED ? view->moved_covariance_px2 : view->covariance_px2;
  if (surely_outside(params->gate_chi2, view, covariance_px2, detection, variance_px2)) return INFINITY;
  const double distance2 = vista_track_filter_distance2(view, covariance_px2, detection, variance_px2);
  if (!(distance2 <= params->gate_chi2)) return INFINITY;
  const double extent2 = vista_track_filter_extent_distance2(track, detection);
  if (step == NEWBORN_MOVED) return extent2 <= MOVED_EXTENT_CHI2 ? distance2 + extent2 : INFINITY;
  /* Near the camera a pixel is millimetres, (u, v, d) of the prediction has no certainty left and everything would
   * be in the gate. In space it keeps it; twice the gate leaves room for the curvature at long range. */
  const double space2 = vista_track_filter_space_distance2(params, frame->pose, track, view, detection);
  if (!(space2 <= 2.0 * params->gate_chi2)) return INFINITY;
  return distance2 + fmin(extent2, params->gate_chi2);
}

void vista_track_associate(vista_track_association *association, const vista_track_frame *frame,
                           const vista_track_table *table, int32_t *detection_of_track) {
  const vista_tracker_params *const params = frame->params;
  const int32_t track_count = table->count, detection_count = frame->count;
  /* A track may also stay without detection, at the price of the worst one. Without this, one stray detection could
   * push two good pairs aside for three bad ones. */
  const double miss_cost = 2.0 * params->gate_chi2;
  for (int32_t i = 0; i < detection_count; ++i) association->claimed[i] = false;
  for (int32_t i = 0; i < track_count; ++i) {
    detection_of_track[i] = -1;
    association->reshaped[i] = false;
    association->moved_to[i] = -1;
  }
  for (pass step = CONFIRMED_IN_GATE; step < PASS_COUNT; ++step) {
    int32_t rows = 0;
    int32_t columns = 0;
    for (int32_t i = 0; i < track_count; ++i)
      if (takes_part(step, &table->tracks[i]) && detection_of_track[i] < 0) association->row_track[rows++] = i;
    for (int32_t j = 0; j < detection_count; ++j)
      if (!association->claimed[j]) association->column_detection[columns++] = j;
    for (int32_t row = 0; row < rows; ++row) {
      double *cost = &association->cost[(size_t)row * (size_t)(columns + rows)];
      const int32_t track = association->row_track[row];
      for (int32_t column = 0; column < columns; ++column)
        cost[column] = pair_cost(step, frame, &table->tracks[track], &table->views[track],
                                 &frame->detections[association->column_detection[column]]);
      for (int32_t other = 0; other < rows; ++other) cost[columns + other] = other == row ? miss_cost : INFINITY;
    }
    /* sizes and costs are sound by construction: this cannot fail */
    (void)vista_assignment_solve(association->assignment, association->cost, rows, columns + rows,
                                 association->column_of_row);
    for (int32_t row = 0; row < rows; ++row) {
      const int32_t column = association->column_of_row[row];
      if (column < 0 || column >= columns) continue;
      const int32_t track = association->row_track[row];
      if (step == NEWBORN_MOVED) {
        association->moved_to[track] = association->column_detection[column];
        continue;
      }
      detection_of_track[track] = association->column_detection[column];
      association->claimed[association->column_detection[column]] = true;
      association->reshaped[track] = step == CONFIRMED_RESHAPED;
    }
  }
}
