#include "common/plane_fit.h"

#include <math.h>

#include "common/numbers.h"

bool vista_plane_fit_solve(const vista_plane_fit *fit, vista_plane *plane) {
  if (!(fit->weight > 0.0)) return false;
  const double u = fit->u / fit->weight, v = fit->v / fit->weight, d = fit->d / fit->weight;
  const double uu = fit->uu / fit->weight - u * u, uv = fit->uv / fit->weight - u * v;
  const double vv = fit->vv / fit->weight - v * v;
  const double ud = fit->ud / fit->weight - u * d, vd = fit->vd / fit->weight - v * d;
  const double determinant = uu * vv - uv * uv;
  if (!(determinant > 1e-6 * (uu * vv + 1e-12))) return false; /* collinear */
  plane->slope_u = (ud * vv - vd * uv) / determinant;
  plane->slope_v = (vd * uu - ud * uv) / determinant;
  plane->offset = d - plane->slope_u * u - plane->slope_v * v;
  return true;
}

double vista_plane_fit_spread(const vista_plane_fit *fit, const vista_plane *plane) {
  const double u = fit->u / fit->weight, v = fit->v / fit->weight;
  const double uu = fit->uu / fit->weight - u * u, uv = fit->uv / fit->weight - u * v;
  const double vv = fit->vv / fit->weight - v * v;
  const double gu = plane->slope_u, gv = plane->slope_v;
  return sqrt(fmax(gu * gu * uu + 2.0 * gu * gv * uv + gv * gv * vv, 0.0));
}

double vista_plane_disparity_px(const vista_plane *plane, const vista_camera *camera, double u_px, double v_px) {
  return plane->offset + plane->slope_u * (u_px - camera->center_u_px) + plane->slope_v * (v_px - camera->center_v_px);
}

/* B |n|, see the header. */
static double normal_length(const vista_plane *plane, const vista_camera *camera) {
  const double n[3] = {plane->slope_u, plane->slope_v, plane->offset / camera->focal_px};
  return vista_norm(n);
}

double vista_plane_share_above(const vista_plane *plane, const vista_camera *camera, double u_px, double v_px,
                               double disparity_px) {
  return 1.0 - vista_plane_disparity_px(plane, camera, u_px, v_px) / disparity_px;
}

double vista_plane_share_per_m(const vista_plane *plane, const vista_camera *camera) {
  return normal_length(plane, camera) / camera->baseline_m;
}

double vista_plane_height_m(const vista_plane *plane, const vista_camera *camera, double u_px, double v_px,
                            double disparity_px) {
  return vista_plane_share_above(plane, camera, u_px, v_px, disparity_px) * camera->baseline_m /
         normal_length(plane, camera);
}
