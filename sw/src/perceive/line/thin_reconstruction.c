#include "perceive/line/thin_reconstruction.h"

#include <math.h>
#include <stdbool.h>
#include <stddef.h>

#include "common/flight_path.h"
#include "common/numbers.h"
#include "perceive/scales.h"

#define REACH_RADII 2.0    /* of the collision volume */
#define ACROSS_SIGMA_PX 0.7
#define ALONG_SIGMA_RAD 0.01 /* by which the direction of flight wanders: where on the line it leads to */
#define HALF_WIDTH_MIN_PX 1.0
#define BAND_OFF_PX 5.0    /* from the line to the middle of a band */
#define BAND_SIGMA_PX 6.5  /* standard deviation of a band's pixels across the line: of whole blocks that hold it */

/* Unit vector along the line in the image, downward or level. */
static void direction_of(const vista_thin_line *line, double *right, double *down) {
  const double along = 1.0 / hypot(1.0, line->slope), across = line->slope * along;
  *right = line->flat ? copysign(along, across) : across;
  *down = line->flat ? fabs(across) : along;
}

/* The place where a line comes closest to the path, and how much of it is in the volume. */
typedef struct approach {
  bool found;
  double t_px, distance_m, point_m[3];
  double pixels; /* in the volume */
} approach;

static approach approach_of(const vista_thin_line *line, const vista_camera *camera, const vista_flight_path *path,
                            const vista_collision_volume *volume) {
  approach a = {.distance_m = INFINITY};
  for (int32_t t = line->first_px; t <= line->last_px; ++t) {
    if (!vista_thin_is_certain(line, t)) continue;
    double point_m[3];
    vista_thin_point(line, camera, t, point_m);
    const double along_m = vista_flight_path_along(path, point_m, NULL);
    const double distance_m = vista_flight_path_distance(path, point_m);
    const double radius_m = vista_flight_path_likely_radius_m(path, along_m, volume->radius_m, volume->path_sigmas);
    if (along_m > 0.0 && along_m <= path->length_m && distance_m <= radius_m) a.pixels += hypot(1.0, line->slope);
    if (distance_m >= a.distance_m) continue;
    a.found = along_m > 0.0;
    a.t_px = t;
    a.distance_m = distance_m;
    for (int i = 0; i < 3; ++i) a.point_m[i] = point_m[i];
  }
  return a;
}

/* Pixels along the line within the radius of the point. */
static double pixels_around(const vista_thin_line *line, const vista_camera *camera, const approach *nearest,
                            double radius_m) {
  double rows = 0.0;
  for (int32_t t = line->first_px; t <= line->last_px; ++t) {
    if (!vista_thin_is_certain(line, t)) continue;
    double offset_m[3];
    vista_thin_point(line, camera, t, offset_m);
    for (int i = 0; i < 3; ++i) offset_m[i] -= nearest->point_m[i];
    rows += vista_norm(offset_m) <= radius_m;
  }
  return rows;
}

static vista_detection detection_of(const vista_thin_line *line, const vista_camera *camera, const approach *nearest,
                                    double pixels, int32_t label) {
  const double t = nearest->t_px, u_px = vista_thin_u_px(line, t), v_px = vista_thin_v_px(line, t);
  const double d = vista_thin_disparity_px(line, t), pixel_m = camera->baseline_m / d;
  double right, down;
  direction_of(line, &right, &down);
  const double along_sigma_px = ALONG_SIGMA_RAD * camera->focal_px;
  const double half_px = fmax(0.5 * pixels * hypot(1.0, line->slope), HALF_WIDTH_MIN_PX);
  const double angle_deg = atan2(down, right) * VISTA_DEGREES_PER_RADIAN;
  vista_detection result = {.label = label,
                            .u_px = u_px,
                            .v_px = v_px,
                            .disparity_px = d,
                            .sigma_u_px = hypot(ACROSS_SIGMA_PX, along_sigma_px * right),
                            .sigma_v_px = hypot(ACROSS_SIGMA_PX, along_sigma_px * down),
                            .sigma_disparity_px = vista_thin_noise_px(line, t),
                            .lasting_sigma_px = line->lasting_sigma_px,
                            .extent_m = {2.0 * fmax(half_px * fabs(right), HALF_WIDTH_MIN_PX) * pixel_m,
                                         2.0 * fmax(half_px * down, HALF_WIDTH_MIN_PX) * pixel_m},
                            .volume_pixels = (int32_t)lround(nearest->pixels),
                            .foot_seen = line->foot_seen,
                            .foot_share = line->foot_share,
                            .line = true,
                            .unrepeated = line->flat,
                            .ellipse = {.center_u_px = u_px,
                                        .center_v_px = v_px,
                                        .axis_a_px = half_px,
                                        .axis_b_px = HALF_WIDTH_MIN_PX,
                                        .angle_deg = angle_deg > 90.0 ? angle_deg - 180.0 : angle_deg}};
  vista_triangulate(camera, &result);
  return result;
}

/* Whether a detection is what matching makes of the line. */
static bool is_band(const vista_thin_line *line, const vista_detection *detection) {
  double right, down;
  direction_of(line, &right, &down);
  const double t = line->flat ? detection->u_px : detection->v_px, across = 1.0 / hypot(1.0, line->slope);
  const double off_px = across * ((line->flat ? detection->v_px : detection->u_px) - vista_thin_across_px(line, t));
  const double turn = atan2(down, right) - detection->ellipse.angle_deg / VISTA_DEGREES_PER_RADIAN;
  const double sigma_px =
      0.5 * hypot(detection->ellipse.axis_a_px * sin(turn), detection->ellipse.axis_b_px * cos(turn));
  const double step_px = detection->disparity_px - vista_thin_disparity_px(line, t);
  return t >= line->first_px && t <= line->last_px && fabs(off_px) <= BAND_OFF_PX && sigma_px <= BAND_SIGMA_PX &&
         fabs(step_px) <= fmax(VISTA_SURFACE_PX, 3.0 * vista_thin_sigma_px(line, t));
}

/* The number of those that are no bands of the line; if told to, only they are left, in their order. */
static int32_t without_bands(const vista_thin_line *line, bool remove, vista_detection *detections, int32_t count) {
  int32_t kept = 0;
  for (int32_t i = 0; i < count; ++i) {
    if (is_band(line, &detections[i])) continue;
    if (remove) detections[kept] = detections[i];
    ++kept;
  }
  return kept;
}

vista_status vista_thin_reconstruct(const vista_frame_view *frame, const vista_thin_lines *lines,
                                    const vista_collision_volume *volume, int32_t first_label,
                                    vista_detections *detections) {
  const vista_flight_path path = vista_collision_volume_path(volume);
  for (int32_t i = 0; i < lines->count; ++i) {
    const vista_thin_line *const line = &lines->items[i];
    const approach nearest = approach_of(line, frame->camera, &path, volume);
    if (!nearest.found || nearest.distance_m > REACH_RADII * volume->radius_m) continue;
    const int32_t others = without_bands(line, nearest.pixels > 0.0, detections->items, detections->count);
    if (nearest.pixels == 0.0 && others < detections->count) continue;
    detections->count = others;
    if (detections->count == detections->capacity) return VISTA_ERROR_CAPACITY;
    const double pixels = pixels_around(line, frame->camera, &nearest, volume->radius_m);
    detections->items[detections->count++] = detection_of(line, frame->camera, &nearest, pixels, first_label + i);
  }
  return VISTA_OK;
}
