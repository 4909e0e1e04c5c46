#include "space/collision_volume.h"

#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include "common/frame.h"
#include "common/numbers.h"
#include "perceive/region/region_boundary.h"

#define OUTLINE_PX 3.5 /* by which matching widens a thing to each side: so much nearer to the path has a pixel to be */

/* What the pixels of a run are asked, in engine words w = 16 d; straight ahead squared, so that nothing is divided. */
typedef struct limits {
  float radius_px; /* radius / 16 B, times w the radius in the image: inside when |q x a| <= radius_px w - outline_px */
  float outline_px; /* that things are widened by */
  float along; /* 16 B / length: inside when w >= along q . a */
  float a[3];
  float focal_px;
  float length_m, radius_m, words_m; /* words_m = 16 B: times q / w the point */
  float doubt_rad; /* of the direction: the volume is narrower by that much of the way */
  bool curved; /* what follows is of an arc alone */
  float n[3];
  float curvature, cosine, sine_m; /* of the turn over the length, the sine over the curvature */
  float bend_doubt_1_m; /* of half the curvature */
} limits;

static inline int32_t inside_straight(const limits *limit, float u, float v, float word) {
  const float along = u * limit->a[0] + v * limit->a[1] + limit->focal_px * limit->a[2];
  const float across2 = u * u + v * v + limit->focal_px * limit->focal_px - along * along;
  const float whole = limit->radius_px * word, least = (float)VISTA_LIKELY_RADIUS_MIN * whole;
  const float likely = whole - limit->doubt_rad * along;
  const float reach = (likely > least ? likely : least) - limit->outline_px;
  return (along > 0.0f) & (word >= limit->along * along) & (reach >= 0.0f) & (reach * reach >= across2);
}

/* The distance from the circle, (1 - c rho) / c, without its cancellation: with s = c (X^2 + Y^2) - 2 Y it is
 * -s / (1 + c rho), c rho = sqrt(1 + c s). The word is positive. */
static inline int32_t inside_arc(const limits *limit, float u, float v, float word) {
  const float scale = limit->words_m / word;
  const float x = scale * (u * limit->a[0] + v * limit->a[1] + limit->focal_px * limit->a[2]);
  const float y = scale * (u * limit->n[0] + v * limit->n[1] + limit->focal_px * limit->n[2]);
  const float all2 = scale * scale * (u * u + v * v + limit->focal_px * limit->focal_px), plane2 = x * x + y * y;
  const float s = limit->curvature * plane2 - 2.0f * y, square = 1.0f + limit->curvature * s;
  const float aside = s / (1.0f + sqrtf(square > 0.0f ? square : 0.0f));
  const float doubt2 =
      x * x * (limit->doubt_rad * limit->doubt_rad) + x * x * x * x * (limit->bend_doubt_1_m * limit->bend_doubt_1_m);
  const float likely = limit->radius_m - sqrtf(doubt2), least = (float)VISTA_LIKELY_RADIUS_MIN * limit->radius_m;
  const float reach = (likely > least ? likely : least) - limit->outline_px * scale;
  return (x > 0.0f) & (reach >= 0.0f) & (aside * aside + all2 - plane2 <= reach * reach) &
         (x * limit->cosine <= (1.0f - limit->curvature * y) * limit->sine_m);
}

static inline int32_t inside(const limits *limit, bool curved, float u, float v, float word) {
  return curved ? inside_arc(limit, u, v, word) : inside_straight(limit, u, v, word);
}

/* Whether a word from `least` to `most` may be inside anywhere within around_px of (u, v): a bound with a margin, so
 * that whole cells are passed over and the count is the same. No point of the volume is farther than length_m +
 * radius_m, and the arc leaves its tangent by c x^2 at most, x along the tangent. */
static bool may_hold(const limits *limit, float u, float v, float around_px, float least, float most) {
  if (most <= 0.0f) return false;
  const float along = u * limit->a[0] + v * limit->a[1] + limit->focal_px * limit->a[2];
  const float all2 = u * u + v * v + limit->focal_px * limit->focal_px, across2 = all2 - along * along;
  const float range_px = sqrtf(all2), across_px = sqrtf(across2 > 0.0f ? across2 : 0.0f);
  const float scale = 0.999f * limit->words_m / most; /* of the nearest */
  if (scale * (range_px - around_px) > limit->length_m + limit->radius_m) return false;
  const float farthest_m = limit->words_m / fmaxf(least, 1.0f) * (range_px + around_px) + limit->radius_m;
  const float ahead_m = 1.001f * fminf(farthest_m, limit->length_m);
  return scale * (across_px - around_px) <= limit->radius_m + limit->curvature * ahead_m * ahead_m;
}

/* The pixels of a plain region lie on its surface, whatever chance matched there. */
static inline int32_t count_plain_run(const limits *limit, bool curved, float x, float y, int32_t length,
                                      float surface_word, float slope_words) {
  int32_t count = 0;
  for (int32_t i = 0; i < length; ++i) {
    const float w = surface_word + slope_words * (float)i;
    count += (w > 0.0f) & inside(limit, curved, x + (float)i, y, w > 0.0f ? w : 1.0f);
  }
  return count;
}

static inline int32_t count_run(const limits *limit, bool curved, const int16_t *words, float x, float y,
                                int32_t length, float surface_word, float slope_words, float tolerance_words) {
  int32_t count = 0;
  for (int32_t i = 0; i < length; ++i) {
    const float w = (float)words[i];
    const int32_t own = (w > 0.0f) & (fabsf(w - surface_word - slope_words * (float)i) <= tolerance_words);
    count += own & inside(limit, curved, x + (float)i, y, w > 0.0f ? w : 1.0f);
  }
  return count;
}

static int32_t count_region(const vista_foveation *foveation, const vista_camera *camera, const limits *limit,
                            const vista_disparity_image *disparity, double tolerance_px, const int32_t *members,
                            int32_t member_count, const vista_region *region) {
  const float across_words = (float)(VISTA_DISPARITY_SCALE * (fabs(region->slope_u) + fabs(region->slope_v)));
  const float tolerance = (float)(tolerance_px * VISTA_DISPARITY_SCALE);
  int32_t count = 0;
  for (int32_t m = 0; m < member_count; ++m) {
    const int32_t node = members[m];
    const double u = (double)foveation->center_u[node], v = (double)foveation->center_v[node];
    const float middle = (float)(VISTA_DISPARITY_SCALE * vista_region_surface_px(region, u, v));
    const float around_px = foveation->size_px[node] + 2.0f; /* from its centre to its pixels, and more */
    const float off = around_px * across_words + tolerance + 1.0f;
    if (!may_hold(limit, (float)(u - camera->center_u_px), (float)(v - camera->center_v_px), around_px, middle - off,
                  middle + off))
      continue;
    for (int32_t r = foveation->first_run[node]; r < foveation->first_run[node + 1]; ++r) {
      const vista_run run = foveation->runs[r];
      const float x = (float)(run.u_px - camera->center_u_px), y = (float)(run.v_px - camera->center_v_px);
      const float surface = (float)(vista_region_surface_px(region, run.u_px, run.v_px) * VISTA_DISPARITY_SCALE);
      const float slope = (float)(region->slope_u * VISTA_DISPARITY_SCALE);
      if (region->plain) {
        count += limit->curved ? count_plain_run(limit, true, x, y, run.length_px, surface, slope)
                               : count_plain_run(limit, false, x, y, run.length_px, surface, slope);
        continue;
      }
      const int16_t *const words = disparity->data + run.v_px * disparity->stride + run.u_px;
      count += limit->curved ? count_run(limit, true, words, x, y, run.length_px, surface, slope, tolerance)
                             : count_run(limit, false, words, x, y, run.length_px, surface, slope, tolerance);
    }
  }
  return count;
}

/* ---- where it is met ---- */

#define MET_SHARE 0.1 /* of the area in the volume: what is touched first, */
#define MET_SKIPPED 0.02 /* but for this, which may be wrong */
#define MET_MIN_PX2 8.0 /* or this, against single wrong words */
#define MET_BINS 160 /* of the centre of the ball that touches it, along the path: from MET_FROM_M on, */
#define MET_RATIO 0.03 /* each by that share longer */
#define MET_FROM_M 1.0
#define MET_NOISE_SIGMAS 1.6 /* by which noise alone makes what is touched first of a surface nearer */
#define MET_NOISE_MAX_PX 0.2 /* of the words: more is relief */
#define MET_DEEPEST_M 4.0 /* from a surface to the front of the thing; nor is that more than half its size */
#define MET_SIGMA_PX 0.1 /* of the matcher, as long as the thing is in view */
#define MET_RELIEF_M 0.1 /* of a surface */
#define MET_RELIEF_SHARE 0.2 /* of how deep the front is: how far the foremost branch reaches beyond it */

/* Of one cell on the region's surface: whether the volume holds it, and where on the path the centre of the ball is
 * that touches it. */
static bool touch(const vista_camera *camera, const vista_flight_path *path, double radius_m, double u_px, double v_px,
                  double disparity_px, double *centre_m) {
  const double scale = camera->baseline_m / disparity_px;
  const double point_m[3] = {scale * (u_px - camera->center_u_px), scale * (v_px - camera->center_v_px),
                             scale * camera->focal_px};
  double at_m[3];
  const double along_m = vista_flight_path_along(path, point_m, NULL);
  if (!(along_m > 0.0) || along_m > path->length_m) return false;
  vista_flight_path_point(path, along_m, at_m, NULL);
  double aside2 = 0.0;
  for (int i = 0; i < 3; ++i) aside2 += vista_square(point_m[i] - at_m[i]);
  *centre_m = along_m - sqrt(fmax(radius_m * radius_m - aside2, 0.0));
  return aside2 <= radius_m * radius_m;
}

static int bin_of(double centre_m) {
  return (int)fmin(fmax(log(fmax(centre_m, MET_FROM_M) / MET_FROM_M) / log1p(MET_RATIO), 0.0), MET_BINS - 1);
}

/* How much nearer than its surface a region's cells may be: by half its size, which its moments tell. */
static double front_px(const vista_camera *camera, const vista_region *region) {
  const double depth_m = camera->focal_px * camera->baseline_m / region->disparity_px;
  const double half_px = 2.0 * sqrt(fmax(fmin(region->cov_uu_px2, region->cov_vv_px2), 0.0));
  const double front_m = fmin(fmin(half_px * depth_m / camera->focal_px, MET_DEEPEST_M), 0.5 * depth_m);
  return region->disparity_px * front_m / (depth_m - front_m);
}

typedef struct touched {
  double area_px2;
  double u_px, v_px, surface_px, nearer_px; /* the surface's disparity there, and what the cells are nearer */
} touched;

static void add_touched(touched *sum, const touched *more, double share) {
  sum->area_px2 += share * more->area_px2;
  sum->u_px += share * more->u_px;
  sum->v_px += share * more->v_px;
  sum->surface_px += share * more->surface_px;
  sum->nearer_px += share * more->nearer_px;
}

/* Means over the area from skipped_px2 to needed_px2, nearest first. */
static touched first_touched(const touched bins[MET_BINS], double skipped_px2, double needed_px2) {
  touched sum = {0};
  double before_px2 = 0.0;
  for (int k = 0; k < MET_BINS && before_px2 < needed_px2; ++k) {
    if (!(bins[k].area_px2 > 0.0)) continue;
    const double after_px2 = before_px2 + bins[k].area_px2;
    const double kept_px2 = fmin(after_px2, needed_px2) - fmax(before_px2, skipped_px2);
    if (kept_px2 > 0.0) add_touched(&sum, &bins[k], kept_px2 / bins[k].area_px2);
    before_px2 = after_px2;
  }
  const double scale = 1.0 / sum.area_px2;
  return (touched){sum.area_px2, scale * sum.u_px, scale * sum.v_px, scale * sum.surface_px, scale * sum.nearer_px};
}

/* The point itself, and how well its range is known. */
static void place(const vista_camera *camera, const vista_flight_path *path, const touched *first,
                  vista_region *region) {
  const double noise_px = MET_NOISE_SIGMAS * fmin(region->disparity_sigma_px, MET_NOISE_MAX_PX);
  const double relief_px =
      first->nearer_px > noise_px ? sqrt(vista_square(first->nearer_px) - vista_square(noise_px)) : 0.0;
  const double met_px = first->surface_px + relief_px;
  region->met = met_px > 0.0; /* of so small words a surface may be beyond infinity */
  if (!region->met) return;
  const double scale = camera->baseline_m / met_px, depth_m = scale * camera->focal_px;
  region->met_camera_m[0] = scale * (first->u_px - camera->center_u_px);
  region->met_camera_m[1] = scale * (first->v_px - camera->center_v_px);
  region->met_camera_m[2] = depth_m;
  const double taken_px = fmax(first->nearer_px, 0.0) - relief_px; /* for noise: it may be relief */
  const double words_m = depth_m / met_px * hypot(MET_SIGMA_PX, taken_px);
  const double front_m = depth_m * relief_px / fmax(first->surface_px, 0.5 * met_px);
  const double relief_m = hypot(MET_RELIEF_M, MET_RELIEF_SHARE * front_m);
  const double gradient = hypot(region->slope_u, region->slope_v);
  const double downhill[3] = {region->slope_u / fmax(gradient, DBL_MIN), region->slope_v / fmax(gradient, DBL_MIN),
                              0.0};
  const double aside_m = depth_m / camera->baseline_m * gradient * vista_flight_path_sigma_m(path, depth_m, downhill);
  region->met_sigma_m = hypot(hypot(words_m, relief_m), aside_m);
}

/* The middle of what the ball touches first of a region, cell by cell. */
static void meet(const vista_foveation *foveation, const vista_camera *camera, const limits *limit,
                 const vista_flight_path *path, double radius_m, const float *disparity_px, double tolerance_px,
                 const int32_t *members, int32_t member_count, vista_region *region) {
  touched bins[MET_BINS] = {{0}};
  const double nearest_px = fmax(tolerance_px, front_px(camera, region));
  double all_px2 = 0.0;
  for (int32_t m = 0; m < member_count; ++m) {
    const int32_t node = members[m];
    const double u = (double)foveation->center_u[node], v = (double)foveation->center_v[node];
    const double surface = vista_region_surface_px(region, u, v), own = (double)disparity_px[node];
    if (!region->plain && (own <= 0.0 || own < surface - tolerance_px || own > surface + nearest_px)) continue;
    const double disparity = region->plain ? surface : own;
    const float word = (float)(VISTA_DISPARITY_SCALE * disparity);
    if (!may_hold(limit, (float)(u - camera->center_u_px), (float)(v - camera->center_v_px), 2.0f, word, word))
      continue;
    double centre_m;
    if (!touch(camera, path, radius_m, u, v, disparity, &centre_m)) continue;
    const double area_px2 = vista_square((double)foveation->size_px[node]);
    const touched cell = {1.0, u, v, surface, disparity - surface};
    all_px2 += area_px2;
    add_touched(&bins[bin_of(centre_m)], &cell, area_px2);
  }
  if (!(all_px2 >= MET_MIN_PX2)) return;
  const double needed_px2 = fmax(MET_SHARE * all_px2, MET_MIN_PX2);
  const touched first = first_touched(bins, fmin(MET_SKIPPED * all_px2, 0.5 * needed_px2), needed_px2);
  place(camera, path, &first, region);
}

vista_collision_volume vista_collision_volume_around(const vista_frame_view *frame) {
  const vista_obstacle_map_params *const params = &frame->params->obstacle_map;
  const vista_flight_path *const path = &frame->path;
  vista_collision_volume volume = {.radius_m = params->collision_radius_m,
                                   .outline_px = OUTLINE_PX,
                                   .path_sigmas = params->path_sigmas,
                                   .length_m = path->length_m,
                                   .curvature_1_m = path->curvature_1_m,
                                   .sigma_rad = path->sigma_rad};
  vista_frame_direction_to_camera(&frame->motion.pose, path->direction, volume.direction_camera);
  vista_frame_direction_to_camera(&frame->motion.pose, path->normal, volume.normal_camera);
  return volume;
}

vista_flight_path vista_collision_volume_path(const vista_collision_volume *volume) {
  vista_flight_path path = {
      .curvature_1_m = volume->curvature_1_m, .length_m = volume->length_m, .sigma_rad = volume->sigma_rad};
  memcpy(path.direction, volume->direction_camera, sizeof path.direction);
  memcpy(path.normal, volume->normal_camera, sizeof path.normal);
  return path;
}

void vista_collision_volume_count(const vista_frame_view *frame, const vista_collision_volume *volume,
                                  const vista_cells *cells, vista_regions *regions) {
  const vista_foveation *const foveation = frame->foveation;
  const vista_camera *const camera = frame->camera;
  const double words = VISTA_DISPARITY_SCALE * camera->baseline_m;
  const double *const a = volume->direction_camera, *const n = volume->normal_camera;
  const double turn = volume->curvature_1_m * volume->length_m;
  const vista_flight_path path = vista_collision_volume_path(volume);
  const limits limit = {
      .radius_px = (float)(volume->radius_m / words),
      .outline_px = (float)volume->outline_px,
      .along = (float)(words / volume->length_m),
      .a = {(float)a[0], (float)a[1], (float)a[2]},
      .focal_px = (float)camera->focal_px,
      .doubt_rad = (float)(volume->path_sigmas * volume->sigma_rad),
      .bend_doubt_1_m = (float)(volume->path_sigmas * 0.5 * VISTA_CURVATURE_SIGMA * volume->curvature_1_m),
      .length_m = (float)volume->length_m,
      .radius_m = (float)volume->radius_m,
      .words_m = (float)words,
      .curved = volume->curvature_1_m > 0.0,
      .n = {(float)n[0], (float)n[1], (float)n[2]},
      .curvature = (float)volume->curvature_1_m,
      .cosine = (float)cos(turn),
      .sine_m = (float)(volume->curvature_1_m > 0.0 ? sin(turn) / volume->curvature_1_m : 0.0)};
  for (int32_t k = 0; k < regions->count; ++k) {
    vista_region *const region = &regions->items[k];
    if (region->verdict != VISTA_REGION_ACCEPTED) continue;
    const int32_t first = regions->first_member[k];
    const double tolerance_px = vista_region_tolerance_px(camera, region->disparity_px);
    region->volume_pixels = count_region(foveation, camera, &limit, &frame->words, tolerance_px,
                                         regions->members + first, regions->first_member[k + 1] - first, region);
    if (region->volume_pixels > 0)
      meet(foveation, camera, &limit, &path, volume->radius_m, cells->disparity_px, tolerance_px,
           regions->members + first, regions->first_member[k + 1] - first, region);
  }
}
