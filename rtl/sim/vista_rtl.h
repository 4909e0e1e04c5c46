// SPDX-License-Identifier: Apache-2.0
/* The Verilated engine behind a plain C interface: clock, registers, streams, and whole frames as a product's driver
 * would run them. One shared library per set of build parameters: `make rtl-engine D=32 B=11 W=1024`.
 *
 * A handle is one engine with its own clock; use it from one thread at a time.
 */
#ifndef VISTA_RTL_H
#define VISTA_RTL_H

#include <stdint.h>

typedef struct vista_rtl vista_rtl;

/* Build parameters, as the engine's own registers tell them. */
typedef struct vista_rtl_build {
  uint32_t num_disparities;
  uint32_t block_size;   /* px */
  uint32_t max_width_px;
  uint32_t max_height_px;
  uint32_t rectify_rows;  /* line buffer of rectification; 0: the core alone, without front end */
  uint32_t map_points;    /* control points of a camera that there is memory for */
} vista_rtl_build;

/* Run-time parameters of the contract (doc/design/engine-contract.md). The last three need a front end. */
typedef struct vista_rtl_settings {
  uint32_t xsobel;            /* 1: x-Sobel, 0: plain grey values */
  uint32_t prefilter_cap;     /* 1 .. 63 */
  uint32_t texture_threshold; /* 0: off; the register holds 65535, more than any sum: larger ones are set to that */
  uint32_t uniqueness_ratio;  /* 0 .. 100 percent */
  int32_t lr_max_diff;        /* -1: off; the register holds 255, the largest difference: likewise */
  uint32_t smooth;            /* 1: both images of each level are smoothed before they are matched */
  uint32_t levels;            /* 1 .. 4 */
  uint32_t rectify;           /* 1: by the map that was loaded */
} vista_rtl_settings;

/* Out of reset, disabled. Every bit that reset leaves alone, memories included, starts at random by `seed`. */
vista_rtl* vista_rtl_create(uint32_t seed);
void vista_rtl_destroy(vista_rtl* engine);
void vista_rtl_reset(vista_rtl* engine, int32_t clocks);

/* One AXI4-Lite access; addresses as in rtl/csr/registers.md. */
void vista_rtl_write(vista_rtl* engine, uint32_t address, uint32_t data);
uint32_t vista_rtl_read(vista_rtl* engine, uint32_t address);

/* The response to the last of these accesses: 0, or 2 (SLVERR) if there is no register. */
int32_t vista_rtl_response(const vista_rtl* engine);

/* The interrupt, 0 or 1. */
int32_t vista_rtl_interrupt(const vista_rtl* engine);

/* Offers num_in beats {last, user, data[15:0]} and takes max_out words, data and flags {last, user}. in_pace, out_pace:
 * chances in 1/1000 per clock {to stop, to go on} of a side that runs and pauses in bursts. Ends when both are done,
 * nothing was transferred for `quiet` clocks, or `max_clocks` have passed. Returns the number of words; in_clock[i] and
 * out_clock[i] are the clocks of the transfers (may be null), *num_taken the beats taken. */
int64_t vista_rtl_stream(vista_rtl* engine, const uint32_t* beats, int64_t num_in, const uint32_t* in_pace,
                         const uint32_t* out_pace, uint64_t seed, int64_t max_out, int64_t quiet, int64_t max_clocks,
                         uint32_t* out_data, uint8_t* out_flags, int64_t* in_clock, int64_t* out_clock,
                         int64_t* num_taken);

/* Queues one write to be made while a later vista_rtl_stream runs: begun once `after` beats of that call were taken, and
 * finished before its beat `before` is offered. Writes are made in the order in which they were queued. */
void vista_rtl_queue_write(vista_rtl* engine, int64_t after, int64_t before, uint32_t address, uint32_t data);

/* Build parameters; 0 if the registers do not answer as a VISTA engine of the major version of
 * rtl/csr/vista_stereo_csr.h, else 1. */
int32_t vista_rtl_identify(vista_rtl* engine, vista_rtl_build* build);

/* Loads a map of rectification for frames of this size: the control points of both cameras row by row, {dx, dy} in
 * 1/32 px. It is in force for every frame from then on, also after a reset by vista_rtl_compute. Returns 0, or the bits of
 * ERRORS that tell why it was refused; the map before it then stays. */
uint32_t vista_rtl_load_map(vista_rtl* engine, const int16_t* left, const int16_t* right, int32_t width,
                            int32_t height);

/* One frame: writes the registers, streams the pair in and the words out at a pixel a clock. Images are `height` rows of
 * `width` pixels without gaps; `disparity` receives the words of all levels in 1/16 px, -16: none, level 0 first and each
 * without gaps, of (width + 1) / 2 x (height + 1) / 2 pixels and so on. Returns the clocks from the first pixel to the
 * last word, or -1 when words are missing, the engine reports an error, or the build has no front end for the settings;
 * it is then reset, and the next frame is clean. */
int64_t vista_rtl_compute(vista_rtl* engine, const vista_rtl_settings* settings, const uint8_t* left,
                          const uint8_t* right, int32_t width, int32_t height, int16_t* disparity);

/* 1 once an assertion has failed, else 0; stderr tells which. What comes then is worth nothing. */
int32_t vista_rtl_failed(const vista_rtl* engine);

/* From now on all inputs and outputs but those of the pyramid's buffer are written to a file, a line a clock, for
 * tb/icarus/replay.v; null ends it. Returns 1, or 0 when the file cannot be opened. */
int32_t vista_rtl_record(vista_rtl* engine, const char* path);

/* Of the builds that the benches make (tb/common/verilated.py); nothing happens in others. */
void vista_rtl_select_mutant(vista_rtl* engine, uint32_t number);
/* Cell `number`, a register (one entry) or a memory: its name, cut to fit, and {entries, bits of one}. Returns 0 when there
 * are not so many cells. */
int32_t vista_rtl_cell(vista_rtl* engine, uint32_t number, char* name, int32_t size, uint32_t* shape);

/* Clocks since the engine was made, as in_clock and out_clock count. */
int64_t vista_rtl_clock(const vista_rtl* engine);

/* Turns a bit of a cell over after so many clocks from now. */
void vista_rtl_upset(vista_rtl* engine, uint32_t cell, uint32_t entry, uint32_t bit, int64_t clocks);

void vista_rtl_write_coverage(vista_rtl* engine, const char* path);

#endif
