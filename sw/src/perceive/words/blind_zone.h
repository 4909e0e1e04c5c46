/* Is something in the way that is too near to match?
 *
 * Nearer than f B / (num_disparities - 1) the engine has no candidate: it finds nothing, or by chance something else.
 * What came through the matched ranges is tracked, and stays a danger by prediction (tracker.h). What did not,
 * a wall ahead at power-up, a curtain of leaves after a turn, shows as texture that is not matched where the collision
 * volume enters the blind zone: a disc of radius_m at that range around the principal point.
 *
 * Sky and bare walls have no texture and say nothing: it takes a contrast above the image's own noise. By chance the engine matches up to half of what it should not: a word counts when another one agrees (agreement.h).
 */
#ifndef VISTA_BLIND_ZONE_H
#define VISTA_BLIND_ZONE_H

#include <stdbool.h>
#include <stdint.h>

#include "perceive/frame_view.h"

typedef struct vista_blind_zone {
  double textured_fraction;  /* of the pixels of the disc, within the matched part of the image */
  double unmatched_fraction; /* of these, not matched; 0 if there are none */
  uint32_t window;           /* the last 32 frames, bit 0 the newest, 1 = hardly any texture is matched */
  bool occupied;            /* it was in confirm_hits of the last confirm_window frames */
  double range_m;            /* upper bound of the range of what is in the way */
} vista_blind_zone;

/* One frame; *blind_zone starts as zeros. */
void vista_blind_zone_update(const vista_frame_view *frame, vista_blind_zone *blind_zone);

#endif
