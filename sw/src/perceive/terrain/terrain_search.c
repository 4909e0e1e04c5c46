#include "perceive/terrain/terrain_search.h"

#include <math.h>

#include "common/numbers.h"
#include "common/plane_fit.h"
#include "perceive/scales.h"

#define LEAN_MIN_DEG 35.0 /* what leans more than this from the vertical is ground; what is steeper stands */
#define AGREE_FRACTION 0.6 /* of the words where the volume meets the ground that has to lie on its surface */
#define NEAREST_M 1.0      /* nearer, nothing is searched */
#define BIN_RATIO 1.1      /* of the range, from one bin to the next */
#define BINS 64
#define BIN_SHARE 0.06     /* of the volume's cross-section, that has to lie in it before a plane is tried */
#define PASSES 4
#define WINDOW_NEAR 0.75   /* of the contact's range: cells from here .. */
#define WINDOW_FAR 1.35    /* .. to there make the plane */
#define MIN_CELLS 12
#define SEEN_SHARE 0.25    /* of where it would be seen, has to have words */
#define SEEN_AROUND 0.08   /* of the contact's range, before it and behind it, is looked at on the ground, or */
#define SEEN_AROUND_M 1.2  /* this, if it is more */
#define SEEN_BESIDE 1.25   /* radii from the path, likewise */
#define TOLERANCE_SHARE 0.04
#define STEPS 100          /* along an arc, and then by halves */
#define PRECISION_M 1e-3

static double tolerance_px(double disparity_px) { return fmax(VISTA_SURFACE_PX, TOLERANCE_SHARE * disparity_px); }

/* Along the path, and the square of the distance from it. */
typedef struct place {
  double along_m, beside2_m2;
} place;

static place place_of(const vista_flight_path *path, const double point_m[3]) {
  const double all2 = vista_dot(point_m, point_m), x = vista_dot(point_m, path->direction), c = path->curvature_1_m;
  if (!(c > 0.0)) return (place){x, all2 - x * x};
  const double y = vista_dot(point_m, path->normal), plane2 = x * x + y * y, s = c * plane2 - 2.0 * y;
  const double aside = s / (1.0 + sqrt(fmax(1.0 + c * s, 0.0)));
  return (place){atan2(c * x, 1.0 - c * y) / c, aside * aside + all2 - plane2};
}

static void ray_of(const vista_terrain_view *w, int32_t node, double ray[3]) {
  ray[0] = (double)w->foveation->center_u[node] - w->camera->center_u_px;
  ray[1] = (double)w->foveation->center_v[node] - w->camera->center_v_px;
  ray[2] = w->camera->focal_px;
}

static place place_of_cell(const vista_terrain_view *w, const vista_flight_path *path, int32_t node,
                           double disparity_px) {
  double point_m[3];
  ray_of(w, node, point_m);
  for (int i = 0; i < 3; ++i) point_m[i] *= w->camera->baseline_m / disparity_px;
  return place_of(path, point_m);
}

static double area_px2(const vista_terrain_view *w, int32_t node) {
  return (double)w->foveation->size_px[node] * (double)w->foveation->size_px[node];
}

/* How far a ball on the path reaches beyond the plane, metres, with its centre at centre_m along the path. What sweeps
 * the volume touches a slope with the point that is nearest to it, and not with the one that is lowest. */
static double depth_m(const vista_flight_path *path, const vista_terrain_plane *plane, double centre_m,
                      vista_terrain_contact *at) {
  double at_m[3], direction[3];
  vista_flight_path_point(path, centre_m, at_m, direction);
  at->sine = vista_dot(plane->normal, direction);
  for (int i = 0; i < 3; ++i) at->point_m[i] = at_m[i] + at->radius_m * plane->normal[i];
  at->along_m = centre_m + at->radius_m * at->sine;
  return vista_dot(plane->normal, at->point_m) - plane->offset_m;
}

/* Finds the first touch by halving, between the step to centre_m, where the ball is inside of the plane, and the one
 * before. */
static vista_terrain_contact first_touch(const vista_flight_path *path, const vista_terrain_plane *plane, double step_m,
                                         double centre_m, vista_terrain_contact at) {
  for (double half_m = 0.5 * step_m; half_m > PRECISION_M; half_m *= 0.5)
    centre_m += depth_m(path, plane, centre_m, &at) < 0.0 ? half_m : -half_m;
  (void)depth_m(path, plane, centre_m, &at);
  return at;
}

bool vista_terrain_meet(const vista_terrain_volume *volume, const vista_terrain_plane *plane, double sine_min,
                        vista_terrain_contact *contact) {
  const vista_flight_path *const path = &volume->path;
  const double clearance_m = plane->offset_m - vista_dot(plane->normal, path->start_m);
  vista_terrain_contact at = {.radius_m = fmin(volume->radius_m, volume->clearance_share * clearance_m)};
  const double start_m = depth_m(path, plane, 0.0, &at);
  if (!(clearance_m > 0.0) || !(start_m < 0.0))
    return false; /* beyond it already, or in it: no plane that lies ahead */
  if (!(path->curvature_1_m > 0.0)) {
    if (!(at.sine >= sine_min) || -start_m > at.sine * path->length_m) return false;
    (void)depth_m(path, plane, -start_m / at.sine, &at);
    *contact = at;
    return true;
  }
  const double step_m = path->length_m / STEPS;
  bool touches = false; /* what is touched first, and left again or entered at a steeper angle later */
  for (int k = 1; k <= STEPS; ++k) {
    const bool inside = depth_m(path, plane, k * step_m, &at) >= 0.0;
    const bool steep = at.sine >= sine_min;
    if (inside && !touches) *contact = first_touch(path, plane, step_m, k * step_m, at);
    if (inside && (steep || contact->sine >= sine_min)) return true;
    touches = inside;
  }
  return false;
}

vista_terrain_sight vista_terrain_look(const vista_terrain_view *w, const vista_terrain_volume *volume,
                                       const vista_terrain_plane *plane, const vista_terrain_contact *contact) {
  const double beside2 = vista_square(SEEN_BESIDE * contact->radius_m);
  const double around_m = fmax(SEEN_AROUND * contact->along_m, SEEN_AROUND_M);
  const double per_px = w->camera->baseline_m / plane->offset_m; /* disparity = per_px (normal . ray) */
  vista_terrain_sight sight = {0};
  for (int32_t i = 0; i < w->foveation->node_count; ++i) {
    double ray[3];
    ray_of(w, i, ray);
    const double expected_px = per_px * vista_dot(plane->normal, ray);
    if (expected_px <= 0.0) continue;
    const place at = place_of_cell(w, &volume->path, i, expected_px);
    if (fabs(at.along_m - contact->along_m) > around_m || at.beside2_m2 > beside2) continue;
    const double area = area_px2(w, i), disparity_px = (double)w->cells->disparity_px[i];
    sight.expected_px2 += area;
    if (disparity_px <= 0.0) continue;
    sight.valid_px2 += area;
    if (fabs(disparity_px - expected_px) <= tolerance_px(expected_px)) sight.agree_px2 += area;
  }
  return sight;
}

bool vista_terrain_dark(const vista_terrain_sight *sight) {
  return sight->valid_px2 < SEEN_SHARE * sight->expected_px2;
}

bool vista_terrain_seen(const vista_terrain_sight *sight) {
  return sight->valid_px2 >= VISTA_HALF_BLOCK_PX2 && !vista_terrain_dark(sight) &&
         sight->agree_px2 >= AGREE_FRACTION * sight->valid_px2;
}

/* The cells near the path, and the area of those inside the volume by their range. */
static int32_t collect(const vista_terrain_view *w, const vista_terrain_volume *volume, double bins_px2[BINS]) {
  const double radius2 = volume->radius_m * volume->radius_m,
               beside2 = VISTA_TERRAIN_BESIDE * VISTA_TERRAIN_BESIDE * radius2;
  int32_t count = 0;
  for (int k = 0; k < BINS; ++k) bins_px2[k] = 0.0;
  for (int32_t i = 0; i < w->foveation->node_count; ++i) {
    const double disparity_px = (double)w->cells->disparity_px[i];
    if (disparity_px <= 0.0) continue;
    const place at = place_of_cell(w, &volume->path, i, disparity_px);
    if (at.beside2_m2 > beside2 || at.along_m < NEAREST_M || at.along_m > WINDOW_FAR * volume->path.length_m) continue;
    w->candidates[count] = i;
    w->along_m[count++] = (float)at.along_m;
    if (at.beside2_m2 > radius2) continue;
    const int bin = (int)(log(at.along_m / NEAREST_M) / log(BIN_RATIO));
    if (bin < BINS) bins_px2[bin] += area_px2(w, i);
  }
  return count;
}

static vista_terrain_plane plane_of(const vista_camera *camera, const vista_plane *fit) {
  const double n[3] = {fit->slope_u, fit->slope_v, fit->offset / camera->focal_px};
  const double norm = vista_norm(n);
  vista_terrain_plane plane = {.offset_m = camera->baseline_m / norm};
  for (int i = 0; i < 3; ++i) plane.normal[i] = n[i] / norm;
  return plane;
}

/* Least squares over the cells around a range; from the second pass on of those near the plane before. */
static bool fit_around(const vista_terrain_view *w, int32_t count, double range_m, bool again, vista_plane *plane) {
  vista_plane_fit fit = {0};
  int32_t used = 0;
  for (int32_t k = 0; k < count; ++k) {
    if ((double)w->along_m[k] < WINDOW_NEAR * range_m || (double)w->along_m[k] > WINDOW_FAR * range_m) continue;
    const int32_t i = w->candidates[k];
    const double u = (double)w->foveation->center_u[i] - w->camera->center_u_px;
    const double v = (double)w->foveation->center_v[i] - w->camera->center_v_px;
    const double d = (double)w->cells->disparity_px[i];
    const double expected_px = plane->offset + plane->slope_u * u + plane->slope_v * v;
    if (again && fabs(d - expected_px) > tolerance_px(expected_px)) continue;
    vista_plane_fit_add(&fit, u, v, d, area_px2(w, i));
    used++;
  }
  return used >= MIN_CELLS && vista_plane_fit_solve(&fit, plane);
}

/* Fits the plane that the volume meets, beginning at a range where the volume holds cells. False: there is none. */
static bool settle(const vista_terrain_view *w, const vista_terrain_volume *volume, int32_t count, double range_m,
                   vista_terrain_plane *plane, vista_terrain_contact *contact) {
  const double least = sin(w->params->angle_min_deg * VISTA_RADIANS_PER_DEGREE);
  vista_plane fit = {0};
  for (int pass = 0; pass < PASSES; ++pass) {
    if (!fit_around(w, count, range_m, pass > 0, &fit)) return false;
    *plane = plane_of(w->camera, &fit);
    if (!vista_terrain_meet(volume, plane, least, contact)) return false;
    if (contact->along_m < WINDOW_NEAR * range_m || contact->along_m > WINDOW_FAR * range_m) return false;
    if (pass > 0) range_m = contact->along_m;
  }
  const double below = -vista_dot(plane->normal, w->up);
  return below >= sin(LEAN_MIN_DEG * VISTA_RADIANS_PER_DEGREE);
}

bool vista_terrain_find(const vista_terrain_view *view, const vista_terrain_volume *volume, vista_terrain_plane *plane,
                        vista_terrain_contact *contact) {
  double bins_px2[BINS];
  const int32_t count = collect(view, volume, bins_px2);
  for (int bin = 0; bin < BINS; ++bin) {
    const double range_m = NEAREST_M * pow(BIN_RATIO, bin + 1.0);
    const double radius_px = volume->radius_m * view->camera->focal_px / range_m;
    const double inside_px2 = bins_px2[bin] + (bin + 1 < BINS ? bins_px2[bin + 1] : 0.0);
    if (inside_px2 < BIN_SHARE * 3.14159265358979 * radius_px * radius_px || inside_px2 < VISTA_HALF_BLOCK_PX2)
      continue;
    if (!settle(view, volume, count, range_m, plane, contact)) continue;
    const vista_terrain_sight sight = vista_terrain_look(view, volume, plane, contact);
    if (vista_terrain_seen(&sight)) return true;
  }
  return false;
}
