/* The plane of the ground below.
 *
 * In the image of disparities a plane is affine (plane_fit.h). Triples of cells propose planes (RANSAC); those that
 * lean more than tilt_deg from the horizontal drop out before they are scored. Nothing is seen below the ground: a cell
 * on a plane speaks for it with its area, a cell beyond it speaks against it, so that neither a table nor a hedge nor a
 * chance slope through a street's two sides wins over the road. The best is refined by least squares over the cells
 * near it. */
#include "perceive/cells/surface.h"

#include <math.h>
#include <stdint.h>

#include "common/numbers.h"
#include "common/wide_vectors.h"
#include "perceive/scales.h"

#define GROUND_TILT_DEG 15.0 /* the ground leans at most this from the horizontal */
/* Least of the area below the horizon that has a disparity, after what lies below the plane is taken off. */
#define GROUND_SHARE 0.03
#define LEVEL_TRIALS 256      /* one cell each, on a plane as level as the attitude has it */
#define TRIALS 2048           /* three cells each */
#define LEAN_COST 0.8f        /* of the score, at the steepest that is allowed: a level plane is likelier */
#define MAX_SCORED 1024       /* cells that judge a proposal */
#define REFINEMENTS 4
#define SAME_VOTES 0.98f /* as many, but for a few cells at the edge of the tolerance */
#define MIN_CELLS 20
#define UPRIGHT_DEG 20.0f
/* Or VISTA_GROUND_SHARE of the disparity: matching noise, and roads that are not quite plane. */
#define TOLERANCE_PX 2.0f
#define CLOSE 0.5f /* of the tolerance: counts twice */

typedef struct sample {
  float u_px, v_px, disparity_px; /* u, v from the principal point */
  float area_px2, vote_px2; /* what it weighs against a plane that it lies beyond, and for one that it lies on */
} sample;

/* An upright cell may lie on a plane where a wall meets it: it says nothing for it. */
static sample sample_of(const vista_foveation *f, const vista_camera *camera, const vista_cells *cells,
                        const float *inclination_deg, int32_t node) {
  const float area_px2 = f->size_px[node] * f->size_px[node];
  const bool upright = inclination_deg[node] >= 0.0f && inclination_deg[node] < UPRIGHT_DEG;
  return (sample){f->center_u[node] - (float)camera->center_u_px, f->center_v[node] - (float)camera->center_v_px,
                  cells->disparity_px[node], area_px2, upright ? 0.0f : area_px2};
}

/* Cells with a disparity below the horizon as the attitude has it, lowered or raised by the tilt. */
static int32_t collect(const vista_foveation *f, const vista_camera *camera, const double up[3], double tilt_deg,
                       const vista_cells *cells, int32_t *candidates) {
  const double highest = sin(tilt_deg / VISTA_DEGREES_PER_RADIAN);
  int32_t count = 0;
  for (int32_t i = 0; i < f->node_count; ++i) {
    if (cells->disparity_px[i] < (float)VISTA_FARTHEST_PX) continue;
    const double x = ((double)f->center_u[i] - camera->center_u_px) / camera->focal_px;
    const double y = ((double)f->center_v[i] - camera->center_v_px) / camera->focal_px;
    const double rise = (x * up[0] + y * up[1] + up[2]) / sqrt(x * x + y * y + 1.0);
    if (rise < highest) candidates[count++] = i;
  }
  return count;
}

static uint32_t draw(uint32_t *state, uint32_t count) {
  *state = *state * UINT32_C(1664525) + UINT32_C(1013904223);
  return (uint32_t)(((uint64_t)*state * count) >> 32);
}

static bool through(const sample *a, const sample *b, const sample *c, vista_plane *plane) {
  const double bu = (double)(b->u_px - a->u_px), bv = (double)(b->v_px - a->v_px);
  const double cu = (double)(c->u_px - a->u_px), cv = (double)(c->v_px - a->v_px);
  const double bd = (double)(b->disparity_px - a->disparity_px), cd = (double)(c->disparity_px - a->disparity_px);
  const double determinant = bu * cv - bv * cu;
  if (fabs(determinant) < 1.0) return false;
  plane->slope_u = (bd * cv - bv * cd) / determinant;
  plane->slope_v = (bu * cd - bd * cu) / determinant;
  plane->offset = (double)a->disparity_px - plane->slope_u * (double)a->u_px - plane->slope_v * (double)a->v_px;
  return true;
}

/* Cosine of the plane's lean against the horizontal; negative above the camera. */
static double cosine_of_lean(const vista_camera *camera, const double up[3], const vista_plane *plane) {
  const double n[3] = {plane->slope_u, plane->slope_v, plane->offset / camera->focal_px}; /* towards the plane */
  const double norm = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
  return norm > 0.0 ? -(n[0] * up[0] + n[1] * up[1] + n[2] * up[2]) / norm : -1.0;
}

/* Horizontal, as the attitude has it, through one cell. */
static bool level_through(const vista_camera *camera, const double up[3], const sample *a, vista_plane *plane) {
  const double below = -((double)a->u_px * up[0] + (double)a->v_px * up[1] + camera->focal_px * up[2]);
  if (below < 1.0) return false;
  const double k = (double)a->disparity_px / below;
  *plane = (vista_plane){-k * up[2] * camera->focal_px, -k * up[0], -k * up[1]};
  return true;
}

static inline float tolerance_px(float ground_px) { return fmaxf(TOLERANCE_PX, (float)VISTA_GROUND_SHARE * ground_px); }

#define LANES 8
#define BLOCK 64 /* cells between two looks at whether a proposal can still win */

/* The cells that judge proposals, side by side: loops over them become vectors. The largest cells, which lie outermost,
 * come first, so that a proposal that cannot win is soon dropped. The last block is filled up with cells of no
 * weight. */
typedef struct jury {
  float u_px[MAX_SCORED], v_px[MAX_SCORED], disparity_px[MAX_SCORED], area_px2[MAX_SCORED], vote_px2[MAX_SCORED];
  float vote_from_px2[MAX_SCORED / BLOCK + 1]; /* of a block and those after it, at most */
  int32_t count; /* whole blocks */
} jury;

static void fill_jury(jury *j, const sample *samples, int32_t count) {
  j->count = (count + BLOCK - 1) / BLOCK * BLOCK;
  for (int32_t k = 0; k < j->count; ++k) {
    const sample one = k < count ? samples[count - 1 - k] : (sample){0};
    j->u_px[k] = one.u_px;
    j->v_px[k] = one.v_px;
    j->disparity_px[k] = one.disparity_px;
    j->area_px2[k] = one.area_px2;
    j->vote_px2[k] = one.vote_px2;
  }
  j->vote_from_px2[j->count / BLOCK] = 0.0f;
  for (int32_t block = j->count / BLOCK - 1; block >= 0; --block) {
    j->vote_from_px2[block] = j->vote_from_px2[block + 1];
    for (int32_t k = 0; k < BLOCK; ++k) j->vote_from_px2[block] += j->vote_px2[block * BLOCK + k];
  }
}

/* Sum of the votes; as soon as it cannot exceed `needed`, whatever has been counted. */
VISTA_WIDE_VECTORS static float score(const jury *j, const vista_plane *plane, float needed) {
  const float offset = (float)plane->offset, slope_u = (float)plane->slope_u, slope_v = (float)plane->slope_v;
  float sums[LANES] = {0}, sum = 0.0f;
  for (int32_t block = 0; block < j->count / BLOCK; ++block) {
    if (sum + j->vote_from_px2[block] <= needed) return sum;
    for (int32_t first = block * BLOCK; first < (block + 1) * BLOCK; first += LANES) {
      for (int32_t lane = 0; lane < LANES; ++lane) {
        const int32_t k = first + lane;
        const float ground = offset + slope_u * j->u_px[k] + slope_v * j->v_px[k];
        const float tolerance = vista_larger(TOLERANCE_PX, (float)VISTA_GROUND_SHARE * ground);
        const float above = j->disparity_px[k] - ground, size = fabsf(above);
        const int32_t near = size <= tolerance, close = size <= CLOSE * tolerance;
        const int32_t below = above + tolerance < 0.0f, known = ground >= (float)VISTA_FARTHEST_PX;
        sums[lane] +=
            0.5f * (float)(known * (near + close)) * j->vote_px2[k] + (float)(known * -below) * j->area_px2[k];
      }
    }
    sum = 0.0f;
    for (int32_t lane = 0; lane < LANES; ++lane) sum += sums[lane];
  }
  return sum;
}

/* Least squares over the cells near the plane. False: too few, or they span none. */
static bool refine(const sample *samples, int32_t count, float share_of_tolerance, vista_plane *plane) {
  vista_plane_fit fit = {0};
  int32_t used = 0;
  for (int32_t k = 0; k < count; ++k) {
    const sample *const s = &samples[k];
    const float ground = (float)(plane->offset + plane->slope_u * (double)s->u_px + plane->slope_v * (double)s->v_px);
    if (ground < (float)VISTA_FARTHEST_PX ||
        fabsf(s->disparity_px - ground) > share_of_tolerance * tolerance_px(ground))
      continue;
    vista_plane_fit_add(&fit, (double)s->u_px, (double)s->v_px, (double)s->disparity_px, (double)s->vote_px2);
    used++;
  }
  return used >= MIN_CELLS && vista_plane_fit_solve(&fit, plane);
}

typedef struct search {
  const vista_camera *camera;
  const double *up;
  double least_cosine;
  const jury *jury;
  const sample *samples;
  int32_t count;
  float best;
  vista_plane plane;
  bool found;
} search;

static bool consider_once(search *s, const vista_plane *plane) {
  const double cosine = cosine_of_lean(s->camera, s->up, plane);
  if (cosine < s->least_cosine) return false;
  const float lean = (float)sqrt(fmax(1.0 - cosine, 0.0) / fmax(1.0 - s->least_cosine, 1e-9)); /* 0 .. 1 */
  const float trust = 1.0f - LEAN_COST * lean;
  const float sum = trust * score(s->jury, plane, s->best / trust);
  if (sum <= s->best) return false;
  s->best = sum;
  s->plane = *plane;
  s->found = true;
  return true;
}

/* What proves better than all before is refined at once, and whatever comes of it is proposed, too. */
static void consider(search *s, const vista_plane *plane) {
  if (!consider_once(s, plane)) return;
  vista_plane better = *plane;
  for (int pass = 0; pass < REFINEMENTS; ++pass)
    if (!refine(s->samples, s->count, pass == 0 ? 1.0f : CLOSE, &better) || !consider_once(s, &better)) return;
}

/* Once more for the winner: a plane through few cells has their noise, and as many votes as a better one near it. */
static void settle(search *s) {
  vista_plane better = s->plane;
  for (int pass = 0; pass < REFINEMENTS; ++pass)
    if (!refine(s->samples, s->count, CLOSE, &better)) return;
  if (cosine_of_lean(s->camera, s->up, &better) < s->least_cosine) return;
  if (score(s->jury, &better, -INFINITY) >= SAME_VOTES * score(s->jury, &s->plane, -INFINITY)) s->plane = better;
}

bool vista_find_ground_plane(const vista_frame_view *frame, const vista_cells *cells, const float *inclination_deg,
                             int32_t *candidates, vista_plane *plane) {
  const vista_foveation *const foveation = frame->foveation;
  const vista_camera *const camera = frame->camera;
  const double *const up_camera = frame->up_camera;
  const int32_t count = collect(foveation, camera, up_camera, GROUND_TILT_DEG, cells, candidates);
  if (count < MIN_CELLS) return false;
  sample scored[MAX_SCORED];
  const int32_t scored_count = count < MAX_SCORED ? count : MAX_SCORED;
  float whole = 0.0f;
  for (int32_t k = 0; k < scored_count; ++k) {
    scored[k] = sample_of(foveation, camera, cells, inclination_deg, candidates[(int64_t)k * count / scored_count]);
    whole += scored[k].area_px2;
  }
  jury all;
  fill_jury(&all, scored, scored_count);
  search s = {.camera = camera,
              .up = up_camera,
              .least_cosine = cos(GROUND_TILT_DEG / VISTA_DEGREES_PER_RADIAN),
              .jury = &all,
              .samples = scored,
              .count = scored_count,
              .best = (float)GROUND_SHARE * whole};
  uint32_t state = 1;
  vista_plane trial_plane;
  for (int trial = 0; trial < LEVEL_TRIALS; ++trial)
    if (level_through(camera, up_camera, &scored[draw(&state, (uint32_t)scored_count)], &trial_plane))
      consider(&s, &trial_plane);
  for (int trial = 0; trial < TRIALS; ++trial) {
    const sample *const a = &scored[draw(&state, (uint32_t)scored_count)];
    const sample *const b = &scored[draw(&state, (uint32_t)scored_count)];
    const sample *const c = &scored[draw(&state, (uint32_t)scored_count)];
    if (through(a, b, c, &trial_plane)) consider(&s, &trial_plane);
  }
  if (s.found) settle(&s);
  *plane = s.plane;
  return s.found;
}
