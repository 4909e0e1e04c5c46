#include "align/row_fit.h"

#include <math.h>
#include <stdlib.h>

#include "common/numbers.h"

#define PROPOSALS 120
#define SCATTER_PX 0.2      /* of the rows of features that were found exactly: slanted and curved surfaces */
#define LIMIT_SIGMAS 3.0     /* farther from the fit, a feature does not agree */
#define LIMIT_PX 1.0         /* nor farther than this */
#define ITERATIONS 8
#define AGREEING_MIN 16
#define AGREEING_SHARE 0.5   /* of the features that were found */
#define TURN_PRIOR_RAD 0.05  /* keeps the fit solvable where features lie in one place */

typedef struct row {
  double pitch_px, roll_px; /* slopes */
  double error_px, weight;  /* 1 / sigma^2 */
  double limit_px;
} row;

void vista_row_fit_slopes(const vista_camera *camera, double u_px, double v_px, double *of_pitch_px,
                          double *of_roll_px) {
  const double y = (v_px - camera->center_v_px) / camera->focal_px;
  *of_pitch_px = camera->focal_px * (1.0 + y * y);
  *of_roll_px = camera->center_u_px - u_px;
}

vista_turn_matrix vista_turn_matrix_add(vista_turn_matrix a, vista_turn_matrix b) {
  return (vista_turn_matrix){a.pp + b.pp, a.pr + b.pr, a.rr + b.rr};
}

vista_turn_matrix vista_turn_matrix_inverse(vista_turn_matrix m) {
  const double determinant = m.pp * m.rr - m.pr * m.pr;
  return (vista_turn_matrix){m.rr / determinant, -m.pr / determinant, m.pp / determinant};
}

double vista_turn_matrix_square(vista_turn_matrix m, vista_turn t) {
  return m.pp * t.pitch_rad * t.pitch_rad + 2.0 * m.pr * t.pitch_rad * t.roll_rad + m.rr * t.roll_rad * t.roll_rad;
}

static double residual(const row *r, vista_turn turn) {
  return r->error_px - r->pitch_px * turn.pitch_rad - r->roll_px * turn.roll_rad;
}

/* Squares up to the limit: the smaller, the better. */
static double cost(const row *rows, int32_t count, vista_turn turn) {
  double sum = 0.0;
  for (int32_t k = 0; k < count; ++k) sum += fmin(vista_square(residual(&rows[k], turn) / rows[k].limit_px), 1.0);
  return sum;
}

/* The turn through two features; false where they say too little. */
static bool through(const row *a, const row *b, vista_turn *turn) {
  const double determinant = a->pitch_px * b->roll_px - b->pitch_px * a->roll_px;
  if (!(fabs(determinant) > 0.02 * a->pitch_px * b->pitch_px)) return false;
  *turn = (vista_turn){(a->error_px * b->roll_px - b->error_px * a->roll_px) / determinant,
                       (a->pitch_px * b->error_px - b->pitch_px * a->error_px) / determinant};
  return true;
}

static uint32_t draw(uint32_t *state) {
  *state = *state * UINT32_C(1664525) + UINT32_C(1013904223);
  return *state >> 8;
}

static vista_turn propose(const row *rows, int32_t count) {
  vista_turn best = {0};
  double least = cost(rows, count, best);
  uint32_t state = 1;
  for (int k = 0; k < PROPOSALS; ++k) {
    const row *const a = &rows[draw(&state) % (uint32_t)count], *const b = &rows[draw(&state) % (uint32_t)count];
    vista_turn turn;
    if (!through(a, b, &turn)) turn = (vista_turn){a->error_px / a->pitch_px, 0.0};
    const double of_turn = cost(rows, count, turn);
    if (of_turn < least) {
      least = of_turn;
      best = turn;
    }
  }
  return best;
}

/* One step of least squares. information: of the turn that comes out. */
static vista_turn improve(const row *rows, int32_t count, vista_turn turn, vista_turn_matrix *information) {
  const double prior = 1.0 / vista_square(TURN_PRIOR_RAD);
  vista_turn_matrix sum = {prior, 0.0, prior};
  double pitch = 0.0, roll = 0.0;
  for (int32_t k = 0; k < count; ++k) {
    const row *const r = &rows[k];
    const double share = residual(r, turn) / r->limit_px;
    if (!(fabs(share) < 1.0)) continue;
    const double weight = r->weight * vista_square(1.0 - share * share);
    sum.pp += weight * r->pitch_px * r->pitch_px;
    sum.pr += weight * r->pitch_px * r->roll_px;
    sum.rr += weight * r->roll_px * r->roll_px;
    pitch += weight * r->pitch_px * r->error_px;
    roll += weight * r->roll_px * r->error_px;
  }
  const vista_turn_matrix m = vista_turn_matrix_inverse(sum);
  *information = sum;
  return (vista_turn){m.pp * pitch + m.pr * roll, m.pr * pitch + m.rr * roll};
}

static int by_size(const void *a, const void *b) {
  const double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

/* Counts those that agree, and measures their rows. Where they scatter more than expected, the turn is known less. */
static void judge(const row *rows, int32_t count, vista_row_fit *fit) {
  double errors[VISTA_ROW_MATCHES_MOST], squares = 0.0;
  for (int32_t k = 0; k < count; ++k) {
    const double rest = residual(&rows[k], fit->turn);
    if (!(fabs(rest) < rows[k].limit_px)) continue;
    errors[fit->agreeing++] = fabs(rows[k].error_px);
    squares += rest * rest * rows[k].weight;
  }
  fit->agreed = fit->agreeing >= AGREEING_MIN && fit->agreeing >= AGREEING_SHARE * count;
  if (!fit->agreed) return;
  const double scatter = fmax(squares / fit->agreeing, 1.0);
  fit->covariance.pp *= scatter;
  fit->covariance.pr *= scatter;
  fit->covariance.rr *= scatter;
  qsort(errors, (size_t)fit->agreeing, sizeof *errors, by_size);
  fit->row_error_px = errors[fit->agreeing / 2];
  fit->row_error_90_px = errors[fit->agreeing * 9 / 10];
}

vista_row_fit vista_row_fit_make(const vista_camera *camera, const vista_row_match *matches, int32_t count) {
  vista_row_fit fit = {0};
  if (count < AGREEING_MIN) return fit;
  row rows[VISTA_ROW_MATCHES_MOST];
  for (int32_t k = 0; k < count; ++k) {
    const vista_row_match *const m = &matches[k];
    const double variance = vista_square(SCATTER_PX) + vista_square((double)m->sigma_px);
    rows[k] = (row){.error_px = m->row_error_px,
                    .weight = 1.0 / variance,
                    .limit_px = fmin(LIMIT_SIGMAS * sqrt(variance), LIMIT_PX)};
    vista_row_fit_slopes(camera, m->u_px, m->v_px, &rows[k].pitch_px, &rows[k].roll_px);
  }
  fit.turn = propose(rows, count);
  vista_turn_matrix information = {0};
  for (int k = 0; k < ITERATIONS; ++k) fit.turn = improve(rows, count, fit.turn, &information);
  fit.covariance = vista_turn_matrix_inverse(information);
  judge(rows, count, &fit);
  return fit;
}
