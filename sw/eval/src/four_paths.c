#include "four_paths.h"

#include <stdbool.h>
#include <string.h>

enum {
  D_MAX = VISTA_PATHS_MAX_DISPARITIES,
  MOST_SIDE_PX = 8192,
  CAP = 31,           /* of the Sobel response */
  PLANES = 3,         /* bytes of a census of 5x5 px */
  SAD_SHIFT = 2,      /* so that a cost of 3x3 px fits in a byte */
  TEXTURE_RADIUS = 5, /* px */
  GUARD = 16,         /* bytes between the costs of neighbouring pixels */
  FROM_ABOVE = 3,     /* paths that come from the row above */
  KEY_BITS = 6,
  KEY_MASK = (1 << KEY_BITS) - 1,
  LARGEST_SUM = UINT16_MAX >> KEY_BITS
};

#if defined(__x86_64__) && defined(__GLIBC__)
#define FOR_EACH_PROCESSOR __attribute__((target_clones("avx2", "default")))
#else
#define FOR_EACH_PROCESSOR
#endif
#define INLINE static inline __attribute__((always_inline))

/* Where the parts of the scratch begin. Rows of right pixels run backwards, so that the candidates d = 0, 1, .. of a
 * left pixel are neighbours: right pixel x lies at width - 1 - x. */
typedef struct parts {
  uint8_t *turned;       /* the right image, its rows backwards */
  uint8_t *response[2];  /* the engine's prefilter of both images, about CAP; the right one for SAD only */
  uint8_t *census[2];    /* [PLANES][width] of a row */
  uint8_t *column;       /* [width][D]: SAD of columns of 3 px */
  uint8_t *cost;         /* [width][D] */
  uint8_t *path;         /* [FROM_ABOVE][width + 2][D + GUARD]: of the row above, less the smallest of its pixel */
  uint16_t *texture;     /* [width]: sums of columns */
  uint16_t *right_least; /* [width]: smallest key of each right pixel */
  uint16_t *least, *below, *above; /* [width]: smallest key of a left pixel, and the sums beside it */
  uint8_t *good;                   /* [width] */
} parts;

static int32_t radius(const vista_paths_params *p) { return p->cost == VISTA_PATHS_CENSUS ? 2 : 1; }

const char *vista_paths_refused(const vista_paths_params *p, int32_t width, int32_t height) {
  if (p->num_disparities != 32 && p->num_disparities != D_MAX) return "num_disparities must be 32 or 64";
  if (p->cost != VISTA_PATHS_CENSUS && p->cost != VISTA_PATHS_SAD) return "cost must be census or SAD";
  const int32_t most = UINT8_MAX - (p->cost == VISTA_PATHS_CENSUS ? 24 : (9 * 2 * CAP) >> SAD_SHIFT);
  if (p->near < 0 || p->far < p->near || p->far > most - p->near)
    return "penalties must be 0 <= near <= far, and with the largest cost at most 255";
  if (p->texture_threshold < 0) return "texture_threshold must not be negative";
  if (p->uniqueness_ratio < 0 || p->uniqueness_ratio > 100) return "uniqueness_ratio must be from 0 to 100";
  if (p->lr_max_diff < -1 || p->lr_max_diff > 255) return "lr_max_diff must be from -1 to 255";
  if (width < 1 || width > MOST_SIDE_PX || height < 1 || height > MOST_SIDE_PX)
    return "images must be from 1 to 8192 px a side";
  return NULL;
}

/* Hands out the next part of the scratch, and counts; without scratch it counts alone. */
static void *take(uint8_t *scratch, size_t *used, size_t bytes) {
  void *part = scratch ? scratch + *used : NULL;
  *used += (bytes + 63) / 64 * 64;
  return part;
}

static size_t lay_out(const vista_paths_params *p, size_t width, size_t height, uint8_t *scratch, parts *of) {
  const size_t D = (size_t)p->num_disparities, row = width * sizeof(uint16_t);
  size_t used = 0;
  of->turned = take(scratch, &used, width * height);
  for (int side = 0; side < 2; ++side) {
    of->response[side] = take(scratch, &used, width * height);
    of->census[side] = take(scratch, &used, PLANES * width);
  }
  of->column = take(scratch, &used, width * D);
  of->cost = take(scratch, &used, width * D);
  of->path = take(scratch, &used, FROM_ABOVE * (width + 2) * (D + GUARD));
  of->texture = take(scratch, &used, row);
  of->right_least = take(scratch, &used, row);
  of->least = take(scratch, &used, row);
  of->below = take(scratch, &used, row);
  of->above = take(scratch, &used, row);
  of->good = take(scratch, &used, width);
  return used;
}

size_t vista_paths_scratch_bytes(const vista_paths_params *params, int32_t width, int32_t height) {
  parts of;
  return vista_paths_refused(params, width, height) ? 0 : lay_out(params, (size_t)width, (size_t)height, NULL, &of);
}

/* ---- costs ---- */

/* Bit k of a pixel's window, rows from the top: that pixel is darker than the middle. sign: -1 in an image whose rows
 * run backwards. */
INLINE void census_row(const uint8_t *image, int32_t width, int32_t y, uint8_t *restrict planes, int sign) {
  const uint8_t *const middle = image + (ptrdiff_t)y * width;
  for (int32_t plane = 0; plane < PLANES; ++plane, planes += width) {
    const uint8_t *other[8];
    for (int k = 0; k < 8; ++k) {
      const int32_t bit = 8 * plane + k, place = bit < 12 ? bit : bit + 1; /* not the middle itself */
      other[k] = middle + (ptrdiff_t)(place / 5 - 2) * width + sign * (place % 5 - 2);
    }
    for (int32_t x = 2; x < width - 2; ++x) {
      uint8_t bits = 0;
      for (int k = 0; k < 8; ++k) bits = (uint8_t)(bits | (other[k][x] < middle[x] ? 1 << k : 0));
      planes[x] = bits;
    }
  }
}

/* How many bits are set in each half of a byte. */
INLINE uint8_t ones_of_halves(uint8_t v) {
  v = (uint8_t)(v - ((v >> 1) & 0x55));
  return (uint8_t)((v & 0x33) + ((v >> 2) & 0x33));
}

INLINE void census_costs(const parts *of, int32_t width, int32_t first, int32_t end, int D) {
  for (int32_t x = first; x < end; ++x) {
    const uint8_t *left = of->census[0] + x, *right = of->census[1] + (width - 1 - x);
    const uint8_t a = left[0], b = left[width], c = left[2 * (ptrdiff_t)width];
    uint8_t *restrict cost = of->cost + (ptrdiff_t)x * D;
    for (int d = 0; d < D; ++d) { /* a half has at most 12 of the bits of three bytes */
      const uint8_t halves = (uint8_t)(ones_of_halves(a ^ right[d]) + ones_of_halves(b ^ right[width + d]) +
                                       ones_of_halves(c ^ right[2 * (ptrdiff_t)width + d]));
      cost[d] = (uint8_t)((halves & 0x0F) + (halves >> 4));
    }
  }
}

/* The engine's prefilter, of a whole image. */
INLINE void respond(const uint8_t *image, int32_t width, int32_t height, uint8_t *restrict out, int sign) {
  memset(out, CAP, (size_t)width * (size_t)height);
  for (int32_t y = 0; y < height - height % 2; ++y, out += width) {
    const uint8_t *row = image + (ptrdiff_t)y * width;
    const uint8_t *up = y > 0 ? row - width : row + width, *down = y < height - 1 ? row + width : row - width;
    for (int32_t x = 1; x < width - 1; ++x) {
      const int g = sign * (up[x + 1] - up[x - 1] + 2 * (row[x + 1] - row[x - 1]) + down[x + 1] - down[x - 1]);
      out[x] = (uint8_t)((g < -CAP ? -CAP : g > CAP ? CAP : g) + CAP);
    }
  }
}

INLINE uint8_t apart(uint8_t a, uint8_t b) { return (uint8_t)((a > b ? a : b) - (a > b ? b : a)); }

INLINE void sad_costs(const parts *of, int32_t width, int32_t y, int32_t first, int32_t end, int D) {
  const ptrdiff_t row = width, at = (y - 1) * row;
  for (int32_t x = first - 1; x <= end; ++x) {
    const uint8_t *left = of->response[0] + at + x, *right = of->response[1] + at + (width - 1 - x);
    const uint8_t a = left[0], b = left[row], c = left[2 * row];
    uint8_t *restrict column = of->column + (ptrdiff_t)x * D;
    for (int d = 0; d < D; ++d)
      column[d] = (uint8_t)(apart(a, right[d]) + apart(b, right[row + d]) + apart(c, right[2 * row + d]));
  }
  for (int32_t x = first; x < end; ++x) {
    const uint8_t *column = of->column + (ptrdiff_t)x * D;
    uint8_t *restrict cost = of->cost + (ptrdiff_t)x * D;
    for (int d = 0; d < D; ++d) cost[d] = (uint8_t)((column[d - D] + column[d] + column[d + D]) >> SAD_SHIFT);
  }
}

/* ---- paths ---- */

/* One path comes to a pixel: its costs here, and in `after` the same less their smallest. before: of the pixel before;
 * both have a guard at both ends and may be the same. */
INLINE void step(const uint8_t *cost, const uint8_t *before, uint8_t *here, uint8_t *after, uint8_t near, uint8_t far,
                 int D) {
  uint8_t least = UINT8_MAX;
  for (int d = 0; d < D; ++d) {
    const uint8_t beside = before[d - 1] < before[d + 1] ? before[d - 1] : before[d + 1];
    const uint8_t moved = (uint8_t)(beside + near), kept = before[d] < far ? before[d] : far;
    here[d] = (uint8_t)(cost[d] + (moved < kept ? moved : kept));
    least = here[d] < least ? here[d] : least;
  }
  for (int d = 0; d < D; ++d) after[d] = (uint8_t)(here[d] - least);
}

/* Step 5, half of 6, and what 7 needs. */
INLINE void pick(const parts *of, int32_t width, int32_t x, const uint16_t *keys, uint16_t least, int32_t ratio,
                 int D) {
  uint16_t *right = of->right_least + (width - 1 - x);
  for (int d = 0; d < D; ++d) right[d] = keys[d] < right[d] ? keys[d] : right[d];
  const int32_t best = KEY_MASK - (least & KEY_MASK), smallest = least >> KEY_BITS;
  const int32_t bound = smallest + smallest * ratio / 100;
  const uint16_t limit = (uint16_t)((bound > LARGEST_SUM ? LARGEST_SUM : bound) << KEY_BITS | KEY_MASK);
  uint16_t close = 0;
  for (int d = 0; d < D; ++d) close = (uint16_t)(close + (keys[d] <= limit));
  const uint16_t below = keys[best > 0 ? best - 1 : 1], above = keys[best < D - 1 ? best + 1 : D - 2];
  const int allowed = 1 + (best > 0 && below <= limit) + (best < D - 1 && above <= limit);
  of->good[x] = ratio == 0 || close == allowed;
  of->least[x] = least;
  of->below[x] = below >> KEY_BITS;
  of->above[x] = above >> KEY_BITS;
}

/* The four paths of a row, and step 3: a key is a sum of costs with 63 - d below it, so the smallest key has the
 * smallest sum and, of equals, the larger d. */
INLINE void follow(const parts *of, const vista_paths_params *p, int32_t width, int32_t first, int32_t end, int D) {
  const ptrdiff_t stride = D + GUARD, row = (width + 2) * stride;
  uint8_t *const up_left = of->path + stride, *const up = up_left + row, *const up_right = up + row;
  const uint8_t near = (uint8_t)p->near, far = (uint8_t)p->far;
  uint8_t left[D_MAX + 2], corner[D_MAX + 2];
  memset(left, far, sizeof left);
  memset(left + 1, 0, (size_t)D);
  memcpy(corner, left, sizeof corner); /* nothing comes from beside the matched pixels */
  for (int32_t x = first; x < end; ++x) {
    const uint8_t *cost = of->cost + (ptrdiff_t)x * D;
    uint8_t here[4][D_MAX], kept[D_MAX], *const at = up_left + x * stride;
    uint16_t keys[D_MAX], least = UINT16_MAX;
    step(cost, left + 1, here[0], left + 1, near, far, D);
    memcpy(kept, at, (size_t)D);
    step(cost, corner + 1, here[1], at, near, far, D);
    memcpy(corner + 1, kept, (size_t)D);
    step(cost, up + x * stride, here[2], up + x * stride, near, far, D);
    step(cost, up_right + (x + 1) * stride, here[3], up_right + x * stride, near, far, D);
    for (int d = 0; d < D; ++d) {
      const int sum = here[0][d] + here[1][d] + here[2][d] + here[3][d];
      keys[d] = (uint16_t)(sum << KEY_BITS | (KEY_MASK - d));
      least = keys[d] < least ? keys[d] : least;
    }
    pick(of, width, x, keys, least, p->uniqueness_ratio, D);
  }
}

/* ---- what is kept of a row ---- */

INLINE void add_texture(const parts *of, int32_t width, int32_t row, int sign) {
  const uint8_t *response = of->response[0] + (ptrdiff_t)row * width;
  for (int32_t x = 0; x < width; ++x) of->texture[x] = (uint16_t)(of->texture[x] + sign * apart(response[x], CAP));
}

/* Step 4, over what lies within the image of a block of 11 px. Rows come one after the other. */
INLINE void ask_texture(const parts *of, int32_t threshold, int32_t width, int32_t height, int32_t y, int32_t first,
                        int32_t end) {
  if (y + TEXTURE_RADIUS < height) add_texture(of, width, y + TEXTURE_RADIUS, 1);
  if (y > TEXTURE_RADIUS) add_texture(of, width, y - TEXTURE_RADIUS - 1, -1);
  int32_t sum = 0;
  for (int32_t x = first - TEXTURE_RADIUS; x < first + TEXTURE_RADIUS && x < width; ++x) sum += of->texture[x];
  for (int32_t x = first; x < end; ++x) {
    if (x + TEXTURE_RADIUS < width) sum += of->texture[x + TEXTURE_RADIUS];
    of->good[x] &= sum >= threshold;
    sum -= of->texture[x - TEXTURE_RADIUS];
  }
}

/* Steps 6 and 7. The fraction of 8 bits is exact in floats: what is divided is below 2^19. */
INLINE void finish(const parts *of, int32_t most, int32_t width, int32_t first, int32_t end, int16_t *words) {
  for (int32_t x = first; x < end; ++x) {
    const int32_t best = KEY_MASK - (of->least[x] & KEY_MASK);
    const int32_t more = best - (KEY_MASK - (of->right_least[width - 1 - x + best] & KEY_MASK));
    of->good[x] &= most < 0 || (more < 0 ? -more : more) <= most;
  }
  for (int32_t x = first; x < end; ++x) {
    const int32_t best = KEY_MASK - (of->least[x] & KEY_MASK), smallest = of->least[x] >> KEY_BITS;
    const int32_t below = of->below[x], above = of->above[x], slope = below - above;
    const int32_t q = below + above - 2 * smallest + (slope < 0 ? -slope : slope);
    const int32_t part = (int32_t)((float)(256 * slope) / (float)(q > 0 ? q : 1));
    words[x] = (int16_t)(of->good[x] ? (256 * best + part + 15) >> 4 : VISTA_PATHS_INVALID);
  }
}

INLINE void match(const vista_paths_params *p, const uint8_t *left, int32_t width, int32_t height, int16_t *words,
                  const parts *of, int D) {
  const int32_t r = radius(p), first = D - 1 + r, end = width - r;
  for (int32_t y = 0; y < r + TEXTURE_RADIUS && y < height; ++y) add_texture(of, width, y, 1);
  for (int32_t y = r; y < height - r; ++y) {
    if (p->cost == VISTA_PATHS_CENSUS) {
      census_row(left, width, y, of->census[0], 1);
      census_row(of->turned, width, y, of->census[1], -1);
      census_costs(of, width, first, end, D);
    } else {
      sad_costs(of, width, y, first, end, D);
    }
    memset(of->right_least, 0xFF, (size_t)width * sizeof *of->right_least);
    follow(of, p, width, first, end, D);
    ask_texture(of, p->texture_threshold, width, height, y, first, end);
    finish(of, p->lr_max_diff, width, first, end, words + (ptrdiff_t)y * width);
  }
}

FOR_EACH_PROCESSOR
static void match_rows(const vista_paths_params *p, const uint8_t *left, int32_t width, int32_t height, int16_t *words,
                       const parts *of) {
  respond(left, width, height, of->response[0], 1);
  if (p->cost == VISTA_PATHS_SAD) respond(of->turned, width, height, of->response[1], -1);
  if (p->num_disparities == 32)
    match(p, left, width, height, words, of, 32);
  else
    match(p, left, width, height, words, of, D_MAX);
}

const char *vista_paths_match(const vista_paths_params *p, const uint8_t *left, const uint8_t *right, int32_t width,
                              int32_t height, int16_t *words, uint8_t *scratch) {
  const char *refused = vista_paths_refused(p, width, height);
  if (refused) return refused;
  parts of;
  lay_out(p, (size_t)width, (size_t)height, scratch, &of);
  const size_t D = (size_t)p->num_disparities, pixels = FROM_ABOVE * ((size_t)width + 2);
  for (ptrdiff_t i = 0; i < (ptrdiff_t)width * height; ++i) words[i] = VISTA_PATHS_INVALID;
  if (width < p->num_disparities + 2 * radius(p)) return NULL;
  for (ptrdiff_t y = 0; y < height; ++y)
    for (ptrdiff_t x = 0; x < width; ++x) of.turned[y * width + x] = right[(y + 1) * width - 1 - x];
  memset(of.texture, 0, (size_t)width * sizeof *of.texture);
  memset(of.path, p->far, pixels * (D + GUARD)); /* the guards keep it */
  for (size_t pixel = 0; pixel < pixels; ++pixel) memset(of.path + pixel * (D + GUARD), 0, D);
  match_rows(p, left, width, height, words, &of);
  return NULL;
}
