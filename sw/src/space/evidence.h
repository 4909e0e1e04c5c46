/* The evidence that one frame keeps for the map of space: what each of its lines of sight met.
 *
 * A picture of a few hundred columns stands for the frame. A pixel of it has the disparity that was matched there, and
 * if none was, that of the nearest word below it in its column, which bounds what has no texture: the sky ends at what
 * is farthest, a plain wall at the ground before its foot. What reaches from well below the horizon to above it and begins
 * or ends with an edge is no sky; and if the word that bounds it is too far to be the ground at its foot, it may hang
 * anywhere. Without an edge it is ground that fades, as in haze, and the sky.
 *
 * What is as thin as a wire is lost where words are filtered, and where every other pixel is left out. So the nearest of
 * the engine's own words in a pixel of the picture counts where it is nearer than what else is there, if those around
 * agree: two of eight, and where it is near, half of them, since a thing there is matched as wide as a block. Most words by
 * chance stand alone or in small groups. Those that are left bound nothing, and only what several frames match at one place
 * is believed (space_map.h). */
#ifndef VISTA_EVIDENCE_H
#define VISTA_EVIDENCE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "common/arena.h"
#include "perceive/cells/surface.h"
#include "perceive/frame_view.h"
#include "vista/types.h"

#define VISTA_SIGHT_LOW 0.035 /* 2 degrees below the horizon: what ends higher has its foot far away, if it has one */
#define VISTA_SIGHT_SPREAD_PX 4 /* so far words reach beyond the edge of what they are of */
#define VISTA_SIGHT_TOLERANCE_PX 0.75 /* A word is at a place if it differs by less than this, */
#define VISTA_SIGHT_TOLERANCE_SHARE 0.03 /* or by less than this share of the place's disparity. */

typedef enum vista_sight_kind {
  VISTA_SIGHT_WORD = 0, /* matched, and not on a surface to fly along */
  VISTA_SIGHT_LEVEL,    /* matched, on a surface to fly along */
  VISTA_SIGHT_BOUNDED,  /* not matched at full size; a word lies below it, or the next coarser level has one there */
  VISTA_SIGHT_HANGING, /* the same, if that word is far and yet well below the horizon, and the surface reaches above it */
  VISTA_SIGHT_OVERHANG, /* the same, where older frames saw the ground that a wall would hide (overhangs.h) */
  VISTA_SIGHT_UNBOUNDED, /* not matched, nor anything below it */
  VISTA_SIGHT_OUTSIDE /* of the part of the image that the engine matches */
} vista_sight_kind;

typedef struct vista_evidence {
  vista_pose pose; /* of the camera in the world */
  int64_t t_ns;
  int32_t width, height, step_px; /* of the picture; its pixel (x, y) is that of the image at step_px times (x, y) */
  int16_t *word; /* height * width: 1/16 px; 0: unbounded */
  uint8_t *kind; /* height * width: vista_sight_kind */
  int16_t *nearest; /* scratch, width of the image and one more */
  int16_t *thin; /* scratch, three rows of the picture with a rim to both sides */
  int16_t *low; /* scratch, width: -1 where the word that bounds this column is far and well below the horizon, */
  int16_t *edged; /* and where an edge was crossed since that word */
} vista_evidence;

/* What a line of sight says of a range of distances. */
typedef enum vista_sight_says {
  VISTA_SIGHT_SAYS_NOTHING = 0, /* or that it ends nearer */
  VISTA_SIGHT_ENDS, /* at something that is matched there */
  VISTA_SIGHT_AT_GROUND, /* on a surface to fly along */
  VISTA_SIGHT_AT_FOOT, /* at what has no texture, which stands there */
  VISTA_SIGHT_GOES_ON /* beyond */
} vista_sight_says;

/* Pixels of the image from one of the picture to the next. */
int32_t vista_evidence_step_px(const vista_camera *camera);

void vista_evidence_layout(vista_evidence *evidence, vista_arena *arena, const vista_camera *camera);

/* What the frame shows. */
void vista_evidence_take(const vista_frame_view *frame, const vista_surfaces *surfaces, vista_evidence *evidence);

/* Whether there is an edge of brightness at a pixel of the image, below the horizon, at which something may begin that hangs
 * before the ground. Without an image there may be one everywhere. */
bool vista_evidence_begins(const vista_frame_view *frame, int32_t u_px, int32_t v_px);

/* What the line of sight through pixel i of the picture says of the distances with disparities from `farthest` to
 * `nearest`, in 1/16 px. */
static inline vista_sight_says vista_evidence_says(const vista_evidence *evidence, ptrdiff_t i, int32_t farthest,
                                                   int32_t nearest) {
  const int32_t word = evidence->word[i];
  const uint8_t kind = evidence->kind[i];
  if (kind >= VISTA_SIGHT_HANGING || word > nearest) return VISTA_SIGHT_SAYS_NOTHING;
  if (word < farthest) return VISTA_SIGHT_GOES_ON;
  static const vista_sight_says at[VISTA_SIGHT_HANGING] = {[VISTA_SIGHT_WORD] = VISTA_SIGHT_ENDS,
                                                           [VISTA_SIGHT_LEVEL] = VISTA_SIGHT_AT_GROUND,
                                                           [VISTA_SIGHT_BOUNDED] = VISTA_SIGHT_AT_FOOT};
  return at[kind];
}

#endif
