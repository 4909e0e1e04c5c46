/* Does a track stand still in the world, or does it move with the aircraft?
 *
 * A texture of pitch p, matched k periods off, is seen at disparity f (B + k p) / Z instead of f B / Z: at
 * c = B / (B + k p) times its range, wherever the camera C is. In the world that image is C + c (P - C): while the
 * camera travels by dC, it travels by beta dC with beta = 1 - c, along the same direction. What stands still has
 * beta = 0, what nears the aircraft by its own motion beta < 0. No single frame tells the three apart; own travel does.
 *
 * beta is fitted along the line of sight of the first hit, each hit weighted by its range noise:
 *   along . (p_i - C_0) = a + beta along . (C_i - C_0)
 * and judged by the likelihood ratio of "stands" (beta = 0, within a tolerance) against "moves with the aircraft" (beta
 * uniform over the pitches that occur). What moves across the line of sight by more than beta dC explains, moves by
 * itself: a crossing vehicle is no image of a texture. One that drives ahead of the aircraft, slower and on its line,
 * is not told from one by its motion.
 *
 * Its foot tells. Seen from h above the ground, the image of a texture hangs in the air: what is at height y is seen at
 * y + beta (h - y), at beta h or higher. Whatever has its foot lower than that is no such image. So beta is no larger
 * than the height of the foot over that of the camera; below the smallest of the pitches that occur, nothing is left
 * that the track could be the image of, and it stands, or moves by itself.
 *
 * All sums are running ones and fade with own travel: no history, any number of frames. */
#ifndef VISTA_STATIC_WORLD_H
#define VISTA_STATIC_WORLD_H

#include <stdbool.h>
#include <stdint.h>

#include "vista/obstacle.h"
#include "vista/parameters.h"

/* Running weighted sums over the hits; s: own travel, y: place along the line of sight. */
typedef struct vista_static_world {
  vista_world_verdict verdict;
  int32_t hits;
  double slope;       /* beta; 0 while undetermined */
  double slope_sigma; /* infinite while undetermined */
  double start_m[3], along[3];   /* camera position at the first hit, unit vector to the track; world */
  int64_t start_t_ns;
  double travel_m;               /* s of the last hit */
  double count, weight, s, y, ss, sy, yy;
  double foot_count, foot_share; /* hits that tell of their foot, and the sum of their shares */
  /* Across the line of sight, the track's place p and the camera's c; metres. */
  double across_weight, across_s, across_ss;
  double across_p[3], across_sp[3], across_c[3], across_sc[3];
} vista_static_world;

/* One hit, in world: where it was measured, from where, and the standard deviations of that place along and across
 * the line of sight, metres. */
typedef struct vista_world_hit {
  double position_m[3], camera_m[3];
  double along_sigma_m, across_sigma_m;
  int64_t t_ns;
  bool foot_seen;    /* over ground that is known: */
  double foot_share; /* height of the foot above it, over that of the camera */
} vista_world_hit;

void vista_static_world_start(const vista_world_hit *hit, vista_static_world *world);

/* Adds the hit and judges anew. */
void vista_static_world_add(const vista_world_hit *hit, vista_static_world *world);

/* Whether own travel since the first hit is too little to tell anything, as while hovering. */
bool vista_static_world_silent(const vista_static_world *world, int64_t t_ns);

/* Life of what is tested (tracker.h). It is confirmed, for good, at `needed` of its last hits, and at one more while
 * the test is open and not silent. It is credible once it is confirmed and held to stand or to move, or the test is
 * silent, and until it is refuted. */
void vista_static_world_decide(const vista_static_world *world, bool silent, int32_t hits, int32_t needed,
                               bool *confirmed, bool *credible);

#endif
