#include "perceive/region/region_boundary.h"

#include <math.h>
#include <stdint.h>

#include "common/depth.h"
#include "common/plane_fit.h"
#include "common/wide_vectors.h"
#include "common/word_blocks.h"

#define TOP_HEIGHT_M 0.8 /* words higher above the ground weigh more; at most in proportion to min_height_m */
#define ODDS_STANDING 2.2 /* log-odds added by words that all stand min_height_m above the ground */
#define ODDS_TOP 1.4 /* by words that all stand TOP_HEIGHT_M above the ground */
/* Log-odds added by a boundary none of whose words lie on one surface; in proportion below min_inlier_fraction. */
#define ODDS_BOUNDARY (-4.0)
#define ODDS_SUPPORT 0.4 /* by a boundary whose pixels all have a word */
#define ODDS_SIZE 0.4 /* by each tenfold of a metre in size */
#define ODDS_UNSEEDED (-0.4) /* to a region that grew from no disparity of its own */
#define ODDS_LEAN (-1.0) /* by a surface that lies flat, 15 degrees and more beyond VISTA_HORIZONTAL_DEG */
#define LEAN_SPAN_DEG 15.0 /* from a lean that begins to count to one that counts in full */

/* A word stands h above the ground's plane when (1 - g / w) B / |n| >= h (plane_fit.h), so when w (1 - h |n| / B) >= g
 * with g the plane's word at the pixel: one multiplication, and nothing is divided. */
typedef struct heights {
  float offset_words, slope_u_words, slope_v_words; /* of the ground's plane, from pixel (0, 0) */
  float low, top;                                   /* 1 - h |n| / B for min_height_m and top_height_m */
} heights;

typedef struct word_counts {
  int32_t pixels, valid, standing, top;
} word_counts;

static heights heights_above(const vista_surfaces *surfaces, const vista_camera *camera, double low_m, double top_m) {
  const vista_plane *const ground = &surfaces->ground;
  const double per_m = vista_plane_share_per_m(ground, camera);
  return (heights){.offset_words = (float)(vista_plane_disparity_px(ground, camera, 0.0, 0.0) * VISTA_DISPARITY_SCALE),
                   .slope_u_words = (float)(ground->slope_u * VISTA_DISPARITY_SCALE),
                   .slope_v_words = (float)(ground->slope_v * VISTA_DISPARITY_SCALE),
                   .low = (float)(1.0 - low_m * per_m),
                   .top = (float)(1.0 - top_m * per_m)};
}

/* Counts lane by lane, three bytes in each: they are put together when a byte may be full, and at the end. */
typedef struct lane_counts {
  uint32_t lanes[VISTA_WORD_BLOCK];
  int32_t blocks;
} lane_counts;

static inline void add_lanes(lane_counts *counts, word_counts *sum) {
  for (int32_t i = 0; i < VISTA_WORD_BLOCK; ++i) {
    sum->valid += (int32_t)(counts->lanes[i] & UINT8_MAX);
    sum->standing += (int32_t)(counts->lanes[i] >> 8 & UINT8_MAX);
    sum->top += (int32_t)(counts->lanes[i] >> 16);
  }
  *counts = (lane_counts){0};
}

/* Counts the first `length` pixels of a block by the height of their words. */
static inline void count_block(const heights *h, const int16_t *restrict words, const int16_t *restrict us,
                               const int16_t *restrict vs, int32_t length, uint32_t *restrict lanes) {
  const float offset_words = h->offset_words, slope_u = h->slope_u_words, slope_v = h->slope_v_words;
  const float low = h->low, top = h->top;
  VISTA_BLOCK_LOOP
  for (int32_t i = 0; i < VISTA_WORD_BLOCK; ++i) {
    const float word = (float)words[i], at = offset_words + slope_u * (float)us[i] + slope_v * (float)vs[i];
    const uint32_t is_valid = (words[i] > 0) & (i < length);
    const uint32_t stands = word * low >= at, is_top = word * top >= at;
    lanes[i] += -is_valid & (1 | stands << 8 | is_top << 16);
  }
}

/* Stretch by stretch of neighbouring cells, whose words lie one after the other. */
VISTA_WIDE_VECTORS static word_counts count_words(const vista_region_view *w, const heights *h) {
  const int32_t *const first_pixel = w->foveation->first_pixel, *const members = w->members;
  word_counts sum = {0};
  lane_counts counts = {0};
  for (int32_t m = 0, next; m < w->member_count; m = next) {
    for (next = m + 1; next < w->member_count && members[next] == members[next - 1] + 1;) ++next;
    const int32_t first = first_pixel[members[m]], end = first_pixel[members[next - 1] + 1];
    sum.pixels += end - first;
    for (int32_t p = first; p < end; p += VISTA_WORD_BLOCK) {
      count_block(h, w->cells->words + p, w->foveation->pixel_u + p, w->foveation->pixel_v + p, end - p, counts.lanes);
      if (++counts.blocks == UINT8_MAX) add_lanes(&counts, &sum);
    }
  }
  add_lanes(&counts, &sum);
  return sum;
}

static double share(double part, double whole) { return whole > 0.0 ? part / whole : 0.0; }

void vista_region_weigh(const vista_region_view *w, bool seeded, vista_region *region) {
  const vista_camera *const camera = w->frame->camera;
  const vista_region_params *const p = w->params;
  const double low_m = (double)vista_limit_m(camera, (float)region->disparity_px, (float)p->min_height_m);
  const double top_m = low_m * TOP_HEIGHT_M / p->min_height_m;
  const heights h = heights_above(w->surfaces, camera, low_m, top_m);
  const word_counts words = count_words(w, &h);
  vista_region_evidence *const e = &region->evidence;
  region->valid_fraction = share(words.valid, words.pixels);
  if (w->surfaces->ground_found) {
    region->standing_fraction = share(words.standing, words.valid);
    region->top_fraction = share(words.top, words.valid);
  } else {
    region->standing_fraction = region->top_fraction = 1.0; /* there is nothing to lie on */
  }
  const double size_m = sqrt((double)words.pixels) * camera->baseline_m / fmax(region->disparity_px, 1.0);
  e->height = ODDS_STANDING * region->standing_fraction + ODDS_TOP * region->top_fraction;
  const double consistent = share(region->boundary_inliers, region->boundary_valid);
  const bool enough = consistent >= p->min_inlier_fraction; /* which may be zero */
  e->boundary = enough ? 0.0 : ODDS_BOUNDARY * (1.0 - consistent / p->min_inlier_fraction);
  e->support = ODDS_SUPPORT * share(region->boundary_valid, region->boundary_pixels);
  e->size = ODDS_SIZE * log10(fmax(size_m, 0.05));
  e->origin = seeded ? 0.0 : ODDS_UNSEEDED;
  const double lean_deg = isnan(region->inclination_deg) ? 0.0 : region->inclination_deg;
  e->lean = ODDS_LEAN * fmin(fmax((lean_deg - VISTA_HORIZONTAL_DEG) / LEAN_SPAN_DEG, 0.0), 1.0);
  e->sum = p->odds_prior + e->height + e->boundary + e->support + e->size + e->lean + e->origin;
}
