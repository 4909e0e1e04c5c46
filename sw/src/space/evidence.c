#include "space/evidence.h"

#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "common/wide_vectors.h"

#define FOOT_PX 5 /* least disparity of the ground at which something may be seen to stand */
#define THIN_PX 1 /* by which the engine's own word is nearer than what else is there */
#define AROUND_PX 2 /* of the coarser level: where its words have to agree, */
#define AGREE_PX 1 /* to this, */
#define AGREE_COUNT 3 /* so many of the four around; */
#define THIN_COUNT 2 /* of the eight around a word of full resolution: in a line, one to each side; */
#define NEAR_PX 20   /* and of one that is so near, where all but a wire is wider than a block, */
#define NEAR_COUNT 4 /* half of them, as along the edge of something */
#define COLUMNS 320 /* of the picture, at least half as many: a place 45 m away is a disc of some 30 of them */
#define HORIZON 0.02 /* 1.1 degrees: nearer to the horizon, an edge may be its own */
#define EDGE_LEVELS 4.0 /* least step of brightness of an edge, in grey levels, */
#define EDGE_SIGMAS 3.0 /* and in standard deviations of a pixel's noise; */
#define EDGE_ROWS 2     /* from the mean of so many rows to that of the next ones, */
#define EDGE_HALF_PX 3  /* of so many columns to each side. */
#define GROUND_EDGE_LEVELS 20.0 /* The same below the horizon, where what fades has some texture left, */
#define SIGHTS 256 /* lines of sight that are judged at once, side by side */

int32_t vista_evidence_step_px(const vista_camera *camera) {
  const int32_t longer_px = camera->width_px > camera->height_px ? camera->width_px : camera->height_px;
  return longer_px >= 2 * COLUMNS ? longer_px / COLUMNS : 1;
}

void vista_evidence_layout(vista_evidence *evidence, vista_arena *arena, const vista_camera *camera) {
  const int32_t step_px = vista_evidence_step_px(camera);
  evidence->step_px = step_px;
  evidence->width = (camera->width_px + step_px - 1) / step_px;
  evidence->height = (camera->height_px + step_px - 1) / step_px;
  const size_t count = (size_t)evidence->width * (size_t)evidence->height;
  evidence->word = vista_arena_take(arena, count, sizeof *evidence->word);
  evidence->kind = vista_arena_take(arena, count, sizeof *evidence->kind);
  evidence->nearest = vista_arena_take(arena, (size_t)camera->width_px + 1, sizeof *evidence->nearest);
  evidence->thin = vista_arena_take(arena, 3 * ((size_t)evidence->width + 2), sizeof *evidence->thin);
  evidence->low = vista_arena_take(arena, (size_t)evidence->width, sizeof *evidence->low);
  evidence->edged = vista_arena_take(arena, (size_t)evidence->width, sizeof *evidence->edged);
}

/* The nearest word of each column of the image and of the step_px - 1 after it, in the rows of one row of the picture. */
VISTA_WIDE_VECTORS static void nearest_of_rows(const vista_disparity_image *words, int32_t first, int32_t step_px,
                                               int16_t *restrict nearest) {
  const int32_t width = words->width_px, left = words->height_px - first, rows = left < step_px ? left : step_px;
  const int16_t *restrict row = words->data + (ptrdiff_t)first * words->stride;
  memcpy(nearest, row, (size_t)width * sizeof *nearest);
  nearest[width] = VISTA_DISPARITY_INVALID;
  for (int32_t k = 1; k < rows; ++k) {
    row += words->stride;
    for (int32_t u = 0; u < width; ++u) nearest[u] = row[u] > nearest[u] ? row[u] : nearest[u];
  }
  for (int32_t k = 1; k < step_px; ++k)
    for (int32_t u = 0; u < width; ++u) nearest[u] = nearest[u + 1] > nearest[u] ? nearest[u + 1] : nearest[u];
}

static inline int16_t agrees(int16_t around, int16_t word) {
  const int16_t off = (int16_t)(around - word); /* of two that are positive */
  return (int16_t)((around > 0) & (off <= AGREE_PX * VISTA_DISPARITY_SCALE) &
                   (off >= -AGREE_PX * VISTA_DISPARITY_SCALE));
}

/* The nearest of the engine's words in each pixel of row y of the picture, with a rim to both sides; beyond its rows
 * there are none. */
static void thin_row(const vista_disparity_image *words, vista_evidence *evidence, int32_t y) {
  int16_t *restrict const thin = evidence->thin + (ptrdiff_t)((y + 3) % 3) * (evidence->width + 2);
  memset(thin, 0, (size_t)(evidence->width + 2) * sizeof *thin);
  if (y < 0 || y >= evidence->height) return;
  nearest_of_rows(words, y * evidence->step_px, evidence->step_px, evidence->nearest);
  const int16_t *restrict nearest = evidence->nearest;
  for (int32_t x = 0; x < evidence->width; ++x, nearest += evidence->step_px) thin[x + 1] = *nearest;
}

/* Masks and no branch: whether a word is nearer is hard to foresee. */
VISTA_WIDE_VECTORS static void add_thin_row(const int16_t *restrict above, const int16_t *restrict thin,
                                            const int16_t *restrict below, int32_t width, int16_t *restrict word,
                                            uint8_t *restrict kind) {
  for (int32_t x = 0; x < width; ++x) {
    const int16_t w = thin[x + 1];
    const int16_t agree =
        (int16_t)(agrees(thin[x], w) + agrees(thin[x + 2], w) + agrees(above[x], w) + agrees(above[x + 1], w) +
                  agrees(above[x + 2], w) + agrees(below[x], w) + agrees(below[x + 1], w) + agrees(below[x + 2], w));
    const int16_t needed = w > NEAR_PX * VISTA_DISPARITY_SCALE ? NEAR_COUNT : THIN_COUNT;
    const int16_t nearer = (int16_t)-((agree >= needed) & (kind[x] != VISTA_SIGHT_OUTSIDE) &
                                      (w > word[x] + THIN_PX * VISTA_DISPARITY_SCALE));
    word[x] = (int16_t)((w & nearer) | (word[x] & ~nearer));
    kind[x] = (uint8_t)((VISTA_SIGHT_WORD & nearer) | (kind[x] & ~nearer));
  }
}

static void add_thin(const vista_disparity_image *words, vista_evidence *evidence) {
  const ptrdiff_t width = evidence->width, rim = width + 2;
  thin_row(words, evidence, -1);
  thin_row(words, evidence, 0);
  for (int32_t y = 0; y < evidence->height; ++y) {
    thin_row(words, evidence, y + 1);
    const int16_t *const thin = evidence->thin;
    add_thin_row(thin + (y + 2) % 3 * rim, thin + y % 3 * rim, thin + (y + 1) % 3 * rim, evidence->width,
                 evidence->word + y * width, evidence->kind + y * width);
  }
}

/* The words of a row of the next coarser level, in units of level 0, where AGREE_COUNT of the pixels around agree; else 0.
 * They bound what is not matched at full size, such as ground whose fine texture drowns in noise; chance matches stand
 * alone. */
VISTA_WIDE_VECTORS static void coarser_row(const vista_disparity_image *coarser, int32_t v_px, int16_t *restrict out) {
  const int32_t width = coarser->width_px, end = width - AROUND_PX;
  memset(out, 0, (size_t)width * sizeof *out);
  if (v_px < AROUND_PX || v_px >= coarser->height_px - AROUND_PX) return;
  const int16_t *const at = coarser->data + (ptrdiff_t)v_px * coarser->stride;
  const int16_t *const above = at - AROUND_PX * coarser->stride, *const below = at + AROUND_PX * coarser->stride;
  for (int32_t u = AROUND_PX; u < end; ++u) {
    const int16_t word = at[u];
    const int16_t agree = (int16_t)(agrees(at[u - AROUND_PX], word) + agrees(at[u + AROUND_PX], word) +
                                    agrees(above[u], word) + agrees(below[u], word));
    const int16_t bounds = (int16_t)-((word > 0) & (word <= INT16_MAX / 2) & (agree >= AGREE_COUNT));
    out[u] = (int16_t)(2 * (word & bounds));
  }
}

/* Some columns of the picture. */
typedef struct span {
  int32_t first, end;
} span;

/* Some lines of sight of a row of the picture. */
typedef struct sights {
  int16_t matched[SIGHTS], coarser[SIGHTS]; /* words; 0: none */
  int16_t level[SIGHTS], deep[SIGHTS], high[SIGHTS]; /* flags: on a surface to fly along; below the horizon, above it */
  int16_t edge[SIGHTS]; /* flags: the brightness changes there */
} sights;

/* What bounds them, after what bounds the ones below: masks, for vectors of words. Returns whether any hangs. */
VISTA_WIDE_VECTORS static bool bound(const sights *s, int32_t count, const int16_t *restrict below,
                                     int16_t *restrict word, uint8_t *restrict kind, int16_t *restrict low,
                                     int16_t *restrict edged) {
  const int16_t agree = AGREE_PX * VISTA_DISPARITY_SCALE, foot = FOOT_PX * VISTA_DISPARITY_SCALE;
  int16_t any = 0;
  for (int32_t k = 0; k < count; ++k) {
    const int16_t coarser = s->coarser[k], under = below[k], matched = (int16_t)-(s->matched[k] > 0);
    /* What lies higher in the image and is nearer than what bounds it hangs, or is wrong. */
    const int16_t nearer = (int16_t)-((int16_t)(coarser - agree) > under), based = (int16_t)-(under > 0);
    const int16_t own = (int16_t)(matched | (-(coarser > 0) & ~(nearer & based)));
    const int16_t from_coarser = (int16_t)(own & ~matched);
    const int16_t found = (int16_t)((s->matched[k] & matched) | (coarser & from_coarser) | (under & ~own));
    const int16_t deep = (int16_t)(s->deep[k] & -(found < foot)), is_low = (int16_t)((deep & own) | (low[k] & ~own));
    const int16_t is_edged = (int16_t)((s->edge[k] | edged[k]) & ~own);
    const int16_t bounded = (int16_t)(-(found > 0) & ~matched);
    const int16_t hangs = (int16_t)(bounded & is_low & s->high[k] & is_edged);
    const int16_t unmatched = (int16_t)((VISTA_SIGHT_UNBOUNDED & ~bounded) | (VISTA_SIGHT_BOUNDED & bounded & ~hangs) |
                                        (VISTA_SIGHT_HANGING & hangs));
    word[k] = found;
    kind[k] = (uint8_t)((s->level[k] & matched) | (unmatched & ~matched));
    low[k] = is_low;
    edged[k] = is_edged;
    any = (int16_t)(any | hangs);
  }
  return any != 0;
}

/* What the words, the next coarser level and the pose say of some lines of sight of row y, from x on. */
static void gather(const vista_frame_view *frame, const vista_surfaces *surfaces, const vista_evidence *evidence,
                   int32_t x, int32_t y, int32_t count, sights *s) {
  const int32_t step_px = evidence->step_px;
  const vista_camera *const camera = frame->camera;
  const int16_t *const row = frame->words.data + (ptrdiff_t)y * step_px * frame->words.stride;
  const int32_t *const cells = frame->foveation->cell_of_pixel + (ptrdiff_t)y * step_px * camera->width_px;
  const bool has_coarser = frame->levels[1].data != NULL;
  const int16_t *const coarser = evidence->nearest;
  const uint8_t *const horizontal = surfaces->horizontal;
  for (int32_t k = 0; k < count; ++k) {
    const int32_t u = (x + k) * step_px;
    s->matched[k] = (int16_t)(row[u] + (row[u] == 0)); /* too far to have a disparity, and matched */
    s->level[k] = horizontal[cells[u]] ? VISTA_SIGHT_LEVEL : VISTA_SIGHT_WORD;
    s->coarser[k] = has_coarser ? coarser[(u + 1) / 2] : 0;
  }
  /* Height of the line of sight at depth 1, against gravity: positive above the horizon. */
  const double *const up = frame->up_camera;
  const double row_height = up[1] * (y * step_px - camera->center_v_px) / camera->focal_px + up[2];
  const double column_height = up[0] / camera->focal_px, off_horizon = HORIZON + EDGE_ROWS / camera->focal_px;
  for (int32_t k = 0; k < count; ++k) {
    const double height = row_height + column_height * ((x + k) * step_px - camera->center_u_px);
    s->deep[k] = (int16_t)-(height < -VISTA_SIGHT_LOW);
    s->high[k] = (int16_t)-(height > 0.0);
    s->edge[k] = (int16_t)-(fabs(height) > off_horizon); /* as far as is known so far */
  }
}

/* The step of brightness from the rows `spread_px` below row v of the image to those above it: a sum over its pixels. */
static int32_t step_at(const vista_image *image, int32_t u, int32_t v, int32_t spread_px) {
  int32_t step = 0;
  for (int32_t row = 0; row < EDGE_ROWS; ++row) {
    const uint8_t *const lower = image->data + (v + spread_px + row) * image->stride + u;
    const uint8_t *const upper = image->data + (v - EDGE_ROWS + row) * image->stride + u;
    for (int32_t side = -EDGE_HALF_PX; side <= EDGE_HALF_PX; ++side) step += lower[side] - upper[side];
  }
  return step;
}

/* Whether the brightness changes there, and above it by less than half as much: haze changes it all the way up to the
 * horizon. */
static bool is_edge(const vista_image *image, int32_t u, int32_t v, int32_t spread_px, double least_levels) {
  const int32_t below = v + spread_px, above = v - spread_px - 2 * EDGE_ROWS;
  if (above < EDGE_ROWS || below + EDGE_ROWS > image->height_px || u < EDGE_HALF_PX ||
      u + EDGE_HALF_PX >= image->width_px)
    return false;
  const int32_t step = abs(step_at(image, u, v, spread_px));
  return step >= EDGE_ROWS * (2 * EDGE_HALF_PX + 1) * least_levels &&
         2 * abs(step_at(image, u, above, spread_px)) < step;
}

/* Where lines of sight of row y, from x on, cross an edge, if that tells anything there: beyond ground that fades before
 * the horizon the sky has no edges, but what hangs in the air begins and ends somewhere. */
static void find_edges(const vista_frame_view *frame, const vista_evidence *evidence, int32_t x, int32_t y,
                       int32_t count, sights *s) {
  int16_t wanted = 0;
  for (int32_t k = 0; k < count; ++k) wanted = (int16_t)(wanted | (evidence->low[x + k] & s->edge[k]));
  if (!frame->seen || !wanted) return; /* without an image there may be edges everywhere */
  const double in_sky = vista_image_noise_threshold(&frame->noise, EDGE_LEVELS, EDGE_SIGMAS);
  const double at_ground = fmax(in_sky, GROUND_EDGE_LEVELS);
  const int32_t step_px = evidence->step_px;
  for (int32_t k = 0; k < count; ++k) {
    if (!evidence->low[x + k] || !s->edge[k]) continue;
    const bool found = s->high[k]
                           ? is_edge(&frame->image, (x + k) * step_px, y * step_px, 0, in_sky)
                           : is_edge(&frame->image, (x + k) * step_px, y * step_px, VISTA_SIGHT_SPREAD_PX, at_ground);
    s->edge[k] = (int16_t)-found;
  }
}

bool vista_evidence_begins(const vista_frame_view *frame, int32_t u_px, int32_t v_px) {
  if (!frame->seen) return true;
  const double in_sky = vista_image_noise_threshold(&frame->noise, EDGE_LEVELS, EDGE_SIGMAS);
  return is_edge(&frame->image, u_px, v_px, VISTA_SIGHT_SPREAD_PX, fmax(in_sky, GROUND_EDGE_LEVELS));
}

/* The columns of the picture in which the engine matches. */
static span matched_columns(const vista_camera *camera, const vista_margins *margins, const vista_evidence *evidence) {
  const double right_px = camera->width_px - 1 - margins->other_px;
  span inside = {0, evidence->width};
  while (inside.first < inside.end && inside.first * evidence->step_px < margins->left_px) ++inside.first;
  while (inside.end > inside.first && (inside.end - 1) * evidence->step_px > right_px) --inside.end;
  return inside;
}

static void set_outside(vista_evidence *evidence, int32_t y, int32_t first, int32_t end) {
  const size_t at = (size_t)y * (size_t)evidence->width + (size_t)first, count = (size_t)(end - first);
  memset(evidence->word + at, 0, count * sizeof *evidence->word);
  memset(evidence->kind + at, VISTA_SIGHT_OUTSIDE, count * sizeof *evidence->kind);
}

/* What lies below something that hangs, as far as the same word bounds it, may hang as well. */
static void hang_below(vista_evidence *evidence, int32_t x, int32_t y) {
  uint8_t *kind = evidence->kind + (ptrdiff_t)y * evidence->width + x;
  if (*kind != VISTA_SIGHT_HANGING) return;
  while (++y < evidence->height && *(kind += evidence->width) == VISTA_SIGHT_BOUNDED) *kind = VISTA_SIGHT_HANGING;
}

void vista_evidence_take(const vista_frame_view *frame, const vista_surfaces *surfaces, vista_evidence *evidence) {
  static const int16_t nothing[SIGHTS];
  const int32_t width = evidence->width, height = evidence->height, step_px = evidence->step_px;
  const vista_camera *const camera = frame->camera;
  evidence->pose = frame->motion.pose;
  evidence->t_ns = frame->t_ns;
  const vista_margins margins = vista_matched_margins(&frame->matched, 0.0);
  const span inside = matched_columns(camera, &margins, evidence);
  /* Rows are taken from the bottom up: the one below holds the word that bounds each column so far. */
  for (int32_t y = height - 1; y >= 0; --y) {
    if (y * step_px < margins.other_px || y * step_px > camera->height_px - 1 - margins.other_px) {
      set_outside(evidence, y, 0, width);
      continue;
    }
    set_outside(evidence, y, 0, inside.first);
    set_outside(evidence, y, inside.end, width);
    if (frame->levels[1].data != NULL) coarser_row(&frame->levels[1], (y * step_px + 1) / 2, evidence->nearest);
    for (int32_t x = inside.first; x < inside.end; x += SIGHTS) {
      const int32_t left = inside.end - x, count = left < SIGHTS ? left : SIGHTS;
      int16_t *const word = evidence->word + (ptrdiff_t)y * width + x;
      sights s;
      gather(frame, surfaces, evidence, x, y, count, &s);
      find_edges(frame, evidence, x, y, count, &s);
      if (bound(&s, count, y + 1 < height ? word + width : nothing, word, evidence->kind + (ptrdiff_t)y * width + x,
                evidence->low + x, evidence->edged + x))
        for (int32_t k = 0; k < count; ++k) hang_below(evidence, x + k, y);
    }
  }
  add_thin(&frame->levels[0], evidence);
}
