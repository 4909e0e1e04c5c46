/* Makes one disparity image at full size of the words of up to four pyramid levels (extension of the paper).
 *
 * Pixel i of level k lies at pixel 2^k i of level 0, and a word d of it means d 2^k there. Each level goes through two
 * filters of its own, then the levels are put together from the coarsest on:
 *
 * - Cluster: words that hang together (4 neighbours, a pixel apart at most) and cover fewer than cluster_px pixels are
 *   dropped, on every level. Chance matches are small; the pattern of the cost hardly ever repeats over a whole
 *   surface.
 *   What is far is small in pixels, too: a cluster that covers cluster_m2 at its distance stays from cluster_far_px on.
 *   Words first spread by gap_px into the gaps of their row: what is left of a thin thing, a post or the trunk of a
 *   tree, are small pieces that agree with each other.
 * - Support: a word of level 1 or coarser is kept where at least `support` of the 5x5 pixels around it have a word.
 *   That takes the rim of a cluster away, where the block, which is 2^k times as large as at level 0, sees a thing
 *   beyond its outline.
 * - Contradiction: a word that the next coarser level contradicts by more than contradiction_px pixels of that level
 *   gives way to it: what is nearer than a level can match is matched to something else there.
 * - Filling: where a level has no word, the next coarser level's is taken: of the first filling_levels of them
 *   everything, of the others what is too near for level 0. Level 1 fills weakly textured surfaces, but it costs thin
 *   things their outlines; what level 2 adds to surfaces is wrong in two cases of five (KITTI 2012).
 *
 * The filters and their values were chosen on the even pairs of KITTI 2012 (doc/results/real-images.md). */
#ifndef VISTA_WORDS_H
#define VISTA_WORDS_H

#include <stdint.h>

#include "common/arena.h"
#include "common/team.h"
#include "perceive/frame_view.h"
#include "vista/status.h"
#include "vista/types.h"

#define VISTA_MAX_LEVELS 4 /* 1 + VISTA_COARSER_LEVELS */

/* What finding the clusters of a level takes; of one level after the other. */
typedef struct vista_words_scratch {
  int16_t *spread[3]; /* of the width of the level each */
  uint8_t *flags[6];
  uint64_t *bits[4];
  int32_t *parent; /* a run of words */
  uint16_t *first, *last;
  int32_t *first_run; /* a row and one more */
} vista_words_scratch;

typedef struct vista_words {
  vista_disparity_image image; /* of all levels together, what the other stages work on */
  int32_t width_px[VISTA_MAX_LEVELS], height_px[VISTA_MAX_LEVELS]; /* of each level */
  int16_t *levels[VISTA_MAX_LEVELS]; /* height * width */
  vista_words_scratch scratch[2]; /* of level 0, and of the coarser ones; the same memory for a thread alone */
  int16_t *coarse_row[VISTA_MOST_WORKERS]; /* scratch: width_px[0] words and two more */
  vista_team *team; /* null: the calling thread alone; set before the layout */
} vista_words;

/* Side of a level, of this side at level 0: halved and rounded up `level` times. */
int32_t vista_words_side_px(int32_t side_px, int32_t level);

/* words: zeroed, but for the team. */
vista_status vista_words_layout(vista_words *words, vista_arena *arena, int32_t width_px, int32_t height_px);

/* How many levels a frame has: the first without data ends them. VISTA_ERROR_ARGUMENT: level 0 is missing, or one
 * before another; VISTA_ERROR_SIZE: a level is not of its size. */
vista_status vista_words_count_levels(const vista_words *words, const vista_disparity_image *disparity,
                                      const vista_disparity_image coarser[VISTA_COARSER_LEVELS], int32_t *count);

/* Puts the levels of a frame together in words->image. */
void vista_words_combine(const vista_frame_view *frame, vista_words *words);

#endif
