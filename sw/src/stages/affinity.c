#include "stages/affinity.h"

#include <math.h>
#include <string.h>

#include "common/depth.h"
#include "common/frame.h"
#include "common/parameters_check.h"

vista_status vista_affinity_layout(vista_affinity *affinity, vista_arena *arena, const vista_foveation *foveation) {
  if (affinity == NULL || arena == NULL || foveation == NULL) return VISTA_ERROR_ARGUMENT;
  const size_t arcs = (size_t)foveation->graph.arc_count;
  affinity->weight = vista_arena_take(arena, arcs, sizeof(float));
  affinity->capacity = vista_arena_take(arena, arcs, sizeof(int32_t));
  affinity->intensity_capacity = vista_arena_take(arena, arcs, sizeof(int32_t));
  return arena->base != NULL && arena->used > arena->size ? VISTA_ERROR_MEMORY : VISTA_OK;
}

/* Exponent of equation 4. */
static float dissimilarity(float difference, float mu, float sigma) {
  const float excess = fmaxf(fabsf(difference), mu) - mu;
  return excess * excess / (2.0f * sigma * sigma);
}

int32_t vista_flow_encode(const vista_affinity_params *params, double affinity) {
  const double flow = params->flow_encoding == VISTA_AFFINITY_FLOW_ENCODING_LINEAR
                          ? params->flow_scale * (affinity + 1.0) / 2.0
                          : params->flow_scale * pow(params->flow_constant, (affinity - 1.0) / 2.0);
  return flow < 1.0 ? 1 : (int32_t)lround(flow);
}

/* The exponential encoding as a power of two, 2^(offset + slope w). */
typedef struct exponential {
  double offset, slope;
} exponential;

/* 2^x within 1e-10 of it, for -1000 < x < 1000: the series of e^(r ln 2) for |r| <= 1/2 times a whole power. */
static double power_of_two(double x) {
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

/* vista_flow_encode without pow(), which is only asked where the fast power might round to the other side. */
static int32_t encode(const vista_affinity_params *params, const exponential *curve, float affinity) {
  if (params->flow_encoding == VISTA_AFFINITY_FLOW_ENCODING_EXPONENTIAL) {
    const double flow = power_of_two(curve->offset + curve->slope * (double)affinity);
    const int32_t rounded = (int32_t)(flow + 0.5);
    if (fabs(flow - rounded) < 0.5 - 1e-4) return rounded < 1 ? 1 : rounded;
  }
  return vista_flow_encode(params, (double)affinity);
}

vista_status vista_affinity_compute(const vista_foveation *foveation, const vista_affinity_params *params,
                                    const vista_camera *camera, const vista_cells *cells, vista_affinity *affinity) {
  if (foveation == NULL || params == NULL || camera == NULL || cells == NULL || affinity == NULL)
    return VISTA_ERROR_ARGUMENT;
  vista_status status = VISTA_CHECK_SECTION(affinity, params);
  if (status == VISTA_OK) status = vista_frame_check_camera(camera);
  if (status != VISTA_OK) return status;
  const vista_graph *const graph = &foveation->graph;
  const float mu_i = (float)params->mu_intensity, sigma_i = (float)params->sigma_intensity;
  const float sigma_d = (float)params->sigma_disparity_px;
  const float alpha = (float)params->alpha_intensity;
  const double doublings = 0.5 * log2(params->flow_constant);
  const exponential curve = {log2(params->flow_scale) - doublings, doublings};
  const int32_t most = vista_flow_encode(params, 1.0);
  for (int32_t i = 0; i < graph->node_count; ++i) {
    for (int32_t arc = graph->first_arc[i]; arc < graph->first_arc[i + 1]; ++arc) {
      const int32_t j = graph->head[arc];
      if (j < i) continue;
      const float exponent_i = dissimilarity(cells->intensity[i] - cells->intensity[j], mu_i, sigma_i);
      const float intensity_weight = exponent_i == 0.0f ? 1.0f : expf(-exponent_i);
      float weight = intensity_weight;
      if (cells->disparity_px[i] >= 0.0f && cells->disparity_px[j] >= 0.0f) {
        const float relief = vista_depth_step_px(camera, fmaxf(cells->disparity_px[i], cells->disparity_px[j]),
                                                 (float)params->mu_depth_m);
        const float mu_d = fmaxf(relief, (float)params->mu_disparity_px +
                                             (float)params->mu_disparity_slope * foveation->arc_distance_px[arc]);
        const float exponent_d = dissimilarity(cells->disparity_px[i] - cells->disparity_px[j], mu_d, sigma_d);
        weight = params->form == VISTA_AFFINITY_FORM_SUM
                     ? alpha * intensity_weight + (1.0f - alpha) * expf(-exponent_d)
                     : (exponent_d == 0.0f ? intensity_weight : expf(-exponent_i - exponent_d));
      }
      const int32_t sister = graph->reverse[arc];
      affinity->weight[arc] = affinity->weight[sister] = weight;
      affinity->capacity[arc] = affinity->capacity[sister] = weight == 1.0f ? most : encode(params, &curve, weight);
      affinity->intensity_capacity[arc] = affinity->intensity_capacity[sister] =
          weight == intensity_weight ? affinity->capacity[arc] : encode(params, &curve, intensity_weight);
    }
  }
  return VISTA_OK;
}
