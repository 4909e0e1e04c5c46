// SPDX-License-Identifier: Apache-2.0
// Lays out the words of each frame: results where a pixel is matched, invalid words everywhere else.
//
// A frame starts to leave when the framer says so (`begin_*_i`). From then on the words of the border follow by
// themselves, so the last rows of a frame need no further input. Positions are counted ahead of the words, so that what
// holds a word back does not reach the counters in the same clock.
//
// Latency: 1 clock from a result to `valid_o`; 5 clocks from `begin_valid_i` to the first word.

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

  input  logic            begin_valid_i,
  input  logic [ColW-1:0] begin_last_col_i,
  input  logic [RowW-1:0] begin_last_row_i,
  input  logic            begin_narrow_i,
  output logic            go_o,  // room for the beginning of a further frame

  input  logic                         result_valid_i,
  output logic                         result_ready_o,
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
  output logic             frame_end_o  // the last word of a frame was handed over to `valid_o`
);

  import vista_stereo_pkg::*;

  logic counted_valid, counted_ready, counted_sof, counted_eol, counted_last, counted_narrow, counted_complete;
  logic counted_matched;
  logic place_valid, sof, eol, last, narrow, complete, matched;
  logic free, step;

  vista_frame_positions #(
    .NumDisparities (NumDisparities),
    .BlockSize (BlockSize),
    .MaxWidth (MaxWidth)
  ) u_positions (
    .clk_i,
    .rst_ni,
    .begin_valid_i,
    .begin_last_col_i,
    .begin_last_row_i,
    .begin_narrow_i,
    .go_o,
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
  assign step           = place_valid & free & (~matched | result_valid_i);
  assign result_ready_o = place_valid & free & matched;

  always_ff @(posedge clk_i) begin
    if (free) begin
      valid_o     <= step;
      sof_o       <= sof;
      eol_o       <= eol;
      narrow_o    <= narrow;
      complete_o  <= complete;
      disparity_o <= matched ? result_disparity_i : DisparityW'(Invalid);
      smin_o      <= matched ? result_smin_i : '1;
    end
    frame_end_o <= step & last;

    if (!rst_ni) begin
      valid_o     <= 1'b0;
      frame_end_o <= 1'b0;
    end
  end

`ifdef VISTA_ASSERT
  `include "vista_frame_writer_properties.svh"
`endif

endmodule
