// SPDX-License-Identifier: Apache-2.0
// Counts through the words of each frame: which are matched, where rows and the frame end.
//
// Matched are x in D-1+r .. W-1-r and y in r .. H-1-r. A frame starts to leave when the framer says so (`begin_*_i`);
// from then on one position a clock follows by itself.
//
// Latency: 3 clocks from `begin_valid_i` to `valid_o`.

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
  output logic            go_o,  // room for the beginning of a further frame

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
  localparam int unsigned NumPending = 4;

  // Frames that may leave. The framer is stopped one short of full; the one that is on its way still fits.
  logic [NumPending-1:0][ColW-1:0] pending_last_col_q;
  logic [NumPending-1:0][RowW-1:0] pending_last_row_q;
  logic [NumPending-1:0]           pending_narrow_q;
  logic [1:0] pending_write_q, pending_read_q;
  logic [2:0] pending_q;
  logic open, frame_end;

  always_ff @(posedge clk_i) begin
    if (begin_valid_i) begin
      pending_last_col_q[pending_write_q] <= begin_last_col_i;
      pending_last_row_q[pending_write_q] <= begin_last_row_i;
      pending_narrow_q[pending_write_q]   <= begin_narrow_i;
      pending_write_q                     <= pending_write_q + 1'b1;
    end
    if (open) pending_read_q <= pending_read_q + 1'b1;
    pending_q <= pending_q + 3'(begin_valid_i) - 3'(open);
    go_o      <= 32'(pending_q) < NumPending - 1;
    if (!rst_ni) begin
      pending_write_q <= '0;
      pending_read_q  <= '0;
      pending_q       <= '0;
      go_o            <= 1'b0;
    end
  end

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
  logic step;
  logic [ColW-1:0] next_x;

  assign open = (pending_q != '0) & (~busy_q | frame_end);

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
    last_row_q         <= (y_q == last_y_q);
    before_match_row_q <= (32'(y_q) == Radius - 1);
    last_match_row_q   <= (y_q == match_last_y_q);
    if (frame_end) busy_q <= 1'b0;
    if (open) begin
      busy_q         <= 1'b1;
      first_q        <= 1'b1;
      narrow_q       <= pending_narrow_q[pending_read_q];
      x_q            <= '0;
      y_q            <= '0;
      row_end_q      <= 1'b0;
      before_match_q <= 1'b0;
      last_match_q   <= 1'b0;
      row_q          <= 1'b0;
      matched_q      <= 1'b0;
      last_x_q       <= pending_last_col_q[pending_read_q];
      last_y_q       <= pending_last_row_q[pending_read_q];
      match_last_x_q <= pending_last_col_q[pending_read_q] - ColW'(Radius);
      match_last_y_q <= pending_last_row_q[pending_read_q] - RowW'(Radius);
      matchable_q    <= (32'(pending_last_col_q[pending_read_q]) >= FirstX + Radius) &
          (32'(pending_last_row_q[pending_read_q]) >= 2 * Radius);
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
