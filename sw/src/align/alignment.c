#include "vista/alignment.h"

#include <math.h>

#include "align/row_fit.h"
#include "align/row_matches.h"
#include "common/arena.h"
#include "common/frame.h"
#include "common/image_noise.h"
#include "common/numbers.h"
#include "common/parameters_check.h"

#define STEP_PX 0.15 /* the correction is changed when that moves rows by more, root mean square over the image */
/* Standard deviation of how far pitch and roll drift in a second; sudden turns are followed all the same. */
#define DRIFT_DEG 0.002
#define LOST_S 1.0 /* the alarm is raised when the images have texture but their rows agree on no turn for so long */
#define SIDE_MIN 64            /* px */
#define SAMPLES 16             /* of the image along a side, for the mean of row errors over it */
#define FRAME_ERROR_PX 0.1    /* of the rows of one pair, alike for all features: what the scene does to a fit */
#define START_PX 0.2           /* how far a calibration's rows are off, before anything is seen */
#define GATE 16.0              /* squared distance in standard deviations from which on a fit is no noise */
#define SUDDEN_PAIRS 5         /* that agree before a correction, and before a sudden turn is believed */
#define SUDDEN_RAD 0.02        /* how large one may be; what the pairs do not show of it stays as it was */
#define SIGNIFICANT 9.0        /* squared distance in standard deviations of a correction from none */
#define STEP_S_MOST 1.0        /* of drift between two pairs */
#define ALIGNED_ROWS_PX 1.0    /* the median row error of a pair that is aligned is less */
#define USABLE_ROWS_PX 2.0     /* with more, hardly anything is matched */
#define TEXTURE_FEATURES 24    /* with fewer, images show too little to lose the rows in */

/* A turn, and how well it is known. */
typedef struct belief {
  vista_turn turn;
  vista_turn_matrix covariance;
} belief;

struct vista_alignment {
  vista_alignment_params parameters;
  vista_camera camera;
  vista_turn_matrix rows;       /* turn^T rows turn: mean square of the rows that it moves, px^2 */
  vista_turn_matrix frame_error; /* covariance of what all fits of a pair have in common, rad^2 */
  vista_row_matches matches;
  /* What is kept from pair to pair: */
  bool started;
  int64_t t_ns;
  belief known;
  belief sudden;                /* what the last pairs agree on, against what is known */
  int32_t sudden_pairs;
  int32_t pairs;                /* that what is known rests on, up to SUDDEN_PAIRS */
  double unexplained_s;         /* how long there has been texture without agreement */
  bool beyond;
  bool was_unexplained;
  int32_t good_pairs;           /* in a row, that agree with what is known, up to SUDDEN_PAIRS */
  bool wide;                    /* look for features in all rows: the last pair did not agree with what is known */
};

/* How far the largest turn moves a row; no farther than the image is high. */
static double reach_px(const vista_alignment_params *params, const vista_camera *camera) {
  const double corner_u = fmax(camera->center_u_px, camera->width_px - camera->center_u_px);
  const double y = fmax(camera->center_v_px, camera->height_px - camera->center_v_px) / camera->focal_px;
  const double px_per_radian =
      params->pitch_max_deg * camera->focal_px * (1.0 + 0.5 * y * y) + params->roll_max_deg * corner_u;
  return fmin(VISTA_RADIANS_PER_DEGREE * px_per_radian, camera->height_px);
}

static vista_status check(const vista_parameters *parameters, const vista_camera *camera) {
  vista_status status = vista_parameters_check(parameters, NULL);
  if (status == VISTA_OK) status = vista_frame_check_camera(camera);
  if (status != VISTA_OK) return status;
  return camera->width_px >= SIDE_MIN && camera->height_px >= SIDE_MIN ? VISTA_OK : VISTA_ERROR_SIZE;
}

vista_status vista_alignment_bytes(const vista_parameters *parameters, const vista_camera *camera, size_t *bytes) {
  if (parameters == NULL || camera == NULL || bytes == NULL) return VISTA_ERROR_ARGUMENT;
  const vista_status status = check(parameters, camera);
  if (status != VISTA_OK) return status;
  vista_arena arena = {0};
  vista_row_matches matches;
  (void)vista_arena_take(&arena, 1, sizeof(vista_alignment));
  vista_row_matches_layout(camera->width_px, camera->height_px, reach_px(&parameters->alignment, camera), &arena,
                           &matches);
  *bytes = arena.used + VISTA_ARENA_ALIGNMENT; /* the caller's memory need not be aligned */
  return VISTA_OK;
}

/* Means over the image. */
static vista_turn_matrix mean_rows(const vista_camera *camera) {
  vista_turn_matrix sum = {0};
  for (int32_t y = 0; y < SAMPLES; ++y)
    for (int32_t x = 0; x < SAMPLES; ++x) {
      double pitch, roll;
      vista_row_fit_slopes(camera, (x + 0.5) * camera->width_px / SAMPLES, (y + 0.5) * camera->height_px / SAMPLES,
                           &pitch, &roll);
      const double weight = 1.0 / (SAMPLES * SAMPLES);
      sum = vista_turn_matrix_add(
          sum, (vista_turn_matrix){weight * pitch * pitch, weight * pitch * roll, weight * roll * roll});
    }
  return sum;
}

/* A covariance that moves pitch and roll so that rows move by this each, root mean square. */
static vista_turn_matrix uncertainty(const vista_turn_matrix *rows, double px) {
  return (vista_turn_matrix){px * px / rows->pp, 0.0, px * px / rows->rr};
}

void vista_alignment_reset(vista_alignment *a) {
  a->started = a->beyond = a->was_unexplained = false;
  a->known = (belief){.covariance = uncertainty(&a->rows, START_PX)};
  a->sudden = (belief){0};
  a->sudden_pairs = a->pairs = a->good_pairs = 0;
  a->unexplained_s = 0.0;
  a->wide = true;
  a->matches.digests[0] = a->matches.digests[1] = 0;
  a->matches.turn = 0;
}

vista_status vista_alignment_create(void *memory, size_t bytes, const vista_parameters *parameters,
                                    const vista_camera *camera, vista_alignment **alignment) {
  if (memory == NULL || parameters == NULL || camera == NULL || alignment == NULL) return VISTA_ERROR_ARGUMENT;
  const vista_status status = check(parameters, camera);
  if (status != VISTA_OK) return status;
  vista_arena arena = {.base = memory, .size = bytes};
  vista_alignment *const a = vista_arena_take(&arena, 1, sizeof *a);
  if (a == NULL) return VISTA_ERROR_MEMORY;
  a->parameters = parameters->alignment;
  a->camera = *camera;
  a->rows = mean_rows(camera);
  a->frame_error = uncertainty(&a->rows, FRAME_ERROR_PX);
  vista_row_matches_layout(camera->width_px, camera->height_px, reach_px(&a->parameters, camera), &arena, &a->matches);
  if (arena.used > arena.size) return VISTA_ERROR_MEMORY;
  vista_alignment_reset(a);
  *alignment = a;
  return VISTA_OK;
}

static vista_turn minus(vista_turn a, vista_turn b) {
  return (vista_turn){a.pitch_rad - b.pitch_rad, a.roll_rad - b.roll_rad};
}

/* Squared distance in standard deviations. */
static double distance(const belief *a, const belief *b) {
  const vista_turn_matrix sum = vista_turn_matrix_add(a->covariance, b->covariance);
  return vista_turn_matrix_square(vista_turn_matrix_inverse(sum), minus(a->turn, b->turn));
}

/* What two independent beliefs say together. */
static belief joined(const belief *a, const belief *b) {
  const vista_turn_matrix ia = vista_turn_matrix_inverse(a->covariance);
  const vista_turn_matrix ib = vista_turn_matrix_inverse(b->covariance);
  const vista_turn_matrix m = vista_turn_matrix_inverse(vista_turn_matrix_add(ia, ib));
  const double pitch = ib.pp * (b->turn.pitch_rad - a->turn.pitch_rad) + ib.pr * (b->turn.roll_rad - a->turn.roll_rad);
  const double roll = ib.pr * (b->turn.pitch_rad - a->turn.pitch_rad) + ib.rr * (b->turn.roll_rad - a->turn.roll_rad);
  return (belief){{a->turn.pitch_rad + m.pp * pitch + m.pr * roll, a->turn.roll_rad + m.pr * pitch + m.rr * roll}, m};
}

static bool within_limits(const vista_alignment_params *params, vista_turn turn) {
  return fabs(turn.pitch_rad) <= VISTA_RADIANS_PER_DEGREE * params->pitch_max_deg &&
         fabs(turn.roll_rad) <= VISTA_RADIANS_PER_DEGREE * params->roll_max_deg;
}

/* Takes over what is found, unless that is beyond the limits. */
static bool believe(vista_alignment *a, const belief *found) {
  a->beyond = !within_limits(&a->parameters, found->turn);
  if (a->beyond) return false;
  a->known = *found;
  return true;
}

/* A fit that what is known does not explain. Returns whether it has been taken over. */
static bool wait_and_see(vista_alignment *a, const belief *fit) {
  const bool agrees = a->sudden_pairs > 0 && distance(&a->sudden, fit) <= GATE;
  a->sudden = agrees ? joined(&a->sudden, fit) : *fit;
  a->sudden_pairs = agrees ? a->sudden_pairs + 1 : 1;
  if (a->sudden_pairs < SUDDEN_PAIRS) return false;
  const double wide = SUDDEN_RAD * SUDDEN_RAD;
  const belief before = {a->known.turn, vista_turn_matrix_add(a->known.covariance, (vista_turn_matrix){wide, 0, wide})};
  const belief after = joined(&before, &a->sudden);
  a->sudden_pairs = SUDDEN_PAIRS; /* goes on being asked while it is beyond the limits */
  if (!believe(a, &after)) return false;
  a->sudden_pairs = 0;
  a->pairs = a->good_pairs = SUDDEN_PAIRS;
  return true;
}

/* Features that should be found in one place, and neither agree nor lie near their rows. */
static bool is_unexplained(const vista_row_matches *m, const vista_row_fit *fit) {
  const bool near_rows = fit->agreed && fit->row_error_px <= USABLE_ROWS_PX;
  return !m->frozen && !near_rows && m->features - m->ambiguous >= TEXTURE_FEATURES;
}

/* Returns whether the pair agrees with what is known afterwards. */
static bool take(vista_alignment *a, const vista_row_fit *fit, const vista_turn *applied) {
  const belief found = {{applied->pitch_rad + fit->turn.pitch_rad, applied->roll_rad + fit->turn.roll_rad},
                        vista_turn_matrix_add(fit->covariance, a->frame_error)};
  if (distance(&a->known, &found) > GATE) return wait_and_see(a, &found);
  a->sudden_pairs = 0;
  if (a->pairs < SUDDEN_PAIRS) ++a->pairs;
  const belief both = joined(&a->known, &found);
  return believe(a, &both);
}

/* How long there has been no agreement. Texture that repeats itself may agree by chance: what was lost is found again
 * when as many pairs agree as are asked for a sudden turn. */
static void watch(vista_alignment *a, bool measured, bool unexplained, double passed_s) {
  if (unexplained) {
    a->good_pairs = 0;
    if (a->was_unexplained) a->unexplained_s += passed_s;
  }
  if (measured && a->good_pairs < SUDDEN_PAIRS) ++a->good_pairs;
  const bool is_lost = a->unexplained_s >= LOST_S;
  if (is_lost ? a->good_pairs == SUDDEN_PAIRS : measured) a->unexplained_s = 0.0;
}

/* What the next pair is rectified for: another turn only where that moves rows, and is no noise. */
static vista_turn correction(const vista_alignment *a, const vista_turn *applied) {
  const vista_turn step = minus(a->known.turn, *applied);
  const bool moves = vista_turn_matrix_square(a->rows, step) > vista_square(STEP_PX);
  const bool known = vista_turn_matrix_square(vista_turn_matrix_inverse(a->known.covariance), step) > SIGNIFICANT;
  return moves && known && a->pairs == SUDDEN_PAIRS ? a->known.turn : *applied;
}

static vista_status check_pair(const vista_alignment *a, const vista_image *left, const vista_image *right,
                               int64_t t_ns, const vista_turn *applied) {
  const vista_camera *const camera = &a->camera;
  vista_status status = vista_frame_check_image(left, camera->width_px, camera->height_px);
  if (status == VISTA_OK) status = vista_frame_check_image(right, camera->width_px, camera->height_px);
  if (status != VISTA_OK) return status;
  if (!isfinite(applied->pitch_rad) || !isfinite(applied->roll_rad)) return VISTA_ERROR_NUMBER;
  return a->started && t_ns <= a->t_ns ? VISTA_ERROR_ORDER : VISTA_OK;
}

vista_status vista_alignment_update(vista_alignment *a, const vista_image *left, const vista_image *right, int64_t t_ns,
                                    const vista_turn *applied, vista_alignment_result *result) {
  if (a == NULL || left == NULL || right == NULL || applied == NULL || result == NULL) return VISTA_ERROR_ARGUMENT;
  const vista_status status = check_pair(a, left, right, t_ns, applied);
  if (status != VISTA_OK) return status;
  const double passed_s = a->started ? fmin(vista_seconds_between(a->t_ns, t_ns), STEP_S_MOST) : 0.0;
  a->started = true;
  a->t_ns = t_ns;
  const double drift = vista_square(VISTA_RADIANS_PER_DEGREE * DRIFT_DEG) * passed_s;
  a->known.covariance = vista_turn_matrix_add(a->known.covariance, (vista_turn_matrix){drift, 0.0, drift});

  vista_image_noise noise;
  (void)vista_image_noise_measure(left, &noise);
  vista_row_matches_find(left, right, noise.sigma, a->wide, &a->matches);
  const vista_row_fit fit = vista_row_fit_make(&a->camera, a->matches.matches, a->matches.count);
  const bool measured = fit.agreed && take(a, &fit, applied);
  const bool unexplained = !measured && is_unexplained(&a->matches, &fit);
  watch(a, measured, unexplained, passed_s);
  const bool again = unexplained && a->was_unexplained;
  a->was_unexplained = unexplained;
  a->wide = !measured;

  const bool lost = a->unexplained_s >= LOST_S && !a->beyond;
  const vista_turn next = a->beyond || lost ? *applied : correction(a, applied);
  *result =
      (vista_alignment_result){.state = lost        ? VISTA_ALIGNMENT_LOST
                                        : a->beyond ? VISTA_ALIGNMENT_BEYOND
                                        : measured  ? VISTA_ALIGNMENT_MEASURED
                                                    : VISTA_ALIGNMENT_HELD,
                               .correction = next,
                               .changed = next.pitch_rad != applied->pitch_rad || next.roll_rad != applied->roll_rad,
                               .estimate = a->known.turn,
                               .rows_known = fit.agreed,
                               .row_error_px = fit.row_error_px,
                               .row_error_90_px = fit.row_error_90_px,
                               .features = a->matches.features,
                               .matched = a->matches.count,
                               .agreeing = fit.agreed ? fit.agreeing : 0,
                               .unexplained = again && !fit.agreed};
  return VISTA_OK;
}

void vista_alignment_judge(const vista_alignment_result *result, vista_health *health) {
  const bool alarm = result->state == VISTA_ALIGNMENT_BEYOND || result->state == VISTA_ALIGNMENT_LOST;
  const bool apart = result->rows_known && result->row_error_px > ALIGNED_ROWS_PX;
  const bool usable = result->rows_known && result->row_error_px <= USABLE_ROWS_PX;
  const vista_health_state state = usable ? VISTA_HEALTH_DEGRADED : VISTA_HEALTH_BLIND;
  if (!alarm && !apart) return;
  health->reasons |= UINT32_C(1) << (alarm ? VISTA_HEALTH_ALIGNMENT_LOST : VISTA_HEALTH_ROWS_MISALIGNED);
  if (health->state < state) health->state = state;
}
