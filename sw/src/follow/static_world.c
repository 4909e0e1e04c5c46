#include "follow/static_world.h"

#include <math.h>
#include <stdbool.h>

#include "common/numbers.h"

/* Likelihood ratio at which a track is held to stand still, or, inverted, to move with the aircraft. */
#define STATIC_ODDS 6.0
/* Motion along the line of sight, of own travel, that what stands may seem to make: regions change on approach. */
#define STATIC_TOLERANCE 0.05
#define NOISE_HITS 1.4 /* hits in a row whose range errors are about the same: they count as one */
#define FADE_M 20.0 /* own travel over which earlier hits lose their say */
/* Slower along its line of sight, own travel tells nothing of a track: single frames have to do. */
#define TELLING_SPEED_MIN_M_S 0.5

/* Slopes that textures make: pitches of 0.18 to 19 baselines. Less is told from 0 by nothing, more hardly occurs. */
#define GHOST_SLOPE_MIN 0.15
#define GHOST_SLOPE_MAX 0.95
#define GHOST_DENSITY_MIN 1e-12 /* keeps the ratio finite where neither hypothesis says much */
#define NOISE_PRIOR_DOF 3.0 /* what the hits' own variances weigh against the scatter around the fit */
#define ACROSS_SIGMAS 4.0
#define ACROSS_SLOPE_MIN 0.1 /* centres of regions drift by less */
#define FOOT_HITS 2.5 /* fewer that tell of their foot say nothing */
#define FOOT_LOWEST (-0.1) /* of the share: what ends deeper beneath the ground stands on other ground, or is wrong */
#define FOOT_ERROR 0.04 /* of the share: the plane of the ground and the end of the region are known so well */
#define MOVES_SIGMAS 3.0
#define FADE_HITS 100.0 /* while hovering: errors that stay must not add up to certainty */

static const char *const verdict_names[VISTA_WORLD_VERDICT_COUNT] = {
    [VISTA_WORLD_OPEN] = "OPEN",
    [VISTA_WORLD_STANDS] = "STANDS",
    [VISTA_WORLD_MOVES] = "MOVES",
    [VISTA_WORLD_REFUTED] = "REFUTED",
};

const char *vista_world_verdict_name(vista_world_verdict verdict) {
  return (unsigned)verdict < VISTA_WORLD_VERDICT_COUNT ? verdict_names[verdict] : "UNKNOWN";
}

static void fade(double travelled_m, vista_static_world *w) {
  const double keep = exp(-fabs(travelled_m) / FADE_M - 1.0 / FADE_HITS);
  double *const sums[] = {&w->count, &w->weight,        &w->s,        &w->y,         &w->ss,         &w->sy,
                          &w->yy,    &w->across_weight, &w->across_s, &w->across_ss, &w->foot_count, &w->foot_share};
  for (unsigned i = 0; i < sizeof sums / sizeof sums[0]; ++i) *sums[i] *= keep;
  for (int i = 0; i < 3; ++i) {
    w->across_p[i] *= keep;
    w->across_sp[i] *= keep;
    w->across_c[i] *= keep;
    w->across_sc[i] *= keep;
  }
}

static void accumulate(const vista_world_hit *hit, vista_static_world *w) {
  double p[3], c[3];
  for (int i = 0; i < 3; ++i) {
    p[i] = hit->position_m[i] - w->start_m[i];
    c[i] = hit->camera_m[i] - w->start_m[i];
  }
  const double s = vista_dot(w->along, c), y = vista_dot(w->along, p);
  const double weight = 1.0 / vista_square(hit->along_sigma_m), across = 1.0 / vista_square(hit->across_sigma_m);
  if (hit->foot_seen && hit->foot_share > FOOT_LOWEST) {
    w->foot_count += 1.0;
    w->foot_share += hit->foot_share;
  }
  w->hits += 1;
  w->travel_m = s;
  w->count += 1.0;
  w->weight += weight;
  w->s += weight * s;
  w->y += weight * y;
  w->ss += weight * s * s;
  w->sy += weight * s * y;
  w->yy += weight * y * y;
  w->across_weight += across;
  w->across_s += across * s;
  w->across_ss += across * s * s;
  for (int i = 0; i < 3; ++i) {
    const double p_across = p[i] - y * w->along[i], c_across = c[i] - s * w->along[i];
    w->across_p[i] += across * p_across;
    w->across_sp[i] += across * s * p_across;
    w->across_c[i] += across * c_across;
    w->across_sc[i] += across * s * c_across;
  }
}

/* Weighted least squares. The variances of the hits are taken for as much too large, or too small, as the scatter
 * around the fit says: what hops between periods scatters, what stands hardly does. */
static void fit(vista_static_world *w) {
  const double ss = w->ss - w->s * w->s / w->weight;
  const double sy = w->sy - w->s * w->y / w->weight;
  const double yy = w->yy - w->y * w->y / w->weight;
  w->slope = 0.0;
  w->slope_sigma = INFINITY;
  if (!(ss > 0.0)) return;
  w->slope = sy / ss;
  const double residual = fmax(yy - w->slope * sy, 0.0), freedom = fmax(w->count - 2.0, 0.0);
  const double noise = (NOISE_PRIOR_DOF + residual) / (NOISE_PRIOR_DOF + freedom);
  w->slope_sigma = sqrt(NOISE_HITS * noise / ss);
}

/* Whether the track moves across the line of sight by more than w->slope of the camera's own motion. */
static bool moves_across(const vista_static_world *w) {
  const double ss = w->across_ss - w->across_s * w->across_s / w->across_weight;
  double slope2 = 0.0;
  for (int i = 0; i < 3; ++i) {
    const double p = w->across_sp[i] - w->across_s * w->across_p[i] / w->across_weight;
    const double c = w->across_sc[i] - w->across_s * w->across_c[i] / w->across_weight;
    slope2 += vista_square((p - w->slope * c) / ss);
  }
  return slope2 > vista_square(ACROSS_SLOPE_MIN) && slope2 > vista_square(ACROSS_SIGMAS) * NOISE_HITS / ss;
}

/* The largest slope that the image of a texture may have, by how high its foot hangs. */
static double ghost_slope_max(const vista_static_world *w) {
  if (w->foot_count < FOOT_HITS) return GHOST_SLOPE_MAX;
  return fmin(w->foot_share / w->foot_count + FOOT_ERROR, GHOST_SLOPE_MAX);
}

static double normal_below(double z) { return 0.5 * erfc(-z * 0.70710678118654752440); }

/* Density of the fitted slope if the track stands, over that if it moves with the aircraft. */
static double likelihood_ratio(const vista_static_world *w) {
  const double sigma = hypot(w->slope_sigma, STATIC_TOLERANCE);
  const double stands = exp(-0.5 * vista_square(fmax(w->slope, 0.0) / sigma)) / (sigma * 2.50662827463100050242);
  const double ghost = (normal_below((ghost_slope_max(w) - w->slope) / w->slope_sigma) -
                        normal_below((GHOST_SLOPE_MIN - w->slope) / w->slope_sigma)) /
                       (GHOST_SLOPE_MAX - GHOST_SLOPE_MIN);
  return stands / (ghost + GHOST_DENSITY_MIN);
}

static void judge(vista_static_world *w) {
  fit(w);
  if (!isfinite(w->slope_sigma)) return;
  if (ghost_slope_max(w) <= GHOST_SLOPE_MIN) {
    const bool moves = fabs(w->slope) > STATIC_TOLERANCE + MOVES_SIGMAS * w->slope_sigma;
    w->verdict = moves ? VISTA_WORLD_MOVES : VISTA_WORLD_STANDS;
    return;
  }
  const double ratio = likelihood_ratio(w);
  if (ratio >= STATIC_ODDS) w->verdict = VISTA_WORLD_STANDS;
  if (ratio * STATIC_ODDS <= 1.0) w->verdict = moves_across(w) ? VISTA_WORLD_MOVES : VISTA_WORLD_REFUTED;
}

void vista_static_world_start(const vista_world_hit *hit, vista_static_world *world) {
  *world = (vista_static_world){.slope_sigma = INFINITY, .start_t_ns = hit->t_ns};
  for (int i = 0; i < 3; ++i) {
    world->start_m[i] = hit->camera_m[i];
    world->along[i] = hit->position_m[i] - hit->camera_m[i];
  }
  const double range_m = sqrt(vista_dot(world->along, world->along));
  for (int i = 0; i < 3; ++i) world->along[i] /= range_m;
  vista_static_world_add(hit, world);
}

void vista_static_world_add(const vista_world_hit *hit, vista_static_world *world) {
  double travel_m = 0.0;
  for (int i = 0; i < 3; ++i) travel_m += world->along[i] * (hit->camera_m[i] - world->start_m[i]);
  fade(travel_m - world->travel_m, world);
  accumulate(hit, world);
  judge(world);
}

bool vista_static_world_silent(const vista_static_world *world, int64_t t_ns) {
  const double time_s = vista_seconds_between(world->start_t_ns, t_ns);
  return fabs(world->travel_m) <= TELLING_SPEED_MIN_M_S * time_s;
}

void vista_static_world_decide(const vista_static_world *world, bool silent, int32_t hits, int32_t needed,
                               bool *confirmed, bool *credible) {
  const bool open = world->verdict == VISTA_WORLD_OPEN, refuted = world->verdict == VISTA_WORLD_REFUTED;
  const bool supported = open ? silent : !refuted;
  *confirmed = *confirmed || hits >= needed + (open && !silent ? 1 : 0);
  *credible = *confirmed && !refuted && (*credible || supported);
}
