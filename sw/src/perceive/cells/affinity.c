#include "perceive/cells/affinity.h"

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include "common/depth.h"
#include "common/image_noise.h"
#include "common/numbers.h"
#include "common/wide_vectors.h"

/* Alpha_d of the paper: weight of the intensity term in the sum; the disparity term has the rest. */
#define ALPHA_INTENSITY 0.5
/* Px per px between the centres, added to mu_disparity_px: cells of the periphery lie farther apart. */
#define MU_DISPARITY_SLOPE 0.1
/* Intensity difference that still counts as none (mu of equation 4): grey levels, and sigmas of the noise of the image. */
#define MU_INTENSITY 2.0
#define MU_INTENSITY_NOISE 0.5
#define FLOW_CONSTANT 10000.0 /* C of the paper: its square root is the ratio of the strongest to the weakest edge */

vista_status vista_affinity_layout(vista_affinity *affinity, vista_arena *arena, const vista_foveation *foveation) {
  const size_t arcs = (size_t)foveation->graph.arc_count;
  affinity->weight = vista_arena_take(arena, arcs, sizeof(float));
  affinity->capacity = vista_arena_take(arena, arcs, sizeof(int32_t));
  affinity->intensity_capacity = vista_arena_take(arena, arcs, sizeof(int32_t));
  return arena->base != NULL && arena->used > arena->size ? VISTA_ERROR_MEMORY : VISTA_OK;
}

/* 2^x within 1e-10 of it, for -1000 < x < 1000: the series of e^(r ln 2) for |r| <= 1/2 times a whole power. */
static inline double power_of_two(double x) {
  const int32_t whole = (int32_t)(x + 1024.5) - 1024;
  const double y = (x - whole) * 0.69314718055994531;
  const double fraction =
      1.0 +
      y * (1.0 + y * (1.0 / 2 +
                      y * (1.0 / 6 +
                           y * (1.0 / 24 + y * (1.0 / 120 + y * (1.0 / 720 + y * (1.0 / 5040 + y * (1.0 / 40320))))))));
  const uint64_t bits = (uint64_t)(1023 + whole) << 52;
  double scale;
  memcpy(&scale, &bits, sizeof scale);
  return fraction * scale;
}

static inline int32_t flow_of(bool linear, double affinity) {
  const double doublings = 0.5 * log2(FLOW_CONSTANT);
  const double exponential = power_of_two(log2(VISTA_FLOW_SCALE) + doublings * (affinity - 1.0));
  return (int32_t)((linear ? VISTA_FLOW_SCALE * (affinity + 1.0) / 2.0 : exponential) + 0.5);
}

int32_t vista_flow_encode(const vista_affinity_params *params, double affinity) {
  return flow_of(params->flow_encoding == VISTA_AFFINITY_FLOW_ENCODING_LINEAR, affinity);
}

#define EDGES 256 /* that are treated at once, side by side */

/* What an affinity is made of. */
typedef struct edges {
  float grey_step[EDGES], disparity_a[EDGES], disparity_b[EDGES], distance_px[EDGES];
  float intensity_exponent[EDGES], disparity_exponent[EDGES]; /* of equation 4; the second negative: not known */
  float weight[EDGES], intensity_weight[EDGES];
  int32_t capacity[EDGES], intensity_capacity[EDGES];
} edges;

static inline float exponent(float difference, float mu, float sigma) {
  const float excess = vista_larger(fabsf(difference), mu) - mu;
  return excess * excess / (2.0f * sigma * sigma);
}

static void gather(const vista_foveation *f, const vista_cells *cells, int32_t first, int32_t count, edges *e) {
  for (int32_t k = 0; k < count; ++k) {
    const int32_t arc = f->graph.edge_arc[first + k], a = f->graph.head[f->graph.reverse[arc]], b = f->graph.head[arc];
    e->grey_step[k] = cells->intensity[a] - cells->intensity[b];
    e->disparity_a[k] = cells->disparity_px[a];
    e->disparity_b[k] = cells->disparity_px[b];
    e->distance_px[k] = f->arc_distance_px[arc];
  }
}

VISTA_WIDE_VECTORS static void find_exponents(const vista_frame_view *frame, int32_t count, edges *e) {
  const vista_affinity_params *const params = &frame->params->affinity;
  const vista_camera *const camera = frame->camera;
  const float mu_i = (float)vista_image_noise_threshold(&frame->noise, MU_INTENSITY, MU_INTENSITY_NOISE);
  const float sigma_i = (float)params->sigma_intensity;
  const float mu_px = (float)params->mu_disparity_px, slope = (float)MU_DISPARITY_SLOPE;
  const float sigma_d = (float)params->sigma_disparity_px, mu_depth_m = (float)params->mu_depth_m;
  for (int32_t k = 0; k < count; ++k) {
    const float a = e->disparity_a[k], b = e->disparity_b[k];
    const float mu_d =
        vista_larger(vista_depth_step_px(camera, vista_larger(a, b), mu_depth_m), mu_px + slope * e->distance_px[k]);
    const float known = exponent(a - b, mu_d, sigma_d);
    e->intensity_exponent[k] = exponent(e->grey_step[k], mu_i, sigma_i);
    e->disparity_exponent[k] = a >= 0.0f && b >= 0.0f ? known : -1.0f;
  }
}

static void weigh(const vista_affinity_params *params, int32_t count, edges *e) {
  const float alpha = (float)ALPHA_INTENSITY;
  const bool sum = params->form == VISTA_AFFINITY_FORM_SUM;
  for (int32_t k = 0; k < count; ++k) {
    const float exponent_i = e->intensity_exponent[k], exponent_d = e->disparity_exponent[k];
    const float of_intensity = exponent_i == 0.0f ? 1.0f : expf(-exponent_i);
    e->intensity_weight[k] = e->weight[k] = of_intensity;
    if (exponent_d >= 0.0f && sum)
      e->weight[k] = alpha * of_intensity + (1.0f - alpha) * expf(-exponent_d);
    else if (exponent_d > 0.0f)
      e->weight[k] = expf(-exponent_i - exponent_d);
  }
}

VISTA_WIDE_VECTORS static void encode(bool linear, const float *restrict weight, int32_t count,
                                      int32_t *restrict capacity) {
  for (int32_t k = 0; k < count; ++k) capacity[k] = flow_of(linear, (double)weight[k]);
}

static void scatter(const vista_graph *graph, int32_t first, int32_t count, const edges *e, vista_affinity *affinity) {
  for (int32_t k = 0; k < count; ++k) {
    const int32_t arc = graph->edge_arc[first + k], sister = graph->reverse[arc];
    affinity->weight[arc] = affinity->weight[sister] = e->weight[k];
    affinity->capacity[arc] = affinity->capacity[sister] = e->capacity[k];
    affinity->intensity_capacity[arc] = affinity->intensity_capacity[sister] = e->intensity_capacity[k];
  }
}

void vista_affinity_compute(const vista_frame_view *frame, const vista_cells *cells, vista_affinity *affinity) {
  const vista_foveation *const foveation = frame->foveation;
  const vista_affinity_params *const params = &frame->params->affinity;
  const bool linear = params->flow_encoding == VISTA_AFFINITY_FLOW_ENCODING_LINEAR;
  edges e;
  for (int32_t first = 0; first < foveation->graph.edge_count; first += EDGES) {
    const int32_t left = foveation->graph.edge_count - first, count = left < EDGES ? left : EDGES;
    gather(foveation, cells, first, count, &e);
    find_exponents(frame, count, &e);
    weigh(params, count, &e);
    encode(linear, e.weight, count, e.capacity);
    encode(linear, e.intensity_weight, count, e.intensity_capacity);
    scatter(&foveation->graph, first, count, &e, affinity);
  }
}
