/* One image row at a time: what the band driver (engine.c) hands to the code of each instruction set.
 *
 * Costs lie with the disparity innermost: a vector holds neighbouring d of one pixel. The sums of the block then
 * advance along x and y by plain vector additions without shuffles, and winner, uniqueness and the right image's
 * winner come out of the registers that hold S(x, y, .). To make r(x-d) contiguous in d, right rows are kept
 * mirrored: pixel x at index width-1-x. */
#ifndef VISTA_ENGINE_ROWS_H
#define VISTA_ENGINE_ROWS_H

#include <stdint.h>

#include "vista/engine.h"

/* Costs of a pixel are padded to multiples of it, whole vectors of every instruction set; only D 16 takes half. */
#define VISTA_ROWS_LANES 32
#define VISTA_ROWS_PAD 256 /* items that may be read or written past either end of a row buffer */

/* S fits 16 bits for every x-Sobel setting (441 * 2 * 63 = 55566); without prefilter up to block 15 (225 * 255). */
#define VISTA_ROWS_MAX_NARROW_BLOCK 15

typedef struct vista_winner_row { /* indexed by x, valid for the matched x of the row */
  uint32_t *cost;                 /* Smin */
  uint32_t *around;               /* S(dL-1), S(dL+1) at 2x, 2x+1; anything at the ends of the range */
  uint8_t *unique;                /* 1 when the pixel passes step 5, else 0 */
  uint8_t *best;                  /* dL */
  uint8_t *right_best;            /* dR by right x; only with `check` */
  uint8_t *rival;                 /* the d of step 8; NULL when it is not wanted */
  uint32_t *rival_cost;           /* its S */
} vista_winner_row;

typedef struct vista_match_job {
  int32_t width, num_disparities, lanes, block_size; /* lanes: costs of a pixel with their padding */
  int32_t uniqueness_ratio;
  int32_t check;      /* right_best wanted */
  int32_t full_range; /* pixels use 0..255 (no prefilter), not 0..126 */
  int32_t wide;       /* costs need 32 bits */
  const uint8_t *left_in, *left_out;   /* the rows entering and leaving the block; all zero: nothing leaves */
  const uint8_t *right_in, *right_out; /* mirrored */
  uint16_t *columns;                   /* [width][lanes] column sums of the block, updated */
  uint32_t *work;                      /* VISTA_ROWS_PAD * 2 + width items for each of four arrays */
  vista_winner_row winner;
} vista_match_job;

typedef struct vista_finish_job {
  int32_t first, end; /* the matched x */
  int32_t num_disparities, texture_threshold;
  int32_t lr_max_diff; /* < 0: off */
  vista_winner_row winner;
  const uint16_t *texture; /* by x; anything when the threshold is 0 and no confidence is wanted */
  uint8_t *valid;          /* work, by x */
  int16_t *disparity;
  uint16_t *confidence; /* NULL when it is not wanted */
} vista_finish_job;

typedef struct vista_row_code {
  /* Smoothing: one row from the rows above, at and below it. */
  void (*smooth)(const uint8_t *const rows[3], int32_t width, uint8_t *out);
  /* Pyramid: one row of (width + 1) / 2 pixels from the five rows around it. */
  void (*reduce)(const uint8_t *const rows[5], int32_t width, uint8_t *out);
  /* Step 1: one row of clamp([1 2 1]^T * [-1 0 1], -cap, cap) + cap; the first and last column are cap. */
  void (*xsobel)(const uint8_t *above, const uint8_t *row, const uint8_t *below, int32_t width, int32_t cap,
                 uint8_t *out);
  /* Right rows by rising d. */
  void (*mirror)(const uint8_t *row, int32_t width, uint8_t *out);
  /* Step 4: moves the texture's column sums down a row, then adds block_size of them up, by x. */
  void (*texture_columns)(const uint8_t *in, const uint8_t *out, int32_t width, int32_t cap, uint16_t *columns);
  void (*texture_sums)(const uint16_t *columns, int32_t width, int32_t block_size, uint16_t *sums);
  /* Step 2 for a row that enters while the block is not complete yet. */
  void (*add_row)(const vista_match_job *job);
  /* Steps 2, 3, 5, 6: the row enters, another leaves, and every matched x gets its winner, and its rival if wanted. */
  void (*match)(const vista_match_job *job);
  /* Steps 4, 6, 7, 8: verdicts, words and confidence of the matched x. */
  void (*finish)(const vista_finish_job *job);
} vista_row_code;

/* The code of an instruction set that this machine has. */
const vista_row_code *vista_row_code_of(vista_engine_isa isa);

extern const vista_row_code vista_rows_portable;
void vista_match_16(const vista_match_job *job); /* `match` in vectors for 16 lanes, costs of 16 bits */
#if defined(__aarch64__) && defined(__ARM_NEON) && defined(__GNUC__) && __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__
#define VISTA_ROWS_NEON 1
extern const vista_row_code vista_rows_neon;
#endif
#if defined(__x86_64__) && defined(__GNUC__)
#define VISTA_ROWS_X86 1
extern const vista_row_code vista_rows_avx2;
extern const vista_row_code vista_rows_avx512;
#endif

#endif
