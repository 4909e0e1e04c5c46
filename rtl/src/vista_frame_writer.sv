// SPDX-License-Identifier: Apache-2.0
// Lays out the words of each frame: results where a pixel is matched, invalid words everywhere else.
//
// A frame starts to leave with its beginning, which comes before its results. From then on the words of the border follow
// by themselves, so the last rows of a frame need no further input. Positions are counted ahead of the words, so that what
// holds a word back does not reach the counters in the same clock.
//
// A bit that is upset somewhere may lose a result or make one too many. So a pixel without a result is invalid if the next
// frame waits already, and a result that no frame has room for is dropped: the next frame has its own again. Both are told.
//
// Latency: 1 clock from a result to `valid_o`; 4 clocks from a beginning to the first word.

module vista_frame_writer #(
  parameter int unsigned NumDisparities = 32,
  parameter int unsigned BlockSize = 11,
  parameter int unsigned MaxWidth = 1024,
  localparam int unsigned ColW = $clog2(MaxWidth),
  localparam int unsigned RowW = vista_stereo_pkg::HeightW,
  localparam int unsigned DisparityW = vista_stereo_pkg::DisparityW,
  localparam int unsigned SminW = vista_stereo_pkg::SminW
) (
  input  logic clk_i,
  input  logic rst_ni,

  input  logic                         queued_valid_i,
  output logic                         queued_ready_o,
  input  logic                         queued_begin_i,      // the beginning of a frame, else a result
  input  logic [ColW-1:0]              begin_last_col_i,
  input  logic [RowW-1:0]              begin_last_row_i,
  input  logic                         begin_narrow_i,
  input  logic signed [DisparityW-1:0] result_disparity_i,
  input  logic [SminW-1:0]             result_smin_i,

  output logic             valid_o,
  input  logic             ready_i,
  output logic             sof_o,
  output logic             eol_o,
  output logic             narrow_o,
  output logic             complete_o,    // a word of the frame's format
  output logic signed [DisparityW-1:0] disparity_o,
  output logic [SminW-1:0] smin_o,
  output logic             frame_end_o,  // the last word of a frame was handed over to `valid_o`
  output logic             upset_o       // a frame has too few results or too many
);

  import vista_stereo_pkg::*;

  logic counted_valid, counted_ready, counted_sof, counted_eol, counted_last, counted_narrow, counted_complete;
  logic counted_matched;
  logic place_valid, sof, eol, last, narrow, complete, matched;
  logic free, step, waiting_begin, waiting_result, positions_idle, missing, stray;

  assign waiting_begin  = queued_valid_i & queued_begin_i;
  assign waiting_result = queued_valid_i & ~queued_begin_i;

  vista_frame_positions #(
    .NumDisparities (NumDisparities),
    .BlockSize (BlockSize),
    .MaxWidth (MaxWidth)
  ) u_positions (
    .clk_i,
    .rst_ni,
    .begin_valid_i (waiting_begin),
    .begin_last_col_i,
    .begin_last_row_i,
    .begin_narrow_i,
    .idle_o    (positions_idle),
    .valid_o   (counted_valid),
    .ready_i   (counted_ready),
    .sof_o     (counted_sof),
    .eol_o     (counted_eol),
    .last_o    (counted_last),
    .narrow_o  (counted_narrow),
    .complete_o(counted_complete),
    .matched_o (counted_matched)
  );

  vista_skid #(
    .Width(6)
  ) u_place_skid (
    .clk_i,
    .rst_ni,
    .valid_i (counted_valid),
    .ready_o (counted_ready),
    .data_i  ({counted_sof, counted_eol, counted_last, counted_narrow, counted_complete, counted_matched}),
    .valid_o (place_valid),
    .ready_i (step),
    .data_o  ({sof, eol, last, narrow, complete, matched})
  );

  assign free           = ~valid_o | ready_i;
  assign step           = place_valid & free & (~matched | queued_valid_i);
  assign missing        = place_valid & matched & waiting_begin;
  assign stray          = waiting_result & positions_idle & ~place_valid;
  assign queued_ready_o = (place_valid & free & (queued_begin_i ? sof : matched)) | stray;

  always_ff @(posedge clk_i) begin
    if (free) begin
      valid_o     <= step;
      sof_o       <= sof;
      eol_o       <= eol;
      narrow_o    <= narrow;
      complete_o  <= complete;
      disparity_o <= (matched & ~queued_begin_i) ? result_disparity_i : DisparityW'(Invalid);
      smin_o      <= (matched & ~queued_begin_i) ? result_smin_i : '1;
    end
    frame_end_o <= step & last;
    upset_o     <= missing | stray;

    if (!rst_ni) begin
      valid_o     <= 1'b0;
      frame_end_o <= 1'b0;
      upset_o     <= 1'b0;
    end
  end

`ifdef VISTA_ASSERT
  `include "vista_frame_writer_properties.svh"
`endif

endmodule
