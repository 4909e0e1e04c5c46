#include "vista/engine.h"

static const struct {
  const char *name, *text;
} statuses[] = {
    [VISTA_ENGINE_OK] = {"VISTA_ENGINE_OK", "no error"},
    [VISTA_ENGINE_ERROR_ARGUMENT] = {"VISTA_ENGINE_ERROR_ARGUMENT", "a required pointer is null"},
    [VISTA_ENGINE_ERROR_DISPARITIES] = {"VISTA_ENGINE_ERROR_DISPARITIES",
                                        "num_disparities must be a multiple of 16 from 16 to 256"},
    [VISTA_ENGINE_ERROR_BLOCK] = {"VISTA_ENGINE_ERROR_BLOCK", "block_size must be odd, from 5 to 21"},
    [VISTA_ENGINE_ERROR_PREFILTER] = {"VISTA_ENGINE_ERROR_PREFILTER", "prefilter must be none or xsobel"},
    [VISTA_ENGINE_ERROR_CAP] = {"VISTA_ENGINE_ERROR_CAP", "prefilter_cap must be from 1 to 63"},
    [VISTA_ENGINE_ERROR_TEXTURE] = {"VISTA_ENGINE_ERROR_TEXTURE", "texture_threshold must not be negative"},
    [VISTA_ENGINE_ERROR_UNIQUENESS] = {"VISTA_ENGINE_ERROR_UNIQUENESS", "uniqueness_ratio must be from 0 to 100"},
    [VISTA_ENGINE_ERROR_LR] = {"VISTA_ENGINE_ERROR_LR", "lr_max_diff must be off (-1) or not negative"},
    [VISTA_ENGINE_ERROR_ISA] = {"VISTA_ENGINE_ERROR_ISA", "this machine does not have the instruction set asked for"},
    [VISTA_ENGINE_ERROR_SIZE] = {"VISTA_ENGINE_ERROR_SIZE", "width and height must be from 1 to 16384"},
    [VISTA_ENGINE_ERROR_STRIDE] = {"VISTA_ENGINE_ERROR_STRIDE", "a stride is smaller than the width"},
    [VISTA_ENGINE_ERROR_ROWS] = {"VISTA_ENGINE_ERROR_ROWS", "the rows asked for lie outside the image"},
    [VISTA_ENGINE_ERROR_SCRATCH] = {"VISTA_ENGINE_ERROR_SCRATCH", "scratch is too small or not aligned to 64 bytes"},
    [VISTA_ENGINE_ERROR_OVERLAP] = {"VISTA_ENGINE_ERROR_OVERLAP", "the image to write overlaps the one to read"},
};

static int known(vista_engine_status status) { return (unsigned)status < sizeof statuses / sizeof statuses[0]; }

const char *vista_engine_status_name(vista_engine_status status) {
  return known(status) ? statuses[status].name : "VISTA_ENGINE_UNKNOWN";
}

const char *vista_engine_status_text(vista_engine_status status) {
  return known(status) ? statuses[status].text : "unknown status";
}
