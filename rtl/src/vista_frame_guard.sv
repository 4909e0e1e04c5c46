// SPDX-License-Identifier: Apache-2.0
// Lets whole frames pass, and what is left of broken ones in a form that shows where they end.
//
// A sound frame passes as it came. A frame whose structure breaks (early or missing end of line, early start of frame)
// ends with the pixel after which it broke, which leaves with an end of line in the wrong place, or without one in the
// last column; one that breaks within its first three pixels is filled up to three. So a follower that watches the ends
// of lines knows at once that no more comes of this frame. The rest is dropped up to the next start of frame.
//
// Latency: 2 clocks, and a pixel waits for the one that comes next in its frame.

module vista_frame_guard #(
  parameter int unsigned MaxWidth = 1024,
  parameter int unsigned SideWidth = 1,
  localparam int unsigned ColW = $clog2(MaxWidth),
  localparam int unsigned RowW = vista_stereo_pkg::HeightW,
  localparam int unsigned DataW = 2 * vista_stereo_pkg::PixelW
) (
  input  logic clk_i,
  input  logic rst_ni,

  // A frame has what is set in the clock in which its first pixel is first offered.
  input  logic                 enable_i,
  input  logic [ColW:0]        width_i,
  input  logic [RowW-1:0]      height_i,
  input  logic [SideWidth-1:0] side_i,  // whatever else belongs to the frame

  input  logic             valid_i,
  output logic             ready_o,
  input  logic             sof_i,
  input  logic             eol_i,
  input  logic [DataW-1:0] data_i,

  output logic             valid_o,
  input  logic             ready_i,
  output logic             sof_o,
  output logic             eol_o,
  output logic [DataW-1:0] data_o,

  // The frame that is leaving: W - 1, H - 1, and what goes along.
  output logic [ColW-1:0]      last_col_o,
  output logic [RowW-1:0]      last_row_o,
  output logic [SideWidth-1:0] side_o,

  // Events, one clock each.
  output logic frame_start_o,
  output logic error_early_eol_o,
  output logic error_late_eol_o,
  output logic error_early_sof_o,
  output logic error_late_sof_o,
  output logic error_size_o
);

  import vista_stereo_pkg::*;

  localparam logic [1:0] Fewest = 2'd3;  // pixels of a frame that breaks

  logic head_valid, head_ready, head_sof, head_eol, head_enable, head_admit;
  logic [DataW-1:0] head;
  logic [ColW-1:0] head_last_col;
  logic [RowW-1:0] head_last_row;
  logic [SideWidth-1:0] head_side;

  vista_frame_input #(
    .MaxWidth  (MaxWidth),
    .SideWidth (SideWidth)
  ) u_input (
    .clk_i,
    .rst_ni,
    .enable_i,
    .width_i,
    .height_i,
    .side_i,
    .valid_i,
    .ready_o,
    .sof_i,
    .eol_i,
    .data_i,
    .valid_o    (head_valid),
    .ready_i    (head_ready),
    .sof_o      (head_sof),
    .eol_o      (head_eol),
    .data_o     (head),
    .enable_o   (head_enable),
    .admit_o    (head_admit),
    .last_col_o (head_last_col),
    .last_row_o (head_last_row),
    .side_o     (head_side),
    .busy_o     ()
  );

  // The frame that is being taken, and its newest pixel, which waits for the next one unless it is the last.
  logic active_q, broken_q, lost_q;  // broken: but not three pixels long yet
  logic            last_col_q;  // col_q is W - 1
  logic [ColW-1:0] col_q;
  logic [RowW-1:0] row_q;
  logic [1:0]      count_q;  // pixels so far, saturating
  logic hold_valid_q, hold_sof_q, hold_eol_q, hold_end_q;
  logic [DataW-1:0] hold_q;
  logic start, take, pad, drop, early_sof, last_row, bad_eol, enough, frame_end, free;

  assign free      = ~hold_valid_q | ready_i;
  assign start     = ~active_q & head_valid & head_sof & head_admit & free;
  assign take      = active_q & ~broken_q & head_valid & ~head_sof & free;
  assign early_sof = active_q & ~broken_q & head_valid & head_sof;
  assign pad       = active_q & broken_q & free;
  assign drop      = ~active_q & head_valid & (~head_sof | ~head_admit);

  assign head_ready = start | take | drop;

  assign last_row = (row_q == last_row_o);
  assign bad_eol  = (start & head_eol) | (take & (head_eol != last_col_q));
  assign enough   = ~start & (count_q >= Fewest - 2'd1);  // with the pixel that is loaded
  assign frame_end = ((take | pad) & enough & (bad_eol | broken_q)) | (take & last_col_q & last_row);

  assign valid_o = hold_valid_q & (hold_end_q | broken_q | (head_valid & (~head_sof | (count_q == Fewest))));
  assign sof_o   = hold_sof_q;
  assign eol_o   = hold_eol_q ^ early_sof;
  assign data_o  = hold_q;

  always_ff @(posedge clk_i) begin
    if (start) begin
      last_col_o <= head_last_col;
      last_row_o <= head_last_row;
      side_o     <= head_side;
    end
    if (start | take | pad) begin
      hold_valid_q <= 1'b1;
      hold_sof_q   <= start;
      hold_eol_q   <= (bad_eol & ~enough) ? 1'b0 : pad ? enough : head_eol;
      hold_end_q   <= frame_end;
      if (!pad) hold_q <= head;
      count_q <= start ? 2'd1 : (count_q == Fewest) ? count_q : count_q + 1'b1;
      col_q   <= start ? ColW'(1) : last_col_q ? '0 : col_q + 1'b1;
      last_col_q <= ~start & (col_q + 1'b1 == last_col_o);
      if (start) row_q <= '0;
      else if (last_col_q) row_q <= row_q + 1'b1;
    end else if (valid_o & ready_i) begin
      hold_valid_q <= 1'b0;
    end

    if (start) active_q <= 1'b1;
    if (start) lost_q <= 1'b0;
    if ((bad_eol & ~enough) | (early_sof & (count_q != Fewest))) broken_q <= 1'b1;
    if (frame_end | (early_sof & (count_q == Fewest) & ready_i)) begin
      active_q <= 1'b0;
      broken_q <= 1'b0;
    end
    // Lost: a start of frame is searched for, and what comes before it is no news.
    if (bad_eol | drop) lost_q <= 1'b1;

    if (!rst_ni) begin
      active_q     <= 1'b0;
      broken_q     <= 1'b0;
      lost_q       <= 1'b1;
      hold_valid_q <= 1'b0;
      hold_end_q   <= 1'b0;
    end
  end

  // An early start of frame waits at the head until the frame before it has ended; it is told of once.
  logic early_sof_q;

  always_ff @(posedge clk_i) begin
    early_sof_q       <= early_sof;
    frame_start_o     <= start;
    error_early_eol_o <= bad_eol & head_eol;
    error_late_eol_o  <= bad_eol & ~head_eol;
    error_early_sof_o <= early_sof & ~early_sof_q;
    error_late_sof_o  <= ~active_q & head_valid & ~head_sof & head_enable & ~lost_q;
    error_size_o      <= ~active_q & head_valid & head_sof & head_enable & ~head_admit;
    if (!rst_ni) begin
      early_sof_q       <= 1'b0;
      frame_start_o     <= 1'b0;
      error_early_eol_o <= 1'b0;
      error_late_eol_o  <= 1'b0;
      error_early_sof_o <= 1'b0;
      error_late_sof_o  <= 1'b0;
      error_size_o      <= 1'b0;
    end
  end

`ifdef VISTA_ASSERT
  `include "vista_frame_guard_properties.svh"
`endif

endmodule
