#include "perceive/words/words.h"

#include <math.h>
#include <stddef.h>

#include "common/frame.h"
#include "common/wide_vectors.h"
#include "perceive/scales.h"

#define SUPPORT 0.92 /* a word of a coarser level is taken where this share of the 5x5 pixels around it has one */
#define CONTRADICTION_PX 2.0 /* of the coarser level: a word gives way to its word when they differ by more */
#define GAP_PX 3 /* words of a row hang together across gaps up to twice this wide */
#define CLUSTER_FAR_PX 40.0 /* a small cluster that is kept covers at least as many pixels */
#define CLUSTER_NOISE_PX 35.0 /* per grey level of the image's noise: chance matches of a noisy image are larger */
/* A cluster that covers this area at its distance is kept though it covers less than cluster_px. */
#define CLUSTER_M2 0.2
/* And has this disparity: where nothing can be matched, chance matches mostly have less. */
#define CLUSTER_FAR_DISPARITY_PX 3.0

_Static_assert(VISTA_MAX_LEVELS == 1 + VISTA_COARSER_LEVELS, "level 0 and the coarser ones");

/* The word of a pixel without a disparity within this stage: so far below zero that no valid word is within a pixel. */
#define NONE (-2 * VISTA_DISPARITY_SCALE)
#define LIKE ((int32_t)(VISTA_SURFACE_PX * VISTA_DISPARITY_SCALE))
#define REACH 2                    /* the support of a word is counted in 5x5 pixels */

int32_t vista_words_side_px(int32_t side_px, int32_t level) {
  for (int32_t k = 0; k < level; ++k) side_px = (side_px + 1) / 2;
  return side_px;
}

/* Takes working memory that suits levels up to this size. */
static void take_scratch(vista_arena *arena, int32_t width_px, int32_t height_px, vista_words_scratch *w) {
  const size_t width = (size_t)width_px, pixels = width * (size_t)height_px;
  for (size_t i = 0; i < sizeof w->spread / sizeof w->spread[0]; ++i)
    w->spread[i] = vista_arena_take(arena, width, sizeof(int16_t));
  for (size_t i = 0; i < sizeof w->flags / sizeof w->flags[0]; ++i)
    w->flags[i] = vista_arena_take(arena, width + 64, sizeof(uint8_t));
  for (size_t i = 0; i < sizeof w->bits / sizeof w->bits[0]; ++i)
    w->bits[i] = vista_arena_take(arena, width / 64 + 2, sizeof(uint64_t));
  w->parent = vista_arena_take(arena, pixels, sizeof(int32_t));
  w->first = vista_arena_take(arena, pixels, sizeof(uint16_t));
  w->last = vista_arena_take(arena, pixels, sizeof(uint16_t));
  w->first_run = vista_arena_take(arena, (size_t)height_px + 1, sizeof(int32_t));
}

vista_status vista_words_layout(vista_words *words, vista_arena *arena, int32_t width_px, int32_t height_px) {
  if (width_px < 1 || height_px < 1 || width_px > UINT16_MAX || height_px > UINT16_MAX) return VISTA_ERROR_SIZE;
  for (int32_t k = 0; k < VISTA_MAX_LEVELS; ++k) {
    words->width_px[k] = vista_words_side_px(width_px, k);
    words->height_px[k] = vista_words_side_px(height_px, k);
    words->levels[k] =
        vista_arena_take(arena, (size_t)words->width_px[k] * (size_t)words->height_px[k], sizeof(int16_t));
  }
  for (int k = 0; k < VISTA_MOST_WORKERS; ++k)
    words->coarse_row[k] = vista_arena_take(arena, (size_t)width_px + 2, sizeof(int16_t));
  take_scratch(arena, width_px, height_px, &words->scratch[0]);
  words->scratch[1] = words->scratch[0];
  if (vista_team_workers(words->team) > 1)
    take_scratch(arena, words->width_px[1], words->height_px[1], &words->scratch[1]);
  words->image = (vista_disparity_image){words->levels[0], width_px, height_px, width_px};
  return arena->base != NULL && arena->used > arena->size ? VISTA_ERROR_MEMORY : VISTA_OK;
}

vista_status vista_words_count_levels(const vista_words *words, const vista_disparity_image *disparity,
                                      const vista_disparity_image coarser[VISTA_COARSER_LEVELS], int32_t *count) {
  vista_status status = vista_frame_check_disparity(disparity, words->width_px[0], words->height_px[0]);
  int32_t levels = 1;
  for (int32_t k = 1; k < VISTA_MAX_LEVELS && status == VISTA_OK; ++k) {
    if (coarser[k - 1].data == NULL) continue;
    if (levels++ != k) return VISTA_ERROR_ARGUMENT;
    status = vista_frame_check_disparity(&coarser[k - 1], words->width_px[k], words->height_px[k]);
  }
  *count = levels;
  return status;
}

/* ---- clusters: runs of like words in a row, joined from row to row ---- */

static inline int like(int16_t a, int16_t b) { return (uint16_t)(a - b + LIKE) <= 2 * LIKE; }

/* What the level cannot hold counts as none: files may hold words that no engine writes. */
VISTA_WIDE_VECTORS static void copy_row(const int16_t *restrict in, int32_t width, int16_t largest,
                                        int16_t *restrict out) {
  for (int32_t u = 0; u < width; ++u) {
    const int16_t word = in[u];
    out[u] = word >= 0 && word <= largest ? word : NONE;
  }
}

/* a, or b where there is no word. Masks and no choice: both are loaded, so that loops over it become vectors. */
static inline int16_t word_or(int16_t a, int16_t b) {
  const int16_t none = (int16_t)(a >> 15);
  return (int16_t)((a & ~none) | (b & none));
}

/* Words spread by a pixel into the gaps beside them, from the left before from the right. */
VISTA_WIDE_VECTORS static void spread_row(const int16_t *restrict row, int32_t width, int16_t *restrict out) {
  out[0] = width > 1 ? word_or(row[0], row[1]) : row[0];
  for (int32_t u = 1; u < width - 1; ++u) out[u] = word_or(row[u], word_or(row[u - 1], row[u + 1]));
  if (width > 1) out[width - 1] = word_or(row[width - 1], row[width - 2]);
}

/* What clusters are found in: the row's words, and these spread by gap_px. */
static const int16_t *close_gaps(const int16_t *row, int32_t width, int32_t gap_px, int16_t *const spread[2]) {
  for (int32_t left = gap_px - 1; left >= 0; --left) {
    spread_row(row, width, spread[left % 2]); /* the last one writes the first of the two */
    row = spread[left % 2];
  }
  return row;
}

/* Flags each pixel of a row: whether it has a word, and whether this is like the one to its left and the one above. */
VISTA_WIDE_VECTORS static void flag_row(const int16_t *restrict row, const int16_t *restrict above, int32_t width,
                                        uint8_t *restrict valid, uint8_t *restrict linked, uint8_t *restrict up) {
  for (int32_t u = 0; u < width; ++u) {
    valid[u] = row[u] >= 0;
    up[u] = (row[u] >= 0) & like(row[u], above[u]);
  }
  linked[0] = 0;
  for (int32_t u = 1; u < width; ++u) linked[u] = (row[u] >= 0) & like(row[u], row[u - 1]);
}

/* Eight flags as the bits of a number. */
static inline uint64_t eight(const uint8_t *flags) {
  const uint64_t bytes = (uint64_t)flags[0] | (uint64_t)flags[1] << 8 | (uint64_t)flags[2] << 16 |
                         (uint64_t)flags[3] << 24 | (uint64_t)flags[4] << 32 | (uint64_t)flags[5] << 40 |
                         (uint64_t)flags[6] << 48 | (uint64_t)flags[7] << 56;
  return bytes * UINT64_C(0x0102040810204080) >> 56;
}

/* Flags, zeros up to a multiple of 64, as the bits of `count` numbers and one more, which is zero. */
static void pack(const uint8_t *flags, int32_t count, uint64_t *bits) {
  for (int32_t i = 0; i < count; ++i) {
    uint64_t packed = 0;
    for (int k = 0; k < 8; ++k) packed |= eight(flags + 64 * i + 8 * k) << (8 * k);
    bits[i] = packed;
  }
  bits[count] = 0;
}

static inline int32_t lowest(uint64_t bits) { return __builtin_ctzll(bits); }

/* Lists the runs of a row behind those of the rows before; returns how many there are. */
static int32_t list_runs(const uint64_t *valid, const uint64_t *linked, int32_t count, uint16_t *first,
                         uint16_t *last) {
  int32_t starts = 0, ends = 0;
  for (int32_t i = 0; i < count; ++i) {
    for (uint64_t bits = valid[i] & ~linked[i]; bits != 0; bits &= bits - 1)
      first[starts++] = (uint16_t)(64 * i + lowest(bits));
    for (uint64_t bits = valid[i] & ~(linked[i] >> 1 | linked[i + 1] << 63); bits != 0; bits &= bits - 1)
      last[ends++] = (uint16_t)(64 * i + lowest(bits));
  }
  return starts;
}

/* The root of a run's set; a root's parent is minus the pixels of the set. */
static int32_t root_of(int32_t *parent, int32_t run) {
  while (parent[run] >= 0) {
    const int32_t next = parent[run];
    if (parent[next] >= 0) parent[run] = parent[next];
    run = next;
  }
  return run;
}

/* The smaller number is the root, so that a parent always comes before its runs. */
static void join(int32_t *parent, int32_t a, int32_t b) {
  a = root_of(parent, a);
  b = root_of(parent, b);
  if (a == b) return;
  const int32_t low = a < b ? a : b, high = a < b ? b : a;
  parent[low] += parent[high];
  parent[high] = low;
}

/* Joins the runs from `here` on with those of the row above that they touch: once for each stretch over which both go
 * on. */
static void join_rows(vista_words_scratch *w, int32_t above, int32_t here, const uint64_t *linked_above,
                      const uint64_t *linked, const uint64_t *up, int32_t count) {
  uint64_t left = 0; /* whether the last pixel before these is like the one above it */
  for (int32_t i = 0; i < count; ++i) {
    const uint64_t before = up[i] << 1 | left;
    left = up[i] >> 63;
    for (uint64_t bits = up[i] & ~(before & linked[i] & linked_above[i]); bits != 0; bits &= bits - 1) {
      const int32_t at = 64 * i + lowest(bits);
      while (w->last[above] < at) ++above;
      while (w->last[here] < at) ++here;
      join(w->parent, above, here);
    }
  }
}

/* Pixels that a cluster has to cover to be kept, by the nearest word of its topmost run. */
typedef struct smallest {
  int32_t px, far_px;   /* anywhere; of what is far */
  double far_word;      /* the smallest word of what may be far: chance matches prefer small ones */
  double px_of_word2;   /* times the word squared: the pixels of cluster_m2 */
} smallest;

static int32_t needed_px(const smallest *needed, const int16_t *row, int32_t first, int32_t last) {
  int16_t nearest = 0;
  for (int32_t u = first; u <= last; ++u) nearest = row[u] > nearest ? row[u] : nearest;
  const double px = needed->px_of_word2 * nearest * nearest;
  if (px >= needed->px || nearest < needed->far_word) return needed->px;
  return px > needed->far_px ? (int32_t)ceil(px) : needed->far_px;
}

static void drop_small_runs(vista_words_scratch *w, int32_t width, int32_t height, const smallest *needed,
                            int16_t *words) {
  for (int32_t v = 0; v < height; ++v) {
    int16_t *const row = words + (ptrdiff_t)v * width;
    for (int32_t r = w->first_run[v]; r < w->first_run[v + 1]; ++r) {
      const int32_t root = root_of(w->parent, r), px = -w->parent[root];
      if (px >= needed->px) continue;
      if (r == root && px >= needed_px(needed, row, w->first[r], w->last[r])) {
        w->parent[root] = -needed->px; /* large enough, and the root comes before the other runs */
        continue;
      }
      for (int32_t u = w->first[r]; u <= w->last[r]; ++u) row[u] = NONE;
    }
  }
}

/* Copies a level and drops the words of small clusters. */
static void filter_clusters(const vista_disparity_image *in, const smallest *needed, int32_t gap_px, int16_t largest,
                            vista_words_scratch *w, int16_t *out) {
  const int32_t width = in->width_px, height = in->height_px, count = (width + 63) / 64;
  for (int i = 0; i < 3; ++i)
    for (int32_t u = width; u < 64 * count; ++u) w->flags[i][u] = 0; /* left by a wider level */
  uint64_t *const valid = w->bits[0], *const up = w->bits[1];
  const int16_t *above = NULL;
  int32_t runs = 0;
  for (int32_t v = 0; v < height; ++v) {
    int16_t *const row = out + (ptrdiff_t)v * width;
    copy_row(in->data + v * in->stride, width, largest, row);
    if (needed->px <= 1) continue;
    uint64_t *const linked = w->bits[2 + (v & 1)], *const linked_above = w->bits[2 + (~v & 1)];
    int16_t *const spread[2] = {w->spread[v % 2], w->spread[2]}; /* that of the row before is still needed */
    const int16_t *const closed = close_gaps(row, width, gap_px, spread);
    flag_row(closed, v > 0 ? above : closed, width, w->flags[0], w->flags[1], w->flags[2]);
    pack(w->flags[0], count, valid);
    pack(w->flags[1], count, linked);
    w->first_run[v] = runs;
    const int32_t here = list_runs(valid, linked, count, w->first + runs, w->last + runs);
    for (int32_t r = runs; r < runs + here; ++r) w->parent[r] = w->first[r] - w->last[r] - 1;
    if (v > 0) {
      pack(w->flags[2], count, up);
      join_rows(w, w->first_run[v - 1], runs, linked_above, linked, up, count);
    }
    runs += here;
    above = closed;
  }
  if (needed->px <= 1) return;
  w->first_run[height] = runs;
  drop_small_runs(w, width, height, needed, out);
}

/* ---- support ---- */

static const int16_t *row_of(const int16_t *words, int32_t width, int32_t height, int32_t v) {
  return v < height ? words + (ptrdiff_t)v * width : NULL;
}

/* Words among the 2 REACH + 1 pixels around each of a row; null: a row outside the image. */
VISTA_WIDE_VECTORS static void count_row(const int16_t *restrict row, int32_t width, uint8_t *restrict valid,
                                         uint8_t *restrict count) {
  for (int32_t u = 0; u < width; ++u) valid[u + REACH] = row != NULL && row[u] >= 0;
  for (int32_t u = 0; u < width; ++u)
    count[u] = (uint8_t)(valid[u] + valid[u + 1] + valid[u + 2] + valid[u + 3] + valid[u + 4]);
}

VISTA_WIDE_VECTORS static void drop_row(uint8_t *const counts[2 * REACH + 1], int32_t width, int32_t needed,
                                        int16_t *restrict row) {
  const uint8_t *restrict const a = counts[0], *restrict const b = counts[1], *restrict const c = counts[2],
                                *restrict const d = counts[3], *restrict const e = counts[4];
  for (int32_t u = 0; u < width; ++u) row[u] = a[u] + b[u] + c[u] + d[u] + e[u] >= needed ? row[u] : NONE;
}

/* Keeps the words that lie among at least `needed` words in the 5x5 around them. */
static void filter_support(int32_t width, int32_t height, int32_t needed, vista_words_scratch *w, int16_t *words) {
  uint8_t *const valid = w->flags[2 * REACH + 1];
  for (int32_t u = 0; u < width + 2 * REACH; ++u) valid[u] = 0;
  for (int i = 0; i < 2 * REACH + 1; ++i)
    count_row(i < REACH ? NULL : row_of(words, width, height, i - REACH), width, valid, w->flags[i]);
  for (int32_t v = 0; v < height; ++v) {
    if (v > 0)
      count_row(row_of(words, width, height, v + REACH), width, valid, w->flags[(v + 2 * REACH) % (2 * REACH + 1)]);
    drop_row(w->flags, width, needed, words + (ptrdiff_t)v * width);
  }
}

/* ---- two levels ---- */

/* The words of a row of the coarser level above `beyond`, over the pixels of the finer one and in its units. */
static void widen_row(const int16_t *restrict coarse, int32_t coarse_width, int16_t beyond, int32_t width,
                      int16_t *restrict out) {
  for (int32_t i = 0; i < coarse_width; ++i) { /* pixel i is the nearest to pixels 2 i - 1 and 2 i */
    const int16_t word = coarse[i] > beyond ? (int16_t)(2 * coarse[i]) : NONE;
    out[2 * i] = word; /* out has room for one on either side */
    out[2 * i + 1] = word;
  }
  if (2 * coarse_width - 1 < width) out[width] = out[width - 1];
}

VISTA_WIDE_VECTORS static void merge_row(const int16_t *restrict coarse, int16_t limit, int32_t width,
                                         int16_t *restrict row) {
  for (int32_t u = 0; u < width; ++u) {
    const int16_t word = row[u], other = coarse[u];
    const int16_t apart = (int16_t)(word > other ? word - other : other - word);
    const int keep = (word >= 0) & ((other < 0) | (apart <= limit));
    row[u] = keep ? word : other;
  }
}

/* Some rows of the finer level take what the coarser one has to say. row: of its width and two more. */
static void merge_rows(int32_t finer, int16_t beyond, const vista_words *w, int32_t first, int32_t end, int16_t *row) {
  const int32_t coarse = finer + 1, width = w->width_px[finer], coarse_width = w->width_px[coarse];
  const double limit = 2.0 * CONTRADICTION_PX * VISTA_DISPARITY_SCALE;
  for (int32_t v = first; v < end; ++v) {
    const int32_t nearest = (v + 1) / 2 < w->height_px[coarse] ? (v + 1) / 2 : w->height_px[coarse] - 1;
    if (v == first || v % 2 == 1)
      widen_row(w->levels[coarse] + (ptrdiff_t)nearest * coarse_width, coarse_width, beyond, width, row);
    merge_row(row + 1, (int16_t)limit, width, w->levels[finer] + (ptrdiff_t)v * width);
  }
}

/* The size below which a cluster is dropped. A square metre at word w covers (w / (16 B))^2 pixels, at any level. */
static smallest smallest_of(const vista_frame_view *frame) {
  const double px_per_m = 1.0 / (VISTA_DISPARITY_SCALE * frame->camera->baseline_m);
  const double least_px = frame->params->words.cluster_px;
  const int32_t px = (int32_t)lround(vista_image_noise_threshold(&frame->noise, least_px, CLUSTER_NOISE_PX));
  const int32_t far_px = (int32_t)lround(vista_image_noise_threshold(&frame->noise, CLUSTER_FAR_PX, CLUSTER_NOISE_PX));
  return (smallest){px, far_px < px ? far_px : px, CLUSTER_FAR_DISPARITY_PX * VISTA_DISPARITY_SCALE,
                    CLUSTER_M2 * px_per_m * px_per_m};
}

typedef struct job {
  const vista_disparity_image *in; /* by level */
  int32_t levels, num_disparities, filling_levels;
  smallest cluster;
  vista_words *words;
} job;

static void filter(const job *j, int32_t level, vista_words_scratch *scratch) {
  filter_clusters(&j->in[level], &j->cluster, GAP_PX, (int16_t)(INT16_MAX >> level), scratch, j->words->levels[level]);
}

/* Words of the next coarser level that are larger fill a level. */
static int16_t fills_beyond(const job *j, int32_t finer) {
  const int32_t largest = (j->num_disparities - 1) * VISTA_DISPARITY_SCALE; /* of level 0 */
  return (int16_t)(finer < j->filling_levels ? -1 : largest >> (finer + 1));
}

/* Part 0 is level 0, part 1 all the others, the coarsest first. */
static void filter_part(void *context, int32_t part, int32_t worker) {
  const job *const j = context;
  vista_words *const w = j->words;
  if (part == 0) {
    filter(j, 0, &w->scratch[0]);
    return;
  }
  const int32_t needed = (int32_t)ceil(SUPPORT * (2 * REACH + 1) * (2 * REACH + 1) - 1e-9);
  for (int32_t k = j->levels - 1; k > 0; --k) {
    filter(j, k, &w->scratch[1]);
    filter_support(w->width_px[k], w->height_px[k], needed, &w->scratch[1], w->levels[k]);
    if (k < j->levels - 1) merge_rows(k, fills_beyond(j, k), w, 0, w->height_px[k], w->coarse_row[worker]);
  }
}

#define MERGED_ROWS 32 /* of level 0 a part */

static void finish_part(void *context, int32_t part, int32_t worker) {
  const job *const j = context;
  vista_words *const w = j->words;
  const int32_t first = MERGED_ROWS * part, left = w->height_px[0] - first;
  const int32_t end = first + (left < MERGED_ROWS ? left : MERGED_ROWS);
  if (j->levels > 1) merge_rows(0, fills_beyond(j, 0), w, first, end, w->coarse_row[worker]);
  int16_t *const words = w->levels[0] + (ptrdiff_t)first * w->width_px[0];
  for (int32_t i = 0, count = (end - first) * w->width_px[0]; i < count; ++i)
    words[i] = words[i] < 0 ? VISTA_DISPARITY_INVALID : words[i];
}

void vista_words_combine(const vista_frame_view *frame, vista_words *words) {
  job j = {.in = frame->levels,
           .levels = 1 + frame->matched.coarser_levels,
           .num_disparities = frame->params->stereo.num_disparities,
           .filling_levels = frame->params->words.filling_levels,
           .cluster = smallest_of(frame),
           .words = words};
  vista_team_share(words->team, filter_part, &j, 2);
  vista_team_share(words->team, finish_part, &j, (words->height_px[0] + MERGED_ROWS - 1) / MERGED_ROWS);
}
