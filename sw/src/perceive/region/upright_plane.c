#include "perceive/region/upright_plane.h"

#include <math.h>

#include "common/frame.h"
#include "common/numbers.h"

#define STEEP_MAX 0.9 /* sine of the camera's pitch */
#define APART 0.1     /* of the points' range of azimuths: two that are nearer tell no slope */
#define PASSES 3      /* of least squares, after the search */

bool vista_plan_of(const vista_camera *camera, const double up_camera[3], vista_plan *plan) {
  if (!(fabs(up_camera[2]) < STEEP_MAX)) return false;
  plan->camera = camera;
  vista_frame_level_axes(up_camera, plan->ahead, plan->right);
  return true;
}

bool vista_plan_place(const vista_plan *plan, double u_px, double v_px, double disparity_px, vista_plan_point *point) {
  const double ray[3] = {u_px - plan->camera->center_u_px, v_px - plan->camera->center_v_px, plan->camera->focal_px};
  const double ahead_px = vista_dot(plan->ahead, ray);
  if (!(ahead_px > 0.1 * plan->camera->focal_px)) return false;
  *point = (vista_plan_point){
      .t = vista_dot(plan->right, ray) / ahead_px, .k = disparity_px / ahead_px, .ahead_px = ahead_px, .weight = 1.0};
  return true;
}

static double residual_px(const vista_plan_point *p, const vista_plan_line *line) {
  return (p->k - line->offset - line->slope * p->t) * p->ahead_px;
}

static double support(const vista_plan_point *points, int32_t count, double tolerance_px, const vista_plan_line *line) {
  double sum = 0.0;
  for (int32_t i = 0; i < count; ++i)
    sum += points[i].weight * fmax(0.0, 1.0 - vista_square(residual_px(&points[i], line) / tolerance_px));
  return sum;
}

/* Tries the line through each two points: there are few. */
static bool search(const vista_plan_point *points, int32_t count, double tolerance_px, vista_plan_line *line) {
  double least = INFINITY, most = -INFINITY, best = 0.0;
  for (int32_t i = 0; i < count; ++i) {
    least = fmin(least, points[i].t);
    most = fmax(most, points[i].t);
  }
  for (int32_t i = 0; i < count; ++i)
    for (int32_t j = i + 1; j < count; ++j) {
      const double apart = points[j].t - points[i].t;
      if (!(fabs(apart) > APART * (most - least))) continue;
      vista_plan_line trial = {.slope = (points[j].k - points[i].k) / apart};
      trial.offset = points[i].k - trial.slope * points[i].t;
      const double sum = support(points, count, tolerance_px, &trial);
      if (sum <= best) continue;
      best = sum;
      *line = trial;
    }
  return best > 0.0;
}

/* Least squares of what is within the tolerance. */
static bool refine(const vista_plan_point *points, int32_t count, double tolerance_px, vista_plan_line *line) {
  int32_t used = 0;
  double n = 0.0, t = 0.0, k = 0.0, tt = 0.0, tk = 0.0, r = 0.0, rr = 0.0;
  for (int32_t i = 0; i < count; ++i) {
    const vista_plan_point *const p = &points[i];
    const double off_px = residual_px(p, line);
    if (fabs(off_px) > tolerance_px) continue;
    ++used;
    n += p->weight;
    t += p->weight * p->t;
    k += p->weight * p->k;
    tt += p->weight * p->t * p->t;
    tk += p->weight * p->t * p->k;
    r += p->weight * off_px;
    rr += p->weight * off_px * off_px;
  }
  if (!(n > 0.0)) return false;
  const double variance = tt / n - vista_square(t / n);
  if (!(variance > 0.0)) return false;
  line->slope = (tk / n - t / n * k / n) / variance;
  line->offset = k / n - line->slope * t / n;
  line->weight = n;
  line->count = used;
  line->sigma_px = sqrt(fmax(rr / n - vista_square(r / n), 0.0));
  return true;
}

bool vista_plan_fit(const vista_plan_point *points, int32_t count, double tolerance_px, vista_plan_line *line) {
  if (!search(points, count, tolerance_px, line)) return false;
  for (int pass = 0; pass < PASSES; ++pass)
    if (!refine(points, count, tolerance_px, line)) return false;
  return true;
}

vista_plane vista_plan_surface(const vista_plan *plan, const vista_plan_line *line) {
  double n[3];
  for (int i = 0; i < 3; ++i) n[i] = line->slope * plan->right[i] + line->offset * plan->ahead[i];
  const vista_camera *const c = plan->camera;
  return (vista_plane){
      .offset = n[2] * c->focal_px - n[0] * c->center_u_px - n[1] * c->center_v_px, .slope_u = n[0], .slope_v = n[1]};
}
