/* The ground that the path meets as an obstacle of the map. */
#include "perceive/terrain/terrain.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#include "common/frame.h"
#include "common/numbers.h"

#define ACROSS_SHARE 0.1 /* of the radius: how well it is known which point of the ground is met first */
#define FLATTEST 0.1 /* of the ellipse of the ground, its height over its width */
#define ON_GROUND_M 0.5 /* the middle of what lies on the ground is this near to it, */
#define ON_GROUND_SHARE 0.1 /* or this share of its distance from where the ground was found; but not by more than */
#define STANDING_SHARE 0.25 /* this share of its height: the middle of what stands is half of it above the ground */

bool vista_terrain_obstacle(const vista_frame_view *frame, const vista_terrain *terrain, vista_obstacle *obstacle) {
  const vista_camera *const camera = frame->camera;
  const vista_pose *const pose = &frame->motion.pose;
  const vista_terrain_contact *const c = &terrain->contact;
  double camera_m[3], measurement_px[3], direction[3];
  vista_frame_to_camera(pose, c->point_m, camera_m);
  if (!(camera_m[2] > VISTA_DEPTH_MIN_M)) return false;
  vista_frame_measure(camera, camera_m, measurement_px, NULL);
  (void)vista_flight_path_along(&frame->path, c->point_m, direction);
  const double radius_px = VISTA_TERRAIN_BESIDE * c->radius_m * camera->focal_px / camera_m[2];
  double normal[3];
  vista_frame_direction_to_camera(pose, terrain->plane.normal, normal);
  const double leans_deg = atan2(-normal[0], normal[1]) * VISTA_DEGREES_PER_RADIAN;
  const double angle_deg = leans_deg > 90.0 ? leans_deg - 180.0 : leans_deg <= -90.0 ? leans_deg + 180.0 : leans_deg;
  *obstacle = (vista_obstacle){
      .id = VISTA_ID_GROUND,
      .kind = VISTA_OBSTACLE_GROUND,
      .confirmed = terrain->confirmed && terrain->world.verdict != VISTA_WORLD_REFUTED,
      .coasting = terrain->coasting,
      .in_blind_zone = terrain->blind,
      .world = terrain->world.verdict,
      .age_frames = terrain->age_frames,
      .distance_m = vista_norm(camera_m),
      .extent_m = {2.0 * VISTA_TERRAIN_BESIDE * c->radius_m,
                   2.0 * VISTA_TERRAIN_BESIDE * c->radius_m * fmax(c->sine, 0.0)},
      .ellipse = {measurement_px[0], measurement_px[1], radius_px, radius_px * fmax(c->sine, FLATTEST), angle_deg},
      .disparity_px = measurement_px[2],
      .in_collision_volume = terrain->credible && terrain->steady};
  memcpy(obstacle->position_m, c->point_m, sizeof obstacle->position_m);
  const double along2 = vista_square(terrain->sigma_m), across2 = vista_square(ACROSS_SHARE * c->radius_m);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const double share = direction[i] * direction[j];
      obstacle->covariance_m2[3 * i + j] = along2 * share + across2 * ((i == j) - share);
    }
  return true;
}

bool vista_terrain_bears(const vista_terrain *terrain, const vista_obstacle *obstacle, const double point_m[3]) {
  double off_m[3];
  for (int i = 0; i < 3; ++i) off_m[i] = point_m[i] - terrain->contact.point_m[i];
  const double share_m = fmin(ON_GROUND_SHARE * vista_norm(off_m), STANDING_SHARE * obstacle->extent_m[1]);
  return fabs(vista_dot(terrain->plane.normal, off_m)) <= fmax(ON_GROUND_M, share_m);
}
