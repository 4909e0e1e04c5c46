#include "link/mavlink/sectors.h"

#include <math.h>
#include <string.h>

#include "common/numbers.h"

#define DEG VISTA_DEGREES_PER_RADIAN
#define SAME_UP 0.9986 /* cosine of 3 degrees */
#define LEVEL_MIN 0.1 /* sine between forward and vertical: an aircraft that stands on its tail has no heading */
#define THICKNESS 0.25 /* of the width: how far the middle is behind the surface that is seen (obstacle_map), */
#define THICKNESS_MAX_M 0.25 /* at most */
#define POINT_STEP_DEG \
  15.0 /* to each side of the middle of something wide another point: a sector of ArduPilot has 45 */
#define POINTS_A_SIDE 2
#define POINT_HALF_DEG 2.5 /* to each side of a point, columns that tell how far it is */
#define DEPTH_RATIO 2.0 /* of its width: how much nearer than its middle a surface may be that belongs to something */
#define EDGE_DEG 1e-6 /* what touches a sector's edge is not in it */

/* Level axes that turn with the heading, in the camera. */
typedef struct level {
  double ahead[3], right[3], up[3];
  const vista_directions *directions; /* of the camera; null: not about these axes */
  double camera_deg; /* where the camera looks, to the right of ahead */
} level;

static bool finite3(const double a[3]) { return isfinite(a[0]) && isfinite(a[1]) && isfinite(a[2]); }

/* The row of body_from_camera is that axis of the body, in the camera. */
static bool make_level(const double body_from_camera[9], const vista_directions *directions, level *axes) {
  const double *const forward = body_from_camera, *const down = body_from_camera + 6;
  for (int i = 0; i < 3; ++i) axes->up[i] = directions->up_known ? directions->up_camera[i] : -down[i];
  const double rise = vista_dot(forward, axes->up);
  for (int i = 0; i < 3; ++i) axes->ahead[i] = forward[i] - rise * axes->up[i];
  const double length = vista_norm(axes->ahead);
  if (!(length >= LEVEL_MIN)) return false;
  for (int i = 0; i < 3; ++i) axes->ahead[i] /= length;
  vista_cross(axes->ahead, axes->up, axes->right);

  static const double axis[3] = {0.0, 0.0, 1.0}; /* of the camera */
  const double along = vista_dot(axis, axes->ahead), aside = vista_dot(axis, axes->right);
  axes->camera_deg = DEG * atan2(aside, along);
  /* The camera looked for free directions with an up of its own: where none is known, that is not the aircraft's. */
  const bool same = vista_dot(axes->up, directions->up_camera) >= SAME_UP;
  axes->directions = same && along * along + aside * aside >= LEVEL_MIN * LEVEL_MIN ? directions : NULL;
  return true;
}

/* The columns that two azimuths have between them; none of them where the camera does not look: first > last. */
typedef struct columns {
  int32_t first, last;
  bool whole; /* all of the azimuths are in columns */
} columns;

static columns columns_between(const level *axes, double from_deg, double width_deg) {
  const double start_deg = remainder(from_deg + 0.5 * width_deg - axes->camera_deg, 360.0) - 0.5 * width_deg;
  const double first = floor(start_deg - VISTA_DIRECTIONS_FIRST_DEG + EDGE_DEG);
  const double last = ceil(start_deg + width_deg - VISTA_DIRECTIONS_FIRST_DEG - EDGE_DEG) - 1.0;
  return (columns){(int32_t)fmax(first, 0.0), (int32_t)fmin(last, VISTA_DIRECTIONS - 1.0),
                   first >= 0.0 && last < VISTA_DIRECTIONS};
}

/* ---- clear or unknown ---- */

/* The number of the sector with this azimuth, not yet between 0 and the count. */
static int32_t sector_at(const vista_mavlink_params *params, double azimuth_deg) {
  return (int32_t)floor((azimuth_deg - params->angle_offset_deg) / vista_mavlink_sector_deg(params) + 0.5);
}

static int32_t wrapped(int32_t number, int32_t count) { return ((number % count) + count) % count; }

/* Sectors that nothing reaches into, where every column is free. */
static void mark_clear(const vista_mavlink_params *params, const level *axes, uint16_t *distance_cm) {
  if (axes->directions == NULL) return;
  const double width_deg = vista_mavlink_sector_deg(params);
  for (int32_t sector = 0; sector < vista_mavlink_sector_count(params); ++sector) {
    const columns of = columns_between(axes, params->angle_offset_deg + (sector - 0.5) * width_deg, width_deg);
    bool is_free = of.whole && distance_cm[sector] == VISTA_MAVLINK_UNKNOWN;
    for (int32_t k = of.first; is_free && k <= of.last; ++k)
      is_free = (double)axes->directions->free_m[k] >= params->max_distance_m;
    if (is_free) distance_cm[sector] = (uint16_t)(vista_mavlink_max_cm(params) + 1);
  }
}

/* ---- obstacles ---- */

typedef struct place {
  double along_m, aside_m; /* level, of the surface that is seen */
  double low_m, high_m; /* above the camera */
  double distance_m, half_deg; /* level distance, and half the width as it is seen */
  double depth_m; /* how much nearer than that a part of it may be */
} place;

static place place_of(const vista_mavlink_params *params, const level *axes, const vista_mavlink_obstacle *obstacle) {
  const double *const p = obstacle->position_camera_m;
  const double width_m = fmax(obstacle->width_m, 0.0), height_m = fmax(obstacle->height_m, 0.0);
  place at = {.along_m = vista_dot(p, axes->ahead), .aside_m = vista_dot(p, axes->right)};
  const double level_m = hypot(at.along_m, at.aside_m), middle_m = vista_dot(p, axes->up);
  at.low_m = middle_m - 0.5 * height_m;
  at.high_m = middle_m + 0.5 * height_m;
  const double depth_m = fmin(THICKNESS * fmin(width_m, 2.0 * height_m), THICKNESS_MAX_M);
  at.distance_m = fmax(obstacle->id == VISTA_ID_TOO_NEAR ? 0.0 : level_m - depth_m, params->min_distance_m);
  at.depth_m = DEPTH_RATIO * width_m;
  at.half_deg = fmin(DEG * atan2(0.5 * width_m, fmax(level_m, params->min_distance_m)), 90.0);
  if (level_m > 0.0) {
    at.along_m *= at.distance_m / level_m;
    at.aside_m *= at.distance_m / level_m;
  }
  return at;
}

/* A wall at an angle is nearer at one end than at its middle. How far what is seen of an obstacle is between two of its
 * azimuths: the median of the columns that are blocked by something that may belong to it, and no more than its middle,
 * which also holds where nothing is seen of it. */
static double seen_m(const vista_mavlink_params *params, const level *axes, const place *at, double from_deg,
                     double to_deg) {
  if (axes->directions == NULL || !(to_deg > from_deg)) return at->distance_m;
  const columns of = columns_between(axes, from_deg, to_deg - from_deg);
  double nearer_m[VISTA_DIRECTIONS];
  int32_t count = 0;
  for (int32_t k = of.first; k <= of.last; ++k) {
    const double blocked_m = (double)axes->directions->blocked_m[k];
    if (blocked_m > 0.0 && fabs(at->distance_m - blocked_m) <= at->depth_m) nearer_m[count++] = blocked_m;
  }
  if (count == 0) return at->distance_m;
  return fmin(fmax(vista_lower_median(nearer_m, count), params->min_distance_m), at->distance_m);
}

static void mark_obstacle(const vista_mavlink_params *params, const level *axes, const place *at,
                          uint16_t *distance_cm) {
  if (at->low_m > params->half_height_m || at->high_m < -params->half_height_m) return;
  const double azimuth_deg = DEG * atan2(at->aside_m, at->along_m), width_deg = vista_mavlink_sector_deg(params);
  const double reach_deg = fmax(at->half_deg - EDGE_DEG, 0.0);
  const double from_deg = azimuth_deg - reach_deg, to_deg = azimuth_deg + reach_deg;
  const int32_t first = sector_at(params, from_deg), last = sector_at(params, to_deg);
  /* PX4 takes a distance of max_distance for none. */
  const double most_cm = fmax(vista_mavlink_max_cm(params) - 1.0, 1.0);
  for (int32_t k = first; k <= last; ++k) {
    const double left_deg = params->angle_offset_deg + (k - 0.5) * width_deg;
    const double distance_m = seen_m(params, axes, at, fmax(left_deg, from_deg), fmin(left_deg + width_deg, to_deg));
    if (!(distance_m < params->max_distance_m)) continue;
    const uint16_t cm = (uint16_t)fmax(fmin(floor(100.0 * distance_m), most_cm), 1.0);
    uint16_t *const sector = &distance_cm[wrapped(k, vista_mavlink_sector_count(params))];
    if (cm < *sector) *sector = cm;
  }
}

/* Adds points of a board at the height that is nearest to the camera's: its middle and both sides. */
static void add_points(vista_mavlink *link, const level *axes, const place *at, int32_t id) {
  const vista_mavlink_params *const params = &link->params;
  vista_mavlink_state *const state = &link->state;
  const double height_m = fmin(fmax(0.0, at->low_m), at->high_m);
  const double level_m = hypot(at->along_m, at->aside_m);
  const int32_t sides = (int32_t)fmin(floor(at->half_deg / POINT_STEP_DEG), POINTS_A_SIDE);
  const double half_m = at->distance_m * tan(fmin(at->half_deg, 80.0) / DEG);
  const double azimuth_deg = DEG * atan2(at->aside_m, at->along_m);
  for (int32_t k = -sides; k <= sides && state->point_count < VISTA_MAVLINK_POINTS; ++k) {
    const double across_m = sides > 0 ? half_m * k / sides : 0.0;
    const double turn = level_m > 0.0 ? across_m / level_m : 0.0;
    const double board_along_m = at->along_m - turn * at->aside_m, board_aside_m = at->aside_m + turn * at->along_m;
    const place there = {.distance_m = hypot(board_along_m, board_aside_m), .depth_m = at->depth_m};
    const double aside_deg = DEG * atan2(across_m, at->distance_m);
    const double there_m = seen_m(params, axes, &there, azimuth_deg + fmax(aside_deg - POINT_HALF_DEG, -at->half_deg),
                                  azimuth_deg + fmin(aside_deg + POINT_HALF_DEG, at->half_deg));
    const double nearer = there.distance_m > 0.0 ? there_m / there.distance_m : 1.0;
    const double along_m = nearer * board_along_m, aside_m = nearer * board_aside_m;
    double point_m[3], *const body_m = state->points_body_m[state->point_count];
    for (int i = 0; i < 3; ++i)
      point_m[i] = along_m * axes->ahead[i] + aside_m * axes->right[i] + height_m * axes->up[i];
    const double length_m = vista_norm(point_m);
    if (!(length_m > 0.0) || length_m >= params->max_distance_m) continue;
    const double scale = fmax(length_m, params->min_distance_m) / length_m;
    for (int i = 0; i < 3; ++i) body_m[i] = scale * vista_dot(link->body_from_camera + 3 * i, point_m);
    state->point_ids[state->point_count++] = id;
  }
}

static void add_obstacle(vista_mavlink *link, const level *axes, const vista_mavlink_obstacle *obstacle) {
  const place at = place_of(&link->params, axes, obstacle);
  if (!isfinite(at.distance_m + at.along_m + at.aside_m)) return; /* numbers near the largest there are */
  mark_obstacle(&link->params, axes, &at, link->state.distance_cm);
  add_points(link, axes, &at, obstacle->id);
}

/* The place where the collision's point comes nearest: level and vertical distance. Without a velocity it is met. */
static void miss(const level *axes, vista_mavlink_state *state) {
  const vista_mavlink_collision *const c = &state->collision;
  const double *const v = c->velocity_camera_m_s, *const p = c->position_camera_m;
  const double square = vista_dot(v, v);
  state->miss_horizontal_m = state->miss_vertical_m = 0.0;
  if (!(square > 0.0)) return;
  double nearest_m[3];
  for (int i = 0; i < 3; ++i) nearest_m[i] = p[i] - vista_dot(p, v) / square * v[i];
  state->miss_horizontal_m = hypot(vista_dot(nearest_m, axes->ahead), vista_dot(nearest_m, axes->right));
  state->miss_vertical_m = fabs(vista_dot(nearest_m, axes->up));
}

/* Columns: where the camera's x, y and z point in the body. */
void vista_mavlink_mount(const vista_mavlink_params *params, double body_from_camera[9]) {
  const double roll = params->mount_roll_deg / DEG, pitch = params->mount_pitch_deg / DEG;
  const double yaw = params->mount_yaw_deg / DEG;
  const double cr = cos(roll), sr = sin(roll), cp = cos(pitch), sp = sin(pitch), cy = cos(yaw), sy = sin(yaw);
  const double x[3] = {cy * sp * sr - sy * cr, sy * sp * sr + cy * cr, cp * sr};
  const double y[3] = {cy * sp * cr + sy * sr, sy * sp * cr - cy * sr, cp * cr};
  const double z[3] = {cy * cp, sy * cp, -sp};
  for (int i = 0; i < 3; ++i) {
    body_from_camera[3 * i] = x[i];
    body_from_camera[3 * i + 1] = y[i];
    body_from_camera[3 * i + 2] = z[i];
  }
}

bool vista_mavlink_place(vista_mavlink *link, const vista_mavlink_frame *frame) {
  const vista_mavlink_params *const params = &link->params;
  vista_mavlink_state *const state = &link->state;
  for (int k = 0; k < VISTA_MAVLINK_MOST_SECTORS; ++k) state->distance_cm[k] = VISTA_MAVLINK_UNKNOWN;
  state->point_count = 0;
  state->collision = frame->collision;
  const vista_mavlink_collision *const c = &frame->collision;
  bool all_finite = !c->valid || (finite3(c->position_camera_m) && finite3(c->velocity_camera_m_s));
  level axes;
  const double *const up = frame->directions.up_camera;
  const bool up_good = !frame->directions.up_known || (finite3(up) && fabs(vista_dot(up, up) - 1.0) < 1e-3);
  if (!up_good || !make_level(link->body_from_camera, &frame->directions, &axes)) {
    state->collision.valid = false;
    return up_good;
  }
  if (!all_finite) state->collision.valid = false;
  if (state->collision.valid) {
    miss(&axes, state);
    vista_mavlink_obstacle met = {.id = c->id};
    memcpy(met.position_camera_m, c->position_camera_m, sizeof met.position_camera_m);
    add_obstacle(link, &axes, &met);
  }
  for (int32_t k = 0; k < frame->obstacle_count; ++k) {
    const vista_mavlink_obstacle *const obstacle = &frame->obstacles[k];
    const bool good = finite3(obstacle->position_camera_m) && isfinite(obstacle->width_m + obstacle->height_m);
    all_finite = all_finite && good;
    if (good) add_obstacle(link, &axes, obstacle);
  }
  if (all_finite && frame->health == VISTA_HEALTH_HEALTHY) mark_clear(params, &axes, state->distance_cm);
  return all_finite;
}
