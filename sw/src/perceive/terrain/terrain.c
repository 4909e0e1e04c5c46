#include "perceive/terrain/terrain.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#include "common/bits.h"
#include "common/frame.h"
#include "common/numbers.h"
#include "follow/motion.h"
#include "follow/tracker.h"

#define SAME_M 2.0       /* contacts of one surface differ by less, or by SAME_SHARE of the range */
#define SAME_SHARE 0.2
#define ANCHOR_SHARE 0.3 /* of the range: farther off, the first line of sight says little of the surface */
#define PASSED_M 0.5
#define STEADY_S 0.6     /* over which the contact is asked to stay where it is: */
#define STEADY_SHARE 0.05 /* up to this share of the way there, */
#define STEADY_M 0.5     /* or this */
#define GRAZING_DEG 10.0 /* at less, a slight turn of the path moves it far */
#define MATCHING_PX 0.1 /* error of the disparity of a surface: most of it is shared by its words */

vista_status vista_terrain_layout(vista_terrain *terrain, vista_arena *arena, const vista_foveation *foveation) {
  terrain->candidates = vista_arena_take(arena, (size_t)foveation->max_nodes, sizeof(int32_t));
  terrain->along_m = vista_arena_take(arena, (size_t)foveation->max_nodes, sizeof(float));
  return arena->base != NULL && arena->used > arena->size ? VISTA_ERROR_MEMORY : VISTA_OK;
}

void vista_terrain_reset(vista_terrain *terrain) {
  *terrain = (vista_terrain){.candidates = terrain->candidates, .along_m = terrain->along_m};
}

/* One frame on its way through the functions below. */
typedef struct frame {
  const vista_parameters *params;
  const vista_camera *camera;
  const vista_matched_area *matched;
  const vista_pose *pose;
  int64_t t_ns;
  vista_terrain_view view;
  vista_terrain_volume in_world, in_camera;
  double sine_min;
} frame;

static vista_flight_path path_in_camera(const vista_flight_path *path, const vista_pose *pose) {
  vista_flight_path own = {.curvature_1_m = path->curvature_1_m, .length_m = path->length_m};
  vista_frame_to_camera(pose, path->start_m, own.start_m);
  vista_frame_direction_to_camera(pose, path->direction, own.direction);
  vista_frame_direction_to_camera(pose, path->normal, own.normal);
  return own;
}

static vista_terrain_plane plane_to_world(const vista_pose *pose, const vista_terrain_plane *plane) {
  vista_terrain_plane world = {.offset_m = plane->offset_m};
  for (int i = 0; i < 3; ++i) world.normal[i] = vista_dot(pose->rotation + 3 * i, plane->normal);
  world.offset_m += vista_dot(world.normal, pose->translation_m);
  return world;
}

static vista_terrain_plane plane_to_camera(const vista_pose *pose, const vista_terrain_plane *plane) {
  vista_terrain_plane own = {.offset_m = plane->offset_m - vista_dot(plane->normal, pose->translation_m)};
  vista_frame_direction_to_camera(pose, plane->normal, own.normal);
  return own;
}

/* Along the line of sight to a point of the surface: what MATCHING_PX makes of its range. */
static double range_sigma_m(const frame *f, const double point_m[3]) {
  double camera_m[3];
  vista_frame_to_camera(f->pose, point_m, camera_m);
  return vista_norm(camera_m) * fmax(camera_m[2], 0.0) / (f->camera->focal_px * f->camera->baseline_m) * MATCHING_PX;
}

/* The surface moves along its normal by the error of the range times the sine of the line of sight on it, and the
 * contact by as much over that of the path; the attitude's error turns the surface, and the aircraft may leave the
 * path. */
static double contact_sigma_m(const frame *f, const vista_terrain_plane *plane, const vista_terrain_contact *contact) {
  double sight_m[3];
  for (int i = 0; i < 3; ++i) sight_m[i] = contact->point_m[i] - f->pose->translation_m[i];
  const double range_m = vista_norm(sight_m), sine = vista_dot(plane->normal, sight_m) / range_m;
  const double turned_m = contact->along_m * f->params->tracker.attitude_sigma_deg * VISTA_RADIANS_PER_DEGREE;
  const double off_m = hypot(turned_m, vista_flight_path_sigma_m(&f->in_world.path, contact->along_m, plane->normal));
  return hypot(range_sigma_m(f, contact->point_m) * sine, off_m) / fmax(contact->sine, f->sine_min);
}

static vista_world_hit world_hit(const frame *f, const double point_m[3]) {
  vista_world_hit hit = {.along_sigma_m = range_sigma_m(f, point_m), .t_ns = f->t_ns};
  hit.across_sigma_m = fmax(hit.along_sigma_m, 0.1);
  memcpy(hit.position_m, point_m, sizeof hit.position_m);
  memcpy(hit.camera_m, f->pose->translation_m, sizeof hit.camera_m);
  return hit;
}

/* Finds where the first line of sight meets the surface now. False: too far from the contact for that. */
static bool at_anchor(const vista_terrain *t, const vista_terrain_plane *plane, const vista_terrain_contact *contact,
                      double point_m[3]) {
  const vista_static_world *const w = &t->world;
  const double sine = vista_dot(plane->normal, w->along);
  const double y_m = (plane->offset_m - vista_dot(plane->normal, w->start_m)) / sine;
  double off_m[3];
  for (int i = 0; i < 3; ++i) {
    point_m[i] = w->start_m[i] + y_m * w->along[i];
    off_m[i] = point_m[i] - contact->point_m[i];
  }
  return sine > 0.0 && vista_norm(off_m) <= fmax(SAME_M, ANCHOR_SHARE * contact->along_m);
}

static void judge(const frame *f, vista_terrain *t) {
  const vista_tracker_params *const p = &f->params->tracker;
  const bool silent = t->world.hits > 1 && vista_static_world_silent(&t->world, f->t_ns);
  vista_static_world_decide(&t->world, silent, vista_window_count(t->window, p->confirm_window), p->confirm_hits,
                            &t->confirmed, &t->credible);
}

static double steady_m(const vista_terrain_contact *contact) { return fmax(STEADY_SHARE * contact->along_m, STEADY_M); }

/* Whether the place stays where it is, as the path of each frame meets the surface. */
static void watch(const frame *f, vista_terrain *t) {
  if (!t->ahead) return;
  const vista_terrain_contact *const c = &t->contact;
  if (t->places == 0) {
    memcpy(t->place_m, c->point_m, sizeof t->place_m);
    t->first_t_ns = t->place_t_ns = f->t_ns;
  }
  const double dt_s = vista_seconds_between(t->place_t_ns, f->t_ns);
  t->places += t->places < INT32_MAX;
  const double weight = fmax(1.0 - exp(-dt_s / STEADY_S), 1.0 / t->places);
  double at_m[3], direction[3], off_m[3];
  vista_flight_path_point(&f->in_world.path, c->along_m, at_m, direction);
  for (int i = 0; i < 3; ++i) {
    off_m[i] = c->point_m[i] - t->place_m[i];
    t->place_m[i] += weight * off_m[i];
  }
  t->wander_m2 += weight * (vista_square(vista_dot(off_m, direction)) - t->wander_m2);
  t->place_t_ns = f->t_ns;
  /* An angle that crosses the limit says nothing new of what is warned of already. */
  const bool warned = t->credible && t->steady;
  const bool grazing = !warned && c->sine < sin(GRAZING_DEG * VISTA_RADIANS_PER_DEGREE);
  t->steady = t->wander_m2 <= vista_square(steady_m(c)) &&
              !(grazing && vista_seconds_between(t->first_t_ns, f->t_ns) < STEADY_S);
}

static void start(const frame *f, const vista_terrain_plane *plane, const vista_terrain_contact *contact,
                  vista_terrain *t) {
  const vista_world_hit hit = world_hit(f, contact->point_m);
  vista_terrain_reset(t);
  t->known = true;
  t->age_frames = 1;
  t->plane = *plane;
  vista_static_world_start(&hit, &t->world);
}

/* The surface is seen at `contact`, which replaces what was known of it. */
static void take(const frame *f, const vista_terrain_plane *plane, const vista_terrain_contact *contact,
                 vista_terrain *t) {
  double point_m[3];
  const bool anchored = at_anchor(t, plane, contact, point_m);
  const vista_world_hit hit = world_hit(f, anchored ? point_m : contact->point_m);
  const vista_world_verdict verdict = t->world.verdict;
  if (anchored)
    vista_static_world_add(&hit, &t->world);
  else
    vista_static_world_start(&hit, &t->world);
  if (!anchored) t->world.verdict = verdict; /* until the new line of sight tells */
  t->plane = *plane;
}

static void hit(const frame *f, vista_terrain *t) {
  t->window = t->window << 1 | 1u;
  t->seen_t_ns = f->t_ns;
  t->misses = 0;
  t->coasting = t->blind = false;
}

/* Whether the engine can give a disparity to a point of the camera's frame. */
static bool can_be_matched(const frame *f, const double point_m[3]) {
  if (!(point_m[2] > 0.0)) return false;
  double seen_px[3];
  vista_frame_measure(f->camera, point_m, seen_px, NULL);
  return seen_px[2] <= f->matched->disparity_max_px &&
         vista_matched_holds(f->matched, f->camera, seen_px[0], seen_px[1], seen_px[2]);
}

/* No such surface was found in this frame. It may still be seen, or be where nothing can be seen. */
static void miss(const frame *f, vista_terrain *t) {
  const vista_terrain_plane plane = plane_to_camera(f->pose, &t->plane);
  vista_terrain_contact contact;
  t->coasting = true;
  t->blind = false;
  if (t->ahead && vista_terrain_meet(&f->in_camera, &plane, f->sine_min, &contact)) {
    const vista_terrain_sight sight = vista_terrain_look(&f->view, &f->in_camera, &plane, &contact);
    if (vista_terrain_seen(&sight)) {
      hit(f, t);
      return;
    }
    t->blind = !can_be_matched(f, contact.point_m);
    const double unseen_s = vista_seconds_between(t->seen_t_ns, f->t_ns);
    if (t->credible && (t->blind || vista_terrain_dark(&sight)) &&
        unseen_s <= (t->blind ? VISTA_BLIND_ZONE_S : VISTA_HOLD_S))
      return;
  }
  t->window <<= 1;
  t->misses += 1;
  if (t->misses > f->params->tracker.miss_max || t->window == 0) vista_terrain_reset(t);
}

static bool in_view(const frame *f, const vista_terrain_contact *contact) {
  double point_m[3];
  vista_frame_to_camera(f->pose, contact->point_m, point_m);
  return can_be_matched(f, point_m);
}

/* A contact out of view is extrapolated from what is seen elsewhere: what is found has to be where a credible one was.
 */
static bool same_surface(const frame *f, const vista_terrain *t, const vista_terrain_contact *contact) {
  vista_terrain_contact before;
  if (!vista_terrain_meet(&f->in_world, &t->plane, 0.0, &before)) return false;
  const bool seen = !t->credible || (in_view(f, &before) && in_view(f, contact));
  const double apart_m = fabs(before.along_m - contact->along_m);
  return apart_m <= (seen ? fmax(SAME_M, SAME_SHARE * contact->along_m) : steady_m(contact));
}

static void update(const frame *f, vista_terrain *t) {
  vista_terrain_plane plane;
  vista_terrain_contact contact;
  bool found = vista_terrain_find(&f->view, &f->in_camera, &plane, &contact);
  t->age_frames += 1;
  t->ahead = t->known && vista_terrain_meet(&f->in_world, &t->plane, f->sine_min, &t->contact);
  if (found) {
    plane = plane_to_world(f->pose, &plane);
    found = vista_terrain_meet(&f->in_world, &plane, 0.0, &contact); /* but for rounding, at the path's very end */
  }
  if (found) {
    const bool same = t->known && same_surface(f, t, &contact);
    found = same || !t->credible; /* one frame that shows another surface does not end a warning */
    if (same)
      take(f, &plane, &contact, t);
    else if (found)
      start(f, &plane, &contact, t);
  }
  if (found) {
    hit(f, t);
    t->ahead = true;
    t->contact = contact;
  } else if (t->known) {
    miss(f, t);
  }
  if (!t->known) return;
  t->ahead = t->ahead && t->contact.along_m > PASSED_M;
  watch(f, t);
  t->sigma_m = t->ahead ? contact_sigma_m(f, &t->plane, &t->contact) : 0.0;
  judge(f, t);
}

void vista_terrain_update(const vista_frame_view *view, const vista_cells *cells, vista_terrain *terrain) {
  const vista_parameters *const params = view->params;
  const vista_motion *const motion = &view->motion;
  const vista_flight_path *const path = &view->path;
  const bool moves = motion->speed_m_s > 0.0 && motion->speed_m_s >= VISTA_SPEED_MIN_M_S;
  if (motion->restarted || !moves) vista_terrain_reset(terrain);
  if (!moves) return;
  const frame f = {.params = params,
                   .camera = view->camera,
                   .matched = &view->matched,
                   .pose = &motion->pose,
                   .t_ns = view->t_ns,
                   .view = {view->foveation, &params->terrain, view->camera, view->up_camera, cells,
                            terrain->candidates, terrain->along_m},
                   .in_world = {*path, params->obstacle_map.collision_radius_m, params->terrain.clearance_share},
                   .in_camera = {path_in_camera(path, &motion->pose), params->obstacle_map.collision_radius_m,
                                 params->terrain.clearance_share},
                   .sine_min = sin(params->terrain.angle_min_deg * VISTA_RADIANS_PER_DEGREE)};
  update(&f, terrain);
}
