#include "four_paths.h"

#include <stdbool.h>
#include <string.h>

enum {
  CAP = 31,
  MOST_SIDE_PX = 8192,
  PATHS = 3,
  GUARD = 16,
  APART = 4,
  TEXTURE_RADIUS = 5,
  KEY_BITS = 6,
  KEY_MASK = (1 << KEY_BITS) - 1,
  TOP = 1023
};

#if defined(__x86_64__) && defined(__GLIBC__)
#define FOR_EACH_PROCESSOR __attribute__((target_clones("arch=x86-64-v3", "default")))
#else
#define FOR_EACH_PROCESSOR
#endif
#define INLINE static inline __attribute__((always_inline))

/* Where the parts of the scratch begin. Rows of right pixels run backwards, so that candidates d = 0, 1, .. of a left
 * pixel are neighbours: right pixel x lies at width - 1 - x. */
typedef struct parts {
  uint8_t *turned;             /* the right image */
  uint8_t *response[2];        /* the engine's prefilter of both images */
  uint8_t *left, *right;       /* the bytes of the census of a row */
  uint8_t *cost;         /* [width][D] */
  uint16_t *column;      /* [width][D]: SAD of the columns of the windows */
  uint8_t *path;         /* [PATHS][width + 2][D + GUARD]: of the row above, less the smallest of its pixel */
  uint16_t *right_key;   /* [APART][width]: smallest key of each right pixel, of every fourth left pixel */
  uint16_t *texture;     /* [width]: sums of columns */
  uint16_t *key, *below, *above;
  uint8_t *unique;
} parts;

static int32_t largest_cost(const vista_paths_params *p) {
  const int32_t side = 2 * p->radius + 1;
  if (p->cost == VISTA_PATHS_CENSUS) return side * side - 1;
  return (2 * CAP * side * side) >> (2 * p->radius);
}

const char *vista_paths_refused(const vista_paths_params *p, int32_t width, int32_t height) {
  const int32_t D = p->num_disparities;
  if (D != 32 && D != VISTA_PATHS_MAX_DISPARITIES) return "num_disparities must be 32 or 64";
  if (p->cost != VISTA_PATHS_CENSUS && p->cost != VISTA_PATHS_SAD) return "cost must be census or SAD";
  const int32_t least = p->cost == VISTA_PATHS_CENSUS ? 2 : 1;
  if (p->radius < least || p->radius > least + 1) return "radius must be 2 or 3 for census, 1 or 2 for SAD";
  if (p->near < 0 || p->far < p->near || p->far > UINT8_MAX || largest_cost(p) + p->near + p->far > UINT8_MAX)
    return "penalties must be 0 <= near <= far, and with the largest cost at most 255";
  if (p->texture_threshold < 0) return "texture_threshold must not be negative";
  if (p->uniqueness_ratio < 0 || p->uniqueness_ratio > 100) return "uniqueness_ratio must be from 0 to 100";
  if (p->lr_max_diff < -1 || p->lr_max_diff > 255) return "lr_max_diff must be from -1 to 255";
  if (width < 1 || width > MOST_SIDE_PX || height < 1 || height > MOST_SIDE_PX)
    return "images must be from 1 to 8192 px a side";
  return NULL;
}

/* Hands out the next part of the scratch, which may be none, and counts. */
static void *take(uint8_t *scratch, size_t *used, size_t bytes) {
  void *part = scratch ? scratch + *used : NULL;
  *used += (bytes + 63) / 64 * 64;
  return part;
}

static size_t lay_out(const vista_paths_params *p, size_t width, size_t height, uint8_t *scratch, parts *of) {
  const size_t D = (size_t)p->num_disparities;
  const bool sad = p->cost == VISTA_PATHS_SAD;
  size_t used = 0;
  of->turned = take(scratch, &used, width * height);
  of->response[0] = take(scratch, &used, width * height);
  of->response[1] = take(scratch, &used, sad ? width * height : 0);
  of->left = take(scratch, &used, sad ? 0 : 6 * width);
  of->right = take(scratch, &used, sad ? 0 : 6 * width);
  of->cost = take(scratch, &used, width * D);
  of->column = take(scratch, &used, sad ? width * D * sizeof *of->column : 0);
  of->path = take(scratch, &used, PATHS * (width + 2) * (D + GUARD));
  of->right_key = take(scratch, &used, APART * width * sizeof(uint16_t));
  of->texture = take(scratch, &used, width * sizeof(uint16_t));
  of->key = take(scratch, &used, width * sizeof(uint16_t));
  of->below = take(scratch, &used, width * sizeof(uint16_t));
  of->above = take(scratch, &used, width * sizeof(uint16_t));
  of->unique = take(scratch, &used, width);
  return used;
}

size_t vista_paths_scratch_bytes(const vista_paths_params *params, int32_t width, int32_t height) {
  parts of;
  return vista_paths_refused(params, width, height) ? 0 : lay_out(params, (size_t)width, (size_t)height, NULL, &of);
}

/* ---- costs ---- */

/* Bit k of a pixel's window, rows from the top: that pixel is darker than the middle. 8 bits a byte, in planes.
 * sign: -1 in an image whose rows run backwards. */
INLINE void census_row(const uint8_t *image, int32_t width, int32_t y, int32_t r, uint8_t *restrict planes, int sign) {
  const int32_t side = 2 * r + 1, pixels = side * side;
  const uint8_t *const middle = image + (ptrdiff_t)y * width;
  for (int32_t first = 0; first < pixels - 1; first += 8, planes += width) {
    const uint8_t *other[8];
    for (int k = 0; k < 8; ++k) {
      const int32_t place = first + k < pixels / 2 ? first + k : first + k + 1; /* not the middle itself */
      other[k] = middle + (ptrdiff_t)(place / side - r) * width + sign * (place % side - r);
    }
    for (int32_t x = r; x < width - r; ++x) {
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

/* Adds what differs in three planes: a half has at most 12 of their bits. */
INLINE void add_planes(const uint8_t *left, const uint8_t *right, ptrdiff_t width, uint8_t *restrict cost, int D) {
  const uint8_t a = left[0], b = left[width], c = left[2 * width];
  for (int d = 0; d < D; ++d) {
    const uint8_t halves = (uint8_t)(ones_of_halves(a ^ right[d]) + ones_of_halves(b ^ right[width + d]) +
                                     ones_of_halves(c ^ right[2 * width + d]));
    cost[d] = (uint8_t)(cost[d] + (halves & 0x0F) + (halves >> 4));
  }
}

INLINE void census_costs(const parts *of, int32_t width, int32_t first, int32_t end, int32_t r, int D) {
  memset(of->cost + (ptrdiff_t)first * D, 0, (size_t)(end - first) * (size_t)D);
  for (int32_t x = first; x < end; ++x) {
    const uint8_t *left = of->left + x, *right = of->right + (width - 1 - x);
    uint8_t *cost = of->cost + (ptrdiff_t)x * D;
    add_planes(left, right, width, cost, D);
    if (r == 3) add_planes(left + 3 * (ptrdiff_t)width, right + 3 * (ptrdiff_t)width, width, cost, D);
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

INLINE void sad_costs(const parts *of, int32_t width, int32_t y, int32_t r, int32_t first, int32_t end, int D) {
  for (int32_t x = first - r; x < end + r; ++x) {
    uint16_t *column = of->column + (ptrdiff_t)x * D, sum[VISTA_PATHS_MAX_DISPARITIES] = {0};
    for (int32_t j = y - r; j <= y + r; ++j) {
      const uint8_t left = of->response[0][(ptrdiff_t)j * width + x];
      const uint8_t *right = of->response[1] + (ptrdiff_t)j * width + (width - 1 - x);
      for (int d = 0; d < D; ++d) {
        const uint8_t more = left > right[d] ? left : right[d], less = left > right[d] ? right[d] : left;
        sum[d] = (uint16_t)(sum[d] + (uint8_t)(more - less));
      }
    }
    memcpy(column, sum, (size_t)D * sizeof *column);
  }
  for (int32_t x = first; x < end; ++x) {
    const uint16_t *window = of->column + (ptrdiff_t)(x - r) * D;
    uint8_t *restrict cost = of->cost + (ptrdiff_t)x * D;
    for (int d = 0; d < D; ++d) {
      uint16_t sum = window[d];
#pragma GCC unroll 4
      for (int i = 1; i <= 2 * r; ++i) sum = (uint16_t)(sum + window[i * D + d]);
      cost[d] = (uint8_t)(sum >> (2 * r));
    }
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

/* Steps 3, 5 and half of 6 of the contract, and what 7 needs. A key is a cost with 63 - d below it: the smallest key has
 * the smallest cost and, of equals, the larger d. */
INLINE void pick(const parts *of, int32_t width, int32_t x, const uint16_t *sum, int32_t ratio, int D) {
  uint16_t keys[VISTA_PATHS_MAX_DISPARITIES], least = UINT16_MAX,
                                              *right = of->right_key + (x % APART + 1) * (ptrdiff_t)width - 1 - x;
  for (int d = 0; d < D; ++d) {
    keys[d] = (uint16_t)((sum[d] << KEY_BITS) | (KEY_MASK - d));
    least = keys[d] < least ? keys[d] : least;
  }
  for (int d = 0; d < D; ++d) right[d] = keys[d] < right[d] ? keys[d] : right[d];
  const int32_t best = KEY_MASK - (least & KEY_MASK), smallest = least >> KEY_BITS;
  const int32_t bound = smallest + smallest * ratio / 100;
  const uint16_t limit = (uint16_t)(((bound > TOP ? TOP : bound) << KEY_BITS) | KEY_MASK);
  uint16_t close = 0;
  for (int d = 0; d < D; ++d) close = (uint16_t)(close + (keys[d] <= limit));
  for (int32_t d = best - 1; d <= best + 1; ++d)
    if (d >= 0 && d < D) close = (uint16_t)(close - (keys[d] <= limit));
  of->key[x] = least;
  of->unique[x] = ratio == 0 || close == 0;
  of->below[x] = sum[best > 0 ? best - 1 : 1];
  of->above[x] = sum[best < D - 1 ? best + 1 : D - 2];
}

INLINE void follow(const parts *of, const vista_paths_params *p, int32_t width, int32_t first, int32_t end, int D) {
  const ptrdiff_t stride = D + GUARD, row = (width + 2) * stride;
  uint8_t *const up_left = of->path + stride, *const up = up_left + row, *const up_right = up + row;
  const uint8_t near = (uint8_t)p->near, far = (uint8_t)p->far;
  uint8_t left[VISTA_PATHS_MAX_DISPARITIES + GUARD], corner[VISTA_PATHS_MAX_DISPARITIES + GUARD];
  memset(left, far, sizeof left);
  memset(left + 1, 0, (size_t)D);
  memcpy(corner, left, sizeof corner); /* nothing comes from beside the matched pixels */
  for (int32_t x = first; x < end; ++x) {
    const uint8_t *cost = of->cost + (ptrdiff_t)x * D;
    uint8_t here[4][VISTA_PATHS_MAX_DISPARITIES], kept[VISTA_PATHS_MAX_DISPARITIES], *const at = up_left + x * stride;
    uint16_t sum[VISTA_PATHS_MAX_DISPARITIES];
    step(cost, left + 1, here[0], left + 1, near, far, D);
    memcpy(kept, at, (size_t)D);
    step(cost, corner + 1, here[1], at, near, far, D);
    memcpy(corner + 1, kept, (size_t)D);
    step(cost, up + x * stride, here[2], up + x * stride, near, far, D);
    step(cost, up_right + (x + 1) * stride, here[3], up_right + x * stride, near, far, D);
    for (int d = 0; d < D; ++d) sum[d] = (uint16_t)(here[0][d] + here[1][d] + here[2][d] + here[3][d]);
    pick(of, width, x, sum, p->uniqueness_ratio, D);
  }
}

INLINE void add_texture(const parts *of, int32_t width, int32_t row, int sign) {
  const uint8_t *response = of->response[0] + (ptrdiff_t)row * width;
  for (int32_t x = 0; x < width; ++x)
    of->texture[x] = (uint16_t)(of->texture[x] + sign * (response[x] > CAP ? response[x] - CAP : CAP - response[x]));
}

/* Step 4, over the part of a block of 11 px that lies within the image. Rows come one after the other. */
INLINE void ask_texture(const parts *of, int32_t threshold, int32_t width, int32_t height, int32_t y, int32_t first,
                        int32_t end) {
  if (y + TEXTURE_RADIUS < height) add_texture(of, width, y + TEXTURE_RADIUS, 1);
  if (y > TEXTURE_RADIUS) add_texture(of, width, y - TEXTURE_RADIUS - 1, -1);
  int32_t sum = 0;
  for (int32_t x = first - TEXTURE_RADIUS; x < first + TEXTURE_RADIUS && x < width; ++x) sum += of->texture[x];
  for (int32_t x = first; x < end; ++x) {
    if (x + TEXTURE_RADIUS < width) sum += of->texture[x + TEXTURE_RADIUS];
    of->unique[x] &= sum >= threshold;
    sum -= of->texture[x - TEXTURE_RADIUS];
  }
}

/* Steps 6 and 7 of a row. The fraction of 8 bits is exact in floats: numerator and denominator are below 2^19. */
INLINE void finish(const parts *of, const vista_paths_params *p, int32_t width, int32_t first, int32_t end,
                   int16_t *words) {
  const int32_t most = p->lr_max_diff < 0 ? INT32_MAX : p->lr_max_diff;
  for (int k = 1; k < APART; ++k)
    for (int32_t x = 0; x < width; ++x)
      if (of->right_key[k * (ptrdiff_t)width + x] < of->right_key[x])
        of->right_key[x] = of->right_key[k * (ptrdiff_t)width + x];
  for (int32_t x = first; x < end; ++x) {
    const int32_t best = KEY_MASK - (of->key[x] & KEY_MASK);
    const int32_t apart = best - KEY_MASK + (of->right_key[width - 1 - x + best] & KEY_MASK);
    of->unique[x] &= (apart < 0 ? -apart : apart) <= most;
  }
  for (int32_t x = first; x < end; ++x) {
    const int32_t best = KEY_MASK - (of->key[x] & KEY_MASK), smallest = of->key[x] >> KEY_BITS;
    const int32_t below = of->below[x], above = of->above[x], slope = below - above;
    const int32_t q = below + above - 2 * smallest + (slope < 0 ? -slope : slope);
    const int32_t part = (int32_t)((float)(256 * slope) / (float)(q > 0 ? q : 1));
    words[x] = (int16_t)(of->unique[x] ? (256 * best + part + 15) >> 4 : VISTA_PATHS_INVALID);
  }
}

INLINE void match(const vista_paths_params *p, const uint8_t *left, int32_t width, int32_t height, int16_t *words,
                  const parts *of, int D) {
  const int32_t r = p->radius, first = D - 1 + r, end = width - r;
  memset(of->texture, 0, (size_t)width * sizeof *of->texture);
  for (int32_t y = 0; y < r + TEXTURE_RADIUS && y < height; ++y) add_texture(of, width, y, 1);
  for (int32_t y = r; y < height - r; ++y) {
    if (p->cost == VISTA_PATHS_CENSUS) {
      census_row(left, width, y, r, of->left, 1);
      census_row(of->turned, width, y, r, of->right, -1);
      census_costs(of, width, first, end, r, D);
    } else if (r == 1) {
      sad_costs(of, width, y, 1, first, end, D);
    } else {
      sad_costs(of, width, y, 2, first, end, D);
    }
    memset(of->right_key, 0xFF, APART * (size_t)width * sizeof *of->right_key);
    follow(of, p, width, first, end, D);
    ask_texture(of, p->texture_threshold, width, height, y, first, end);
    finish(of, p, width, first, end, words + (ptrdiff_t)y * width);
  }
}

FOR_EACH_PROCESSOR
static void match_all(const vista_paths_params *p, const uint8_t *left, int32_t width, int32_t height, int16_t *words,
                      const parts *of) {
  respond(left, width, height, of->response[0], 1);
  if (p->cost == VISTA_PATHS_SAD) respond(of->turned, width, height, of->response[1], -1);
  if (p->num_disparities == 32)
    match(p, left, width, height, words, of, 32);
  else
    match(p, left, width, height, words, of, 64);
}

const char *vista_paths_match(const vista_paths_params *p, const uint8_t *left, const uint8_t *right, int32_t width,
                              int32_t height, int16_t *words, uint8_t *scratch) {
  const char *refused = vista_paths_refused(p, width, height);
  if (refused) return refused;
  parts of;
  lay_out(p, (size_t)width, (size_t)height, scratch, &of);
  for (ptrdiff_t i = 0; i < (ptrdiff_t)width * height; ++i) words[i] = VISTA_PATHS_INVALID;
  if (width < p->num_disparities + 2 * p->radius) return NULL;
  for (ptrdiff_t y = 0; y < height; ++y)
    for (ptrdiff_t x = 0; x < width; ++x) of.turned[y * width + x] = right[y * width + width - 1 - x];
  const ptrdiff_t stride = p->num_disparities + GUARD;
  memset(of.path, p->far, (size_t)(PATHS * (width + 2) * stride)); /* the guards keep it */
  for (ptrdiff_t pixel = 0; pixel < PATHS * (width + 2); ++pixel)
    memset(of.path + pixel * stride, 0, (size_t)p->num_disparities);
  match_all(p, left, width, height, words, &of);
  return NULL;
}
