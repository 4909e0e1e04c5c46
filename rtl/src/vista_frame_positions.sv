// SPDX-License-Identifier: Apache-2.0
// Counts through the words of each frame: which are matched, where rows and the frame end.
//
// Matched are x in D-1+r .. W-1-r and y in r .. H-1-r. A frame that waits begins when the one before it ends; from then
// on one position a clock follows by itself. It has to wait until its first position has left.
//
// Latency: 2 clocks from `begin_valid_i` to `valid_o`.

module vista_frame_positions #(
  parameter int unsigned NumDisparities = 32,
  parameter int unsigned BlockSize = 11,
  parameter int unsigned MaxWidth = 1024,
  localparam int unsigned ColW = $clog2(MaxWidth),
  localparam int unsigned RowW = vista_stereo_pkg::HeightW
) (
  input  logic clk_i,
  input  logic rst_ni,

  input  logic            begin_valid_i,
  input  logic [ColW-1:0] begin_last_col_i,
  input  logic [RowW-1:0] begin_last_row_i,
  input  logic            begin_narrow_i,

  output logic idle_o,  // no frame is leaving
  output logic valid_o,
  input  logic ready_i,
  output logic sof_o,
  output logic eol_o,
  output logic last_o,    // of the frame
  output logic narrow_o,
  output logic complete_o,  // a word of the frame's format
  output logic matched_o
);

  localparam int unsigned Radius = BlockSize / 2;
  localparam int unsigned FirstX = NumDisparities - 1 + Radius;

  // The frame that is leaving.
  logic busy_q, narrow_q;
  logic [ColW-1:0] x_q, last_x_q;
  logic [RowW-1:0] y_q, last_y_q;
  logic [ColW-1:0] match_last_x_q;    // W - 1 - r
  logic [RowW-1:0] match_last_y_q;
  logic            matchable_q;       // there are matched pixels
  logic row_q, matched_q;  // the row has some, the pixel is one
  logic first_q;  // the pixel is the first of the frame
  // Comparisons, made when x_q and y_q are, since they decide about every word: the column is W - 1, the one before
  // the first match, the last match; the row likewise.
  logic row_end_q, before_match_q, last_match_q;
  logic last_row_q, before_match_row_q, last_match_row_q;
  logic open, step, frame_end;
  logic [ColW-1:0] next_x;

  assign open   = begin_valid_i & (~busy_q | frame_end);
  assign idle_o = ~busy_q & ~valid_o;

  assign step      = busy_q & (~valid_o | ready_i);
  assign frame_end = step & row_end_q & last_row_q;
  assign next_x    = x_q + 1'b1;

  always_ff @(posedge clk_i) begin
    if (step) begin
      first_q        <= 1'b0;
      x_q            <= row_end_q ? '0 : next_x;
      row_end_q      <= ~row_end_q & (next_x == last_x_q);
      before_match_q <= ~row_end_q & (32'(next_x) == FirstX - 1);
      last_match_q   <= ~row_end_q & (next_x == match_last_x_q);
      if (row_end_q) begin
        y_q <= y_q + 1'b1;
        if (before_match_row_q) row_q <= matchable_q;
        else if (last_match_row_q) row_q <= 1'b0;
      end
      if (before_match_q) matched_q <= row_q;
      else if (last_match_q) matched_q <= 1'b0;
    end
    // A row has MinWidth columns or more: these are a clock late in the first one, and asked for in the last one.
    last_row_q         <= (y_q >= last_y_q);
    before_match_row_q <= (32'(y_q) == Radius - 1);
    last_match_row_q   <= (y_q == match_last_y_q);
    if (frame_end) busy_q <= 1'b0;
    if (open) begin
      busy_q         <= 1'b1;
      first_q        <= 1'b1;
      narrow_q       <= begin_narrow_i;
      x_q            <= '0;
      y_q            <= '0;
      row_end_q      <= 1'b0;
      before_match_q <= 1'b0;
      last_match_q   <= 1'b0;
      row_q          <= 1'b0;
      matched_q      <= 1'b0;
      last_x_q       <= begin_last_col_i;
      last_y_q       <= begin_last_row_i;
      match_last_x_q <= begin_last_col_i - ColW'(Radius);
      match_last_y_q <= begin_last_row_i - RowW'(Radius);
      matchable_q    <= (32'(begin_last_col_i) >= FirstX + Radius) & (32'(begin_last_row_i) >= 2 * Radius);
    end

    if (~valid_o | ready_i) begin
      valid_o   <= step;
      sof_o     <= first_q;
      eol_o     <= row_end_q;
      last_o    <= row_end_q & last_row_q;
      narrow_o  <= narrow_q;
      complete_o <= ~narrow_q | x_q[0] | row_end_q;
      matched_o <= matched_q;
    end

    if (!rst_ni) begin
      busy_q  <= 1'b0;
      valid_o <= 1'b0;
    end
  end

`ifdef VISTA_ASSERT
  `include "vista_frame_positions_properties.svh"
`endif

endmodule
