/* A small world for the target of the pipeline: ground, a wall, boxes, a wire and a pole, all of it made of one number,
 * so that frames of it agree with each other and with the poses, and what follows things from frame to frame is
 * reached. What draws it is not checked for its arithmetic, which costs more than it tells. */
#ifndef VISTA_FUZZ_SCENE_H
#define VISTA_FUZZ_SCENE_H

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#include "input.h"
#include "vista/types.h"

#define BOXES 3
#define WIRES 2

typedef struct fuzz_box {
  double x_m, y_m, z_m, half_width_m, half_height_m, rate_m[2]; /* the front; what it moves by, x and z, in a frame */
} fuzz_box;

typedef struct fuzz_wire {
  bool upright;
  double at_m, z_m, half_m; /* its height, or its place to the side; half its width */
  double slope;
} fuzz_wire;

typedef struct fuzz_world {
  uint32_t seed;
  double ground_m, ground_slope; /* below the first camera, and how it rises ahead; 0: there is none */
  double wall_m; /* 0: there is sky */
  int32_t boxes, wires;
  fuzz_box box[BOXES];
  fuzz_wire wire[WIRES];
  double grain_m[2 + BOXES]; /* of the texture of each surface: ground, wall, boxes */
  int32_t noise, contrast, plain; /* grey levels; bit k: surface k has no texture */
  double forth_m[3], turn_rad[3], turned_rad[3]; /* of the camera in a frame, and at first: yaw, pitch, roll */
  double right_rad[2]; /* by which the right camera has turned: pitch, roll */
} fuzz_world;

static inline double fuzz_share(uint32_t *state) { return (fuzz_random(state) >> 8) / 16777216.0; }

static inline bool fuzz_one_of(uint32_t *state, int32_t count) {
  return (fuzz_random(state) >> 8) % (uint32_t)count == 0;
}

static inline fuzz_world fuzz_world_of(uint32_t seed) {
  uint32_t s = seed * 2654435761u | 1;
  for (int k = 0; k < 4; ++k) (void)fuzz_random(&s);
  fuzz_world w = {.seed = seed};
  if (!fuzz_one_of(&s, 5)) w.ground_m = 0.7 + 12.0 * fuzz_share(&s) * fuzz_share(&s);
  if (fuzz_one_of(&s, 4)) w.ground_slope = 0.5 * fuzz_share(&s);
  if (!fuzz_one_of(&s, 3)) w.wall_m = 5.0 + 90.0 * fuzz_share(&s);
  w.boxes = (int32_t)((BOXES + 1) * fuzz_share(&s));
  for (int32_t k = 0; k < w.boxes; ++k) {
    fuzz_box *const b = &w.box[k];
    b->z_m = 1.5 + 40.0 * fuzz_share(&s) * fuzz_share(&s);
    b->x_m = (k == 0 ? 1.0 : 8.0) * (2.0 * fuzz_share(&s) - 1.0);
    b->half_width_m = 0.2 + 3.0 * fuzz_share(&s) * fuzz_share(&s);
    b->half_height_m = 0.2 + 3.0 * fuzz_share(&s) * fuzz_share(&s);
    const bool stands = w.ground_m > 0.0 && !fuzz_one_of(&s, 3);
    b->y_m = stands ? w.ground_m - w.ground_slope * b->z_m - b->half_height_m : 4.0 * fuzz_share(&s) - 2.0;
    if (fuzz_one_of(&s, 3)) b->rate_m[0] = 2.0 * fuzz_share(&s) - 1.0;
    if (fuzz_one_of(&s, 4)) b->rate_m[1] = 2.0 * fuzz_share(&s) - 1.5;
  }
  if (fuzz_one_of(&s, 2)) w.wires = 1 + fuzz_one_of(&s, 2);
  for (int32_t k = 0; k < w.wires; ++k) {
    fuzz_wire *const l = &w.wire[k];
    l->upright = fuzz_one_of(&s, 2);
    l->z_m = 2.0 + 20.0 * fuzz_share(&s);
    l->at_m = 4.0 * fuzz_share(&s) - 2.0;
    l->half_m = l->z_m * (0.003 + 0.012 * fuzz_share(&s));
    l->slope = 1.2 * fuzz_share(&s) - 0.6;
  }
  for (int k = 0; k < 2 + BOXES; ++k) {
    const double from_m = k == 0 ? 6.0 : k == 1 ? w.wall_m : w.box[k - 2].z_m;
    w.grain_m[k] = (0.015 + 0.07 * fuzz_share(&s)) * fmax(from_m, 1.0);
  }
  w.noise = fuzz_one_of(&s, 4) ? (int32_t)(40.0 * fuzz_share(&s)) : (int32_t)(4.0 * fuzz_share(&s));
  w.contrast = fuzz_one_of(&s, 6) ? 6 : 30 + (int32_t)(90.0 * fuzz_share(&s));
  w.plain = fuzz_one_of(&s, 3) ? (int32_t)(64.0 * fuzz_share(&s)) : 0;
  if (!fuzz_one_of(&s, 6)) w.forth_m[2] = 2.0 * fuzz_share(&s) * fuzz_share(&s);
  if (fuzz_one_of(&s, 3)) w.forth_m[0] = fuzz_share(&s) - 0.5;
  if (fuzz_one_of(&s, 3)) w.forth_m[1] = 0.6 * fuzz_share(&s) - 0.2; /* down */
  const bool turned = fuzz_one_of(&s, 3);
  for (int k = 0; k < 2 && turned; ++k) w.right_rad[k] = 0.1 * (fuzz_share(&s) - 0.5) * fuzz_share(&s);
  for (int k = 0; k < 3; ++k) {
    if (fuzz_one_of(&s, 4)) w.turn_rad[k] = 0.1 * fuzz_share(&s) - 0.05;
    if (fuzz_one_of(&s, 3)) w.turned_rad[k] = 0.5 * fuzz_share(&s) - 0.25;
  }
  return w;
}

/* Where the camera is in frame number `number`. */
static inline vista_pose fuzz_world_pose(const fuzz_world *w, int32_t number) {
  const double yaw = w->turned_rad[0] + number * w->turn_rad[0], pitch = w->turned_rad[1] + number * w->turn_rad[1];
  const double roll = w->turned_rad[2] + number * w->turn_rad[2];
  const double cy = cos(yaw), sy = sin(yaw), cp = cos(pitch), sp = sin(pitch), cr = cos(roll), sr = sin(roll);
  return (vista_pose){.rotation = {cy * cr + sy * sp * sr, -cy * sr + sy * sp * cr, sy * cp, cp * sr, cp * cr, -sp,
                                   -sy * cr + cy * sp * sr, sy * sr + cy * sp * cr, cy * cp},
                      .translation_m = {number * w->forth_m[0], number * w->forth_m[1], number * w->forth_m[2]}};
}

static inline uint32_t fuzz_mix(uint32_t a, uint32_t b, uint32_t c) {
  uint32_t h = a * 0x9E3779B1u ^ b * 0x85EBCA77u ^ c * 0xC2B2AE3Du;
  h ^= h >> 15;
  h *= 0x2C1B3C6Du;
  return h ^ h >> 13;
}

static inline int32_t fuzz_whole(double value) { return (int32_t)fmax(-1e9, fmin(1e9, floor(value))); }

/* The grey level of a point of a surface, by its two coordinates there. */
static inline int32_t fuzz_grey(const fuzz_world *w, int32_t surface, double a_m, double b_m) {
  const int32_t level = 60 + (int32_t)(fuzz_mix(w->seed, (uint32_t)surface, 77) % 120);
  if (w->plain >> surface & 1) return level;
  const uint32_t s = w->seed + (uint32_t)surface;
  const double grain_m = w->grain_m[surface];
  const uint32_t fine = fuzz_mix((uint32_t)fuzz_whole(a_m / grain_m), (uint32_t)fuzz_whole(b_m / grain_m), s);
  const uint32_t coarse =
      fuzz_mix((uint32_t)fuzz_whole(a_m / (6.0 * grain_m)), (uint32_t)fuzz_whole(b_m / (6.0 * grain_m)), s + 9);
  return level + (int32_t)((fine % 64 + coarse % 64) * (uint32_t)w->contrast / 128) - w->contrast / 2;
}

/* Looks along one ray; returns how many times its direction the first surface is away, 0: there is none. */
static inline double fuzz_look(const fuzz_world *w, int32_t number, const double from_m[3], const double along[3],
                               int32_t *grey) {
  double nearest = 1e6;
  *grey = 0;
  if (w->ground_m > 0.0) { /* y = ground - slope z */
    const double rate = along[1] + w->ground_slope * along[2];
    const double t = (w->ground_m - w->ground_slope * from_m[2] - from_m[1]) / rate;
    if (rate > 1e-9 && t > 0.0 && t < nearest) {
      nearest = t;
      *grey = fuzz_grey(w, 0, from_m[0] + t * along[0], from_m[2] + t * along[2]);
    }
  }
  if (!(along[2] > 1e-3)) return nearest < 1e6 ? nearest : 0.0;
  const double wall = w->wall_m > 0.0 ? (w->wall_m - from_m[2]) / along[2] : 0.0;
  if (wall > 0.0 && wall < nearest) {
    nearest = wall;
    *grey = fuzz_grey(w, 1, from_m[0] + wall * along[0], from_m[1] + wall * along[1]);
  }
  for (int32_t k = 0; k < w->boxes; ++k) {
    const fuzz_box *const b = &w->box[k];
    const double t = (b->z_m + number * b->rate_m[1] - from_m[2]) / along[2];
    const double x = from_m[0] + t * along[0] - b->x_m - number * b->rate_m[0], y = from_m[1] + t * along[1] - b->y_m;
    if (t > 0.0 && t < nearest && fabs(x) < b->half_width_m && fabs(y) < b->half_height_m) {
      nearest = t;
      *grey = fuzz_grey(w, 2 + k, x, y);
    }
  }
  for (int32_t k = 0; k < w->wires; ++k) {
    const fuzz_wire *const l = &w->wire[k];
    const double t = (l->z_m - from_m[2]) / along[2], x = from_m[0] + t * along[0], y = from_m[1] + t * along[1];
    const double off = l->upright ? x - l->at_m - l->slope * y : y - l->at_m - l->slope * x;
    if (t > 0.0 && t < nearest && fabs(off) < l->half_m) {
      nearest = t;
      *grey = 10;
    }
  }
  return nearest < 1e6 ? nearest : 0.0;
}

/* Draws the image of a camera so far to the right of the left one, and its words unless they are null. */
static inline void fuzz_world_draw(const fuzz_world *w, int32_t number, const vista_pose *pose,
                                   const vista_camera *camera, double aside_m, uint8_t *image, int16_t *words) {
  const double *const r = pose->rotation;
  uint32_t state = fuzz_mix(w->seed, (uint32_t)number, aside_m > 0.0) | 1;
  double from_m[3], along[3];
  for (int i = 0; i < 3; ++i) from_m[i] = pose->translation_m[i] + r[3 * i] * aside_m;
  for (int32_t v = 0; v < camera->height_px; ++v)
    for (int32_t u = 0; u < camera->width_px; ++u) {
      double x = (u - camera->center_u_px) / camera->focal_px, y = (v - camera->center_v_px) / camera->focal_px;
      if (aside_m > 0.0) x -= w->right_rad[1] * y, y += w->right_rad[0] + w->right_rad[1] * x;
      for (int i = 0; i < 3; ++i) along[i] = r[3 * i] * x + r[3 * i + 1] * y + r[3 * i + 2];
      int32_t grey;
      const double z_m = fuzz_look(w, number, from_m, along, &grey);
      if (z_m == 0.0) grey = 210;
      if (w->noise > 0) grey += (int32_t)(fuzz_random(&state) >> 8) % (2 * w->noise + 1) - w->noise;
      const int32_t at = v * camera->width_px + u;
      image[at] = (uint8_t)(grey < 0 ? 0 : grey > 255 ? 255 : grey);
      if (words == NULL) continue;
      const double disparity_px = z_m > 0.0 ? camera->focal_px * camera->baseline_m / z_m : 0.0;
      words[at] = (int16_t)(disparity_px > 0.0 && disparity_px < 127.0 ? lrint(disparity_px * VISTA_DISPARITY_SCALE)
                                                                       : VISTA_DISPARITY_INVALID);
    }
}

#endif
