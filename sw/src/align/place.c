#include "align/place.h"

#include <math.h>
#include <stddef.h>

#include "common/numbers.h"
#include "common/wide_vectors.h"

#define SIDE VISTA_PLACE_SIDE
#define PIXELS (SIDE * SIDE)
#define STEPS_MOST 8
#define STEP_SMALL 0.01f   /* px: the last one */
#define DRIFT_MOST 2.5f    /* px from where it began */
#define CORRELATION_MIN 0.8f

/* The left tile, its mean taken off, and its gradients. */
typedef struct vista_template {
  float grey[PIXELS], gu[PIXELS], gv[PIXELS];
  float spread; /* sqrt(sum of grey^2) */
  float uu, uv, vv;
} vista_template;

static float sum_of(const float lanes[SIDE]) {
  float sum = 0.0f;
  for (int k = 0; k < SIDE; ++k) sum += lanes[k];
  return sum;
}

VISTA_WIDE_VECTORS static void make_template(const vista_level *left, int32_t u0, int32_t v0, vista_template *t) {
  const ptrdiff_t width = left->width_px;
  float sums[SIDE] = {0}, squares[SIDE] = {0}, uu[SIDE] = {0}, uv[SIDE] = {0}, vv[SIDE] = {0};
  for (int y = 0; y < SIDE; ++y) {
    const uint8_t *const row = left->pixels + (v0 + y) * width + u0;
    for (int x = 0; x < SIDE; ++x) {
      const float gu = 0.5f * (float)(row[x + 1] - row[x - 1]), gv = 0.5f * (float)(row[x + width] - row[x - width]);
      t->grey[y * SIDE + x] = row[x];
      t->gu[y * SIDE + x] = gu;
      t->gv[y * SIDE + x] = gv;
      sums[x] += row[x];
      uu[x] += gu * gu;
      uv[x] += gu * gv;
      vv[x] += gv * gv;
    }
  }
  const float mean = sum_of(sums) / PIXELS;
  for (int y = 0; y < SIDE; ++y)
    for (int x = 0; x < SIDE; ++x) {
      t->grey[y * SIDE + x] -= mean;
      squares[x] += t->grey[y * SIDE + x] * t->grey[y * SIDE + x];
    }
  t->spread = sqrtf(sum_of(squares));
  t->uu = sum_of(uu);
  t->uv = sum_of(uv);
  t->vv = sum_of(vv);
}

/* The right tile at a place between pixels, without its mean; its spread. */
VISTA_WIDE_VECTORS static float sample(const vista_level *right, float u, float v, float grey[PIXELS]) {
  const float whole_u = floorf(u), whole_v = floorf(v), fu = u - whole_u, fv = v - whole_v;
  const ptrdiff_t width = right->width_px;
  const uint8_t *const start = right->pixels + (ptrdiff_t)whole_v * width + (ptrdiff_t)whole_u;
  const float w00 = (1.0f - fu) * (1.0f - fv), w01 = fu * (1.0f - fv), w10 = (1.0f - fu) * fv, w11 = fu * fv;
  float sums[SIDE] = {0}, squares[SIDE] = {0};
  for (int y = 0; y < SIDE; ++y) {
    const uint8_t *const a = start + y * width, *const b = a + width;
    for (int x = 0; x < SIDE; ++x) {
      const float value = w00 * a[x] + w01 * a[x + 1] + w10 * b[x] + w11 * b[x + 1];
      grey[y * SIDE + x] = value;
      sums[x] += value;
    }
  }
  const float mean = sum_of(sums) / PIXELS;
  for (int y = 0; y < SIDE; ++y)
    for (int x = 0; x < SIDE; ++x) {
      grey[y * SIDE + x] -= mean;
      squares[x] += grey[y * SIDE + x] * grey[y * SIDE + x];
    }
  return sqrtf(sum_of(squares));
}

typedef struct mismatch {
  float u, v, squares, product; /* sums: with the gradients, of itself, and of the grey levels of both */
} mismatch;

/* Left minus right, the latter with the contrast of the left. */
VISTA_WIDE_VECTORS static mismatch compare(const vista_template *t, const float grey[PIXELS], float gain) {
  float u[SIDE] = {0}, v[SIDE] = {0}, squares[SIDE] = {0}, products[SIDE] = {0};
  for (int y = 0; y < SIDE; ++y)
    for (int x = 0; x < SIDE; ++x) {
      const int k = y * SIDE + x;
      const float error = t->grey[k] - gain * grey[k];
      u[x] += error * t->gu[k];
      v[x] += error * t->gv[k];
      squares[x] += error * error;
      products[x] += t->grey[k] * grey[k];
    }
  return (mismatch){sum_of(u), sum_of(v), sum_of(squares), sum_of(products)};
}

static bool inside(const vista_level *level, float u, float v) {
  return u >= 0.0f && v >= 0.0f && u < (float)(level->width_px - SIDE - 1) && v < (float)(level->height_px - SIDE - 1);
}

bool vista_place_refine(const vista_level *left, const vista_level *right, vista_place *place) {
  if (place->u0 < 1 || place->v0 < 1 || !inside(left, (float)place->u0, (float)place->v0)) return false;
  vista_template t;
  make_template(left, place->u0, place->v0, &t);
  const float determinant = t.uu * t.vv - t.uv * t.uv;
  if (!(determinant > 1e-3f * t.uu * t.vv)) return false;
  float du = place->du, dv = place->dv, grey[PIXELS];
  for (int step = 0; step < STEPS_MOST; ++step) {
    const float u = (float)place->u0 + du, v = (float)place->v0 + dv;
    if (!inside(right, u, v)) return false;
    const float spread = sample(right, u, v, grey);
    if (!(spread > 0.0f)) return false;
    const mismatch m = compare(&t, grey, t.spread / spread);
    const float step_u = (t.vv * m.u - t.uv * m.v) / determinant, step_v = (t.uu * m.v - t.uv * m.u) / determinant;
    du += step_u;
    dv += step_v;
    if (fabsf(du - place->du) > DRIFT_MOST || fabsf(dv - place->dv) > DRIFT_MOST) return false;
    if (fabsf(step_u) + fabsf(step_v) > STEP_SMALL) continue;
    if (m.product < CORRELATION_MIN * t.spread * spread) return false;
    place->du = du;
    place->dv = dv;
    place->sigma_v = sqrtf(m.squares / PIXELS * t.uu / determinant);
    return true;
  }
  return false;
}
