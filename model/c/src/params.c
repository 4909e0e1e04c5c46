#include "vista/engine.h"

#include "rows.h"

vista_engine_params vista_engine_defaults(void) {
  return (vista_engine_params){
      .num_disparities = 32,
      .block_size = 11,
      .prefilter = VISTA_ENGINE_PREFILTER_XSOBEL,
      .prefilter_cap = 31,
      .texture_threshold = 10,
      .uniqueness_ratio = 15,
      .lr_max_diff = 1,
      .isa = VISTA_ENGINE_ISA_AUTO,
  };
}

vista_engine_status vista_engine_validate(const vista_engine_params *params) {
  if (!params) return VISTA_ENGINE_ERROR_ARGUMENT;
  const int32_t D = params->num_disparities, block = params->block_size;
  if (D < 16 || D > VISTA_ENGINE_MAX_DISPARITIES || D % 16 != 0) return VISTA_ENGINE_ERROR_DISPARITIES;
  if (block < 5 || block > VISTA_ENGINE_MAX_BLOCK_SIZE || block % 2 == 0) return VISTA_ENGINE_ERROR_BLOCK;
  if (params->prefilter != VISTA_ENGINE_PREFILTER_NONE && params->prefilter != VISTA_ENGINE_PREFILTER_XSOBEL)
    return VISTA_ENGINE_ERROR_PREFILTER;
  if (params->prefilter_cap < 1 || params->prefilter_cap > VISTA_ENGINE_MAX_PREFILTER_CAP)
    return VISTA_ENGINE_ERROR_CAP;
  if (params->texture_threshold < 0) return VISTA_ENGINE_ERROR_TEXTURE;
  if (params->uniqueness_ratio < 0 || params->uniqueness_ratio > 100) return VISTA_ENGINE_ERROR_UNIQUENESS;
  if (params->lr_max_diff < VISTA_ENGINE_LR_OFF) return VISTA_ENGINE_ERROR_LR;
  if (!vista_engine_isa_available((vista_engine_isa)params->isa)) return VISTA_ENGINE_ERROR_ISA;
  return VISTA_ENGINE_OK;
}

vista_engine_isa vista_engine_isa_best(void) {
#if defined(VISTA_ROWS_NEON)
  return VISTA_ENGINE_ISA_NEON;
#elif defined(VISTA_ROWS_X86)
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl"))
    return VISTA_ENGINE_ISA_AVX512;
  if (__builtin_cpu_supports("avx2")) return VISTA_ENGINE_ISA_AVX2;
#endif
  return VISTA_ENGINE_ISA_PORTABLE;
}

int vista_engine_isa_available(vista_engine_isa isa) {
  const vista_engine_isa best = vista_engine_isa_best();
  if (isa == VISTA_ENGINE_ISA_AUTO || isa == VISTA_ENGINE_ISA_PORTABLE || isa == best) return 1;
  return isa == VISTA_ENGINE_ISA_AVX2 && best == VISTA_ENGINE_ISA_AVX512;
}

const vista_row_code *vista_row_code_of(vista_engine_isa isa) {
  const vista_engine_isa taken = isa == VISTA_ENGINE_ISA_AUTO ? vista_engine_isa_best() : isa;
#ifdef VISTA_ROWS_NEON
  if (taken == VISTA_ENGINE_ISA_NEON) return &vista_rows_neon;
#endif
#ifdef VISTA_ROWS_X86
  if (taken == VISTA_ENGINE_ISA_AVX512) return &vista_rows_avx512;
  if (taken == VISTA_ENGINE_ISA_AVX2) return &vista_rows_avx2;
#endif
  (void)taken;
  return &vista_rows_portable;
}
