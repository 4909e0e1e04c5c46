/* The stereo engine of doc/design/engine-contract.md, to the bit: two rectified 8-bit images in, one disparity word
 * per pixel out.
 *
 * No allocation, no global state; every call works on memory that the caller hands over, so any number of calls may
 * run at once on scratch of their own. Images are row-major, strides count items from one row to the next.
 * Steps named in comments are those of the contract. */
#ifndef VISTA_ENGINE_H
#define VISTA_ENGINE_H

#include <stddef.h>
#include <stdint.h>

#include "vista/api.h"
#include "vista/word.h" /* VISTA_DISPARITY_SCALE, VISTA_DISPARITY_INVALID */

#define VISTA_ENGINE_MAX_DISPARITIES 256
#define VISTA_ENGINE_MAX_BLOCK_SIZE 21
#define VISTA_ENGINE_MAX_PREFILTER_CAP 63
#define VISTA_ENGINE_MAX_SIDE_PX 16384     /* largest width and height */
#define VISTA_ENGINE_MAX_THREADS 256
#define VISTA_ENGINE_LR_OFF (-1)
#define VISTA_ENGINE_NO_COST 4294967295u   /* Smin of a pixel that is not matched */
#define VISTA_ENGINE_NO_CONFIDENCE 65535u  /* confidence of a pixel that is not matched */

VISTA_BEGIN

/* The result of a function that can fail. */
typedef enum vista_engine_status {
  VISTA_ENGINE_OK = 0,
  VISTA_ENGINE_ERROR_ARGUMENT,    /* a required pointer is null */
  VISTA_ENGINE_ERROR_DISPARITIES, /* num_disparities is not one of 16, 32 .. 256 */
  VISTA_ENGINE_ERROR_BLOCK,       /* block_size is not one of 5, 7 .. 21 */
  VISTA_ENGINE_ERROR_PREFILTER,   /* unknown prefilter */
  VISTA_ENGINE_ERROR_CAP,         /* prefilter_cap outside 1..63 */
  VISTA_ENGINE_ERROR_TEXTURE,     /* texture_threshold below 0 */
  VISTA_ENGINE_ERROR_UNIQUENESS,  /* uniqueness_ratio outside 0..100 */
  VISTA_ENGINE_ERROR_LR,          /* lr_max_diff below VISTA_ENGINE_LR_OFF */
  VISTA_ENGINE_ERROR_ISA,         /* unknown instruction set, or one that this machine lacks */
  VISTA_ENGINE_ERROR_SIZE,        /* width or height outside 1..VISTA_ENGINE_MAX_SIDE_PX */
  VISTA_ENGINE_ERROR_STRIDE,      /* a stride is smaller than the width */
  VISTA_ENGINE_ERROR_ROWS,        /* rows outside 0 <= first <= end <= height */
  VISTA_ENGINE_ERROR_SCRATCH,     /* scratch too small or not aligned to 64 bytes */
  VISTA_ENGINE_ERROR_OVERLAP      /* the image to write overlaps the one to read */
} vista_engine_status;

/* The filter before matching (step 1). */
typedef enum vista_engine_prefilter {
  VISTA_ENGINE_PREFILTER_NONE = 0,
  VISTA_ENGINE_PREFILTER_XSOBEL = 1
} vista_engine_prefilter;

/* The instruction set of the code. Each gives the same words; AUTO takes the fastest that the machine has. */
typedef enum vista_engine_isa {
  VISTA_ENGINE_ISA_AUTO = 0,
  VISTA_ENGINE_ISA_PORTABLE,
  VISTA_ENGINE_ISA_AVX2,
  VISTA_ENGINE_ISA_AVX512,
  VISTA_ENGINE_ISA_NEON /* of AArch64 */
} vista_engine_isa;

/* The parameters of the contract. */
typedef struct vista_engine_params {
  int32_t num_disparities;   /* D: 16, 32 .. 256, candidates 0 .. D-1 px */
  int32_t block_size;        /* odd, 5 .. 21 px */
  int32_t prefilter;         /* vista_engine_prefilter */
  int32_t prefilter_cap;     /* c: 1 .. 63 grey values */
  int32_t texture_threshold; /* 0 .. , summed grey values */
  int32_t uniqueness_ratio;  /* u: 0 (off) .. 100 percent */
  int32_t lr_max_diff;       /* VISTA_ENGINE_LR_OFF, or 0 .. px */
  int32_t isa;               /* vista_engine_isa */
} vista_engine_params;

/* A rectified pair. */
typedef struct vista_engine_images {
  const uint8_t *left, *right;
  int32_t width, height; /* px, of both */
  ptrdiff_t left_stride, right_stride;
} vista_engine_images;

/* Every word of the rows asked for is written: the disparity in 1/16 px, VISTA_DISPARITY_INVALID where there is none.
 * smin may be NULL; it is the smallest cost of every matched pixel, valid or not, VISTA_ENGINE_NO_COST elsewhere.
 * confidence may be NULL; it is that of step 8 of every matched pixel, valid or not, VISTA_ENGINE_NO_CONFIDENCE
 * elsewhere, and takes time only when it is asked for. */
typedef struct vista_engine_output {
  int16_t *disparity;
  uint32_t *smin;
  ptrdiff_t disparity_stride, smin_stride;
  uint16_t *confidence;
  ptrdiff_t confidence_stride;
} vista_engine_output;

/* The defaults: 32 disparities, block 11, x-Sobel, cap 31, texture 10, uniqueness 15, left/right check 1, ISA auto. */
VISTA_API vista_engine_params vista_engine_defaults(void);

/* Checks every parameter against its range. */
VISTA_API vista_engine_status vista_engine_validate(const vista_engine_params *params);

/* The name of a status, such as "VISTA_ENGINE_ERROR_BLOCK"; never null. */
VISTA_API const char *vista_engine_status_name(vista_engine_status status);

/* A status as one line of text; never null. */
VISTA_API const char *vista_engine_status_text(vista_engine_status status);

/* Returns 1 when this build and this machine can run the instruction set, else 0. AUTO and PORTABLE always run. */
VISTA_API int vista_engine_isa_available(vista_engine_isa isa);

/* The instruction set that AUTO stands for on this machine. */
VISTA_API vista_engine_isa vista_engine_isa_best(void);

/* The bytes of scratch for `threads` bands at once; each band takes an equal part, aligned to 64 bytes.
 * Returns 0 when the parameters, the size or the number of threads are out of range. */
VISTA_API size_t vista_engine_scratch_bytes(const vista_engine_params *params, int32_t width, int32_t height,
                                            int32_t threads);

/* Computes the whole image on the calling thread. It needs the scratch of one thread. */
VISTA_API vista_engine_status vista_engine_compute(const vista_engine_params *params, const vista_engine_images *images,
                                                   const vista_engine_output *output, void *scratch,
                                                   size_t scratch_bytes);

/* Computes the rows first_row .. end_row-1 of the output; the images are read beyond them by block_size/2 + 1 rows.
 * Bands with scratch and rows of their own may run on different threads; together they give the words of
 * vista_engine_compute. */
VISTA_API vista_engine_status vista_engine_compute_rows(const vista_engine_params *params,
                                                        const vista_engine_images *images,
                                                        const vista_engine_output *output, int32_t first_row,
                                                        int32_t end_row, void *scratch, size_t scratch_bytes);

VISTA_END

#endif
