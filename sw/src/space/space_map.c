#include "space/space_map.h"

#include <math.h>
#include <stdbool.h>
#include <stddef.h>

#include "common/frame.h"
#include "common/numbers.h"

#define SPACING_S 0.08
#define SAMPLES 20       /* lines of sight across a disc, at most */
#define DEPTH_MIN_M 1.0  /* nearer along the optical axis, a place is not in view */
#define IN_VIEW_MIN 12   /* lines of sight that a frame needs to tell of a place, */
#define IN_VIEW_SHARE 0.25 /* and of all that lead to it this share */
#define TOLERANCE_PX 0.75 /* A word is at the place if it differs by less than this, */
#define TOLERANCE_SHARE 0.03 /* or by less than this share of the place's disparity. */
#define VOTE_MIN 3.0     /* A frame votes if so many lines of sight end at the place, */
#define VOTE_SHARE 0.02  /* and this share of all. */
#define FOOT_SHARE 0.15  /* It shows a foot if this share are bounded there by the ground, */
#define FOOT_BEYOND 0.1  /* and fewer than this go on beyond. */

vista_status vista_space_map_layout(vista_space_map *map, vista_arena *arena, const vista_camera *camera) {
  map->camera = *camera;
  for (int32_t k = 0; k < VISTA_SPACE_FRAMES; ++k) vista_evidence_layout(&map->frames[k], arena, camera);
  return arena->base != NULL && arena->used > arena->size ? VISTA_ERROR_MEMORY : VISTA_OK;
}

void vista_space_map_reset(vista_space_map *map) { map->count = map->newest = 0; }

const vista_evidence *vista_space_map_frame(const vista_space_map *map, int32_t age) {
  return &map->frames[(map->newest + VISTA_SPACE_FRAMES - age) % VISTA_SPACE_FRAMES];
}

static bool follows_closely(const vista_space_map *map) {
  if (map->count < 2) return false;
  return vista_seconds_between(vista_space_map_frame(map, 1)->t_ns, vista_space_map_frame(map, 0)->t_ns) < SPACING_S;
}

void vista_space_map_add(vista_space_map *map, const vista_frame_view *frame, const vista_surfaces *surfaces) {
  if (map->count == 0) {
    map->count = 1;
  } else if (!follows_closely(map)) {
    map->newest = (map->newest + 1) % VISTA_SPACE_FRAMES;
    map->count += map->count < VISTA_SPACE_FRAMES;
  }
  vista_evidence_take(frame, surfaces, &map->frames[map->newest]);
}

/* How the lines of sight of one frame end that lead to a disc. */
typedef struct looks {
  int32_t asked, all, at, beyond, feet;
  double u, v, disparity, disparity2; /* sums over those that end at the place, pixels of the picture and px */
  double foot_u, foot_v, foot_disparity, foot_disparity2;
} looks;

static looks look_through(const vista_evidence *e, const vista_camera *camera, const double point_m[3],
                          double radius_m) {
  looks l = {0};
  double c[3];
  vista_frame_to_camera(&e->pose, point_m, c);
  if (!(c[2] >= DEPTH_MIN_M)) return l;
  const double scale = camera->focal_px / c[2], wanted_px = scale * camera->baseline_m;
  const double u = (camera->center_u_px + scale * c[0]) / e->step_px;
  const double v = (camera->center_v_px + scale * c[1]) / e->step_px;
  const double reach = scale * radius_m / e->step_px, step = fmax(1.0, 2.0 * reach / SAMPLES);
  const double tolerance_px = fmax(TOLERANCE_PX, TOLERANCE_SHARE * wanted_px);
  const double nearest = (wanted_px - tolerance_px) * VISTA_DISPARITY_SCALE;
  const double farthest = (wanted_px + tolerance_px) * VISTA_DISPARITY_SCALE;
  const double top = v - reach + 0.5 * step, left = u - reach + 0.5 * step;
  if (!(u + reach >= 0.0 && u - reach < e->width && v + reach >= 0.0 && v - reach < e->height)) return l;
  for (double y = top; y < v + reach; y += step) {
    for (double x = left; x < u + reach; x += step) {
      if ((y - v) * (y - v) + (x - u) * (x - u) > reach * reach) continue;
      ++l.asked;
      if (!(y > -0.5 && y < e->height - 0.5 && x > -0.5 && x < e->width - 0.5)) continue;
      const int32_t row = (int32_t)(y + 0.5), column = (int32_t)(x + 0.5);
      const ptrdiff_t i = (ptrdiff_t)row * e->width + column;
      const double word = e->word[i], px = word / VISTA_DISPARITY_SCALE;
      if (e->kind[i] == VISTA_SIGHT_OUTSIDE) continue;
      ++l.all;
      if (e->kind[i] == VISTA_SIGHT_UNBOUNDED) continue;
      if (word < nearest && e->kind[i] != VISTA_SIGHT_HANGING) ++l.beyond;
      if (word < nearest || word > farthest) continue;
      if (e->kind[i] == VISTA_SIGHT_WORD) {
        ++l.at;
        l.u += column, l.v += row, l.disparity += px, l.disparity2 += px * px;
      } else if (e->kind[i] == VISTA_SIGHT_BOUNDED) {
        ++l.feet;
        l.foot_u += column, l.foot_v += row, l.foot_disparity += px, l.foot_disparity2 += px * px;
      }
    }
  }
  return l;
}

static void place_at(vista_place_evidence *found, const vista_evidence *e, double count, const double sums[4],
                     int32_t age) {
  found->u_px = sums[0] / count * e->step_px;
  found->v_px = sums[1] / count * e->step_px;
  found->disparity_px = sums[2] / count;
  found->spread_px = sqrt(fmax(sums[3] / count - vista_square(found->disparity_px), 0.0));
  found->age = age;
}

vista_place_evidence vista_space_map_look(const vista_space_map *map, const double point_m[3], double radius_m) {
  vista_place_evidence found = {0};
  bool voted = false;
  for (int32_t age = 0; age < map->count; ++age) {
    const vista_evidence *const e = vista_space_map_frame(map, age);
    const looks l = look_through(e, &map->camera, point_m, radius_m);
    if (l.all < IN_VIEW_MIN || l.all < IN_VIEW_SHARE * l.asked) continue;
    const double beyond = (double)l.beyond / l.all;
    const bool votes = l.at >= fmax(VOTE_MIN, VOTE_SHARE * l.all);
    const bool foot = l.feet >= FOOT_SHARE * l.all && beyond < FOOT_BEYOND;
    ++found.frames;
    found.votes += votes;
    found.feet += foot;
    found.beyond += beyond;
    if (votes && !voted) place_at(&found, e, l.at, (double[]){l.u, l.v, l.disparity, l.disparity2}, age);
    if (foot && found.disparity_px == 0.0)
      place_at(&found, e, l.feet, (double[]){l.foot_u, l.foot_v, l.foot_disparity, l.foot_disparity2}, age);
    voted |= votes;
  }
  if (found.frames > 0) found.beyond /= found.frames;
  return found;
}
