// SPDX-License-Identifier: Apache-2.0
// Turns the incoming video into slots and checks its framing.
//
// Row n of the raw frame and row n-1 of the frame being matched advance together, since the x-Sobel of a row needs the
// row below it. The last row of a frame has none below: its slots (the *drain*) run by themselves as soon as the frame
// is complete, beside the first row of a following frame, which is only stored. So frames may follow each other without
// a gap, and the last one needs no follower.
//
// Framing errors. A frame is cut where its structure breaks (early or missing end of line, early start of frame): the
// missing pixels are filled in at one a clock, their slots marked `cut`, and the rest of the input is dropped up to the
// next start of frame. Thus every frame that was begun gives all of its W * H words.
//
// Latency: 1 clock from an accepted beat to `slot_o` and `store_*_o`. Counters are as wide as the columns and rows they
// count; W - 1 and H - 1 rather than W and H are kept, so MaxWidth = 2^k needs no further bit.

module vista_framer #(
  parameter int unsigned NumDisparities = 32,
  parameter int unsigned BlockSize = 11,
  parameter int unsigned MaxWidth = 1024,
  localparam int unsigned ColW = $clog2(MaxWidth),
  localparam int unsigned RowW = vista_stereo_pkg::HeightW,
  localparam int unsigned DataW = 2 * vista_stereo_pkg::PixelW
) (
  input  logic clk_i,
  input  logic rst_ni,

  // A pixel, and what its frame is to have if it begins one (vista_frame_input).
  input  logic                      valid_i,
  output logic                      ready_o,
  input  logic                      sof_i,
  input  logic                      eol_i,
  input  logic [DataW-1:0]          data_i,
  input  logic                      enable_i,
  input  logic                      admit_i,     // enabled, and of a size that fits
  input  logic [ColW-1:0]           last_col_i,  // W - 1
  input  logic [RowW-1:0]           last_row_i,  // H - 1
  input  vista_stereo_pkg::params_t params_i,

  input  logic go_i,  // slots may be issued

  output vista_stereo_pkg::slot_t   slot_o,
  output logic [ColW-1:0]           slot_col_o,
  output vista_stereo_pkg::params_t params_o,      // of the frame being stored

  output logic             store_valid_o,
  output logic [ColW-1:0]  store_col_o,
  output logic [DataW-1:0] store_data_o,

  // The frame whose words may start to leave, with W - 1 and H - 1.
  output logic            begin_valid_o,
  output logic [ColW-1:0] begin_last_col_o,
  output logic [RowW-1:0] begin_last_row_o,
  output logic            begin_narrow_o,

  output logic frame_start_o,
  output logic error_early_eol_o,
  output logic error_late_eol_o,
  output logic error_early_sof_o,
  output logic error_late_sof_o,
  output logic error_size_o
);

  import vista_stereo_pkg::*;

  localparam int unsigned Radius = BlockSize / 2;
  localparam int unsigned RowsW = $clog2(BlockSize + 1);
  localparam int unsigned FirstMatchCol = NumDisparities - 1 + 2 * Radius;

  // Frame being stored.
  logic active_q, fill_q, lost_q;
  logic last_col_q, last_pixel_q;  // col_q is W - 1; and row_q is H - 1
  logic [ColW-1:0] col_q, width_less_1_q;
  logic [RowW-1:0] row_q, last_row_q;
  logic in_first_row_q, in_last_row_q;  // row_q is 0, is H - 1: `ready_o` and the frame's end do without comparing
  // Frame being matched: one row behind.
  logic drain_q, drain_last_col_q, drain_cut_q, begun_q;
  logic [ColW-1:0] drain_col_q, match_width_less_1_q;
  logic [RowW-1:0] match_last_row_q;
  logic [RowsW-1:0] rows_q;  // rows matched so far, saturating at B
  logic match_wide_q;  // wide enough for a row to have matched pixels

  logic head_sof, blocked, start, take, fill, step, frame_end, drop;
  logic bad_eol;

  assign head_sof = valid_i & sof_i;

  // The slots of the drain and those of a row below the first cannot run at once. Only a frame narrower than the one
  // before it ever waits here.
  assign blocked = drain_q & ~in_first_row_q;

  assign start = ~active_q & head_sof & admit_i & go_i;
  assign take  = active_q & ~fill_q & valid_i & ~sof_i & go_i & ~blocked;
  assign fill  = active_q & fill_q & go_i & ~blocked;
  assign step  = start | take | fill;
  assign drop  = valid_i & (active_q ? fill_q & ~sof_i : ~sof_i | ~admit_i);

  assign ready_o = start | take | drop;

  assign frame_end = step & last_pixel_q;
  assign bad_eol   = (start | take) & (eol_i != last_col_q);

  always_ff @(posedge clk_i) begin
    if (start) begin
      active_q       <= 1'b1;
      width_less_1_q <= last_col_i;
      last_row_q     <= last_row_i;
      params_o       <= params_i;
    end
    if (step) begin
      col_q      <= last_col_q ? '0 : col_q + 1'b1;
      last_col_q <= ~start & (col_q + 1'b1 == width_less_1_q);
      last_pixel_q <= ~start & in_last_row_q & (col_q + 1'b1 == width_less_1_q);
      if (last_col_q) begin
        row_q          <= in_last_row_q ? '0 : row_q + 1'b1;
        in_first_row_q <= in_last_row_q;
        in_last_row_q  <= ~in_last_row_q & (row_q + 1'b1 == last_row_q);
      end
    end
    if (bad_eol | (active_q & ~fill_q & head_sof)) fill_q <= 1'b1;
    if (frame_end) begin
      active_q <= 1'b0;
      fill_q   <= 1'b0;
    end

    // Lost: a start of frame is searched for, and what comes before it is no news.
    if (start) lost_q <= 1'b0;
    if (bad_eol | (drop & ~active_q)) lost_q <= 1'b1;

    if (!rst_ni) begin
      active_q       <= 1'b0;
      fill_q         <= 1'b0;
      lost_q         <= 1'b1;
      last_col_q     <= 1'b0;
      last_pixel_q   <= 1'b0;
      in_first_row_q <= 1'b1;
      in_last_row_q  <= 1'b0;
      col_q          <= '0;
      row_q          <= '0;
    end
  end

  // Slots of the frame being matched.
  logic slot_valid, slot_first_row, slot_last_col;
  logic [ColW-1:0] slot_col;
  logic [RowsW-1:0] rows;
  slot_t           slot_d;

  assign slot_valid     = drain_q ? go_i : step & ~in_first_row_q;
  assign slot_col       = drain_q ? drain_col_q : col_q;
  assign slot_first_row = ~drain_q & (32'(row_q) == 1);
  assign slot_last_col  = drain_q ? drain_last_col_q : last_col_q;
  assign rows           = slot_first_row ? '0 : rows_q;

  always_comb begin
    slot_d            = '0;
    slot_d.valid      = slot_valid;
    slot_d.first_col  = (slot_col == '0);
    slot_d.last_col   = slot_last_col;
    slot_d.before_col = (32'(slot_col) < NumDisparities - 1);
    slot_d.early_col  = (32'(slot_col) < NumDisparities - 1 + BlockSize);
    slot_d.first_row  = slot_first_row;
    slot_d.last_row   = drain_q;
    slot_d.flat       = drain_q & ~match_last_row_q[0];
    slot_d.leave      = (32'(rows) == BlockSize);
    slot_d.match_row  = (32'(rows) >= BlockSize - 1) & match_wide_q;
    slot_d.match      = slot_d.match_row & (32'(slot_col) >= FirstMatchCol);
    slot_d.cut        = drain_q ? drain_cut_q : fill_q;
  end

  always_ff @(posedge clk_i) begin
    if (slot_valid & slot_last_col & (32'(rows) != BlockSize)) rows_q <= rows + 1'b1;
    if (slot_valid & slot_first_row & slot_d.first_col) begin
      match_width_less_1_q <= width_less_1_q;
      match_last_row_q     <= last_row_q;
      match_wide_q         <= (32'(width_less_1_q) >= FirstMatchCol);
    end

    if (drain_q & go_i) begin
      drain_col_q      <= drain_col_q + 1'b1;
      drain_last_col_q <= (drain_col_q + 1'b1 == match_width_less_1_q);
      if (drain_last_col_q) drain_q <= 1'b0;
    end
    if (frame_end) begin
      drain_q          <= 1'b1;
      drain_col_q      <= '0;
      drain_last_col_q <= 1'b0;
      drain_cut_q      <= fill_q | bad_eol;
    end

    slot_o     <= slot_d;
    slot_col_o <= slot_col;

    store_valid_o <= step;
    store_col_o   <= col_q;
    store_data_o  <= data_i;

    if (!rst_ni) begin
      drain_q       <= 1'b0;
      slot_o.valid  <= 1'b0;
      store_valid_o <= 1'b0;
    end
  end

  // Words may leave once row r is being matched: from there on they keep pace with the input. A frame of no more than r
  // rows has no such row and begins with its last one.
  logic begin_now;
  assign begin_now = slot_valid & slot_d.first_col & ~begun_q & (drain_q | (32'(row_q) == Radius + 1));

  always_ff @(posedge clk_i) begin
    begin_valid_o    <= begin_now;
    begin_last_col_o <= drain_q ? match_width_less_1_q : width_less_1_q;
    begin_last_row_o <= drain_q ? match_last_row_q : last_row_q;
    begin_narrow_o   <= params_o.narrow;  // a next frame takes its own in this very clock at the earliest
    if (slot_valid & slot_first_row) begun_q <= 1'b0;
    if (begin_now) begun_q <= 1'b1;
    if (!rst_ni) begin
      begun_q       <= 1'b0;
      begin_valid_o <= 1'b0;
    end
  end

  always_ff @(posedge clk_i) begin
    frame_start_o     <= start;
    error_early_eol_o <= bad_eol & eol_i;
    error_late_eol_o  <= bad_eol & ~eol_i;
    error_early_sof_o <= active_q & ~fill_q & head_sof;
    error_late_sof_o  <= ~active_q & valid_i & ~sof_i & enable_i & ~lost_q;
    error_size_o      <= ~active_q & head_sof & enable_i & ~admit_i;
    if (!rst_ni) begin
      frame_start_o     <= 1'b0;
      error_early_eol_o <= 1'b0;
      error_late_eol_o  <= 1'b0;
      error_early_sof_o <= 1'b0;
      error_late_sof_o  <= 1'b0;
      error_size_o      <= 1'b0;
    end
  end

`ifdef VISTA_ASSERT
  `include "vista_framer_properties.svh"
`endif

endmodule
