// SPDX-License-Identifier: Apache-2.0
// Turns incoming video into slots, one pixel of a row beside the one below it, and checks its framing.
//
// Row n of the frame that comes and row n-1 of the frame of the slots advance together, since filters need the row
// below. The last row of a frame has none below: its slots (the *drain*) run by themselves as soon as the frame is
// complete, beside the first row of a following frame, which is only stored. So frames may follow each other without a
// gap, and the last one needs no follower.
//
// Framing errors. A frame is cut where its structure breaks (early or missing end of line, early start of frame): the
// missing pixels are filled in at one a clock, their slots marked `cut`, and the rest of the input is dropped up to the
// next start of frame. Thus every frame that was begun gives all of its W * H words.
//
// Between frames the counters are set to those of a first pixel, whatever they were, so a bit of theirs that is upset
// disturbs no later frame.
//
// Latency: 1 clock from an accepted beat to `store_*_o`; its slot is there a clock before, for a user to add to it what it
// needs (vista_match_slots) and keep it in a register. Counters are as wide as the columns and rows they
// count; W - 1 and H - 1 rather than W and H are kept, so MaxWidth = 2^k needs no further bit.

module vista_framer #(
  parameter int unsigned MaxWidth = 1024,
  parameter int unsigned SideWidth = 1,
  localparam int unsigned ColW = $clog2(MaxWidth),
  localparam int unsigned RowW = vista_stereo_pkg::HeightW,
  localparam int unsigned DataW = 2 * vista_stereo_pkg::PixelW
) (
  input  logic clk_i,
  input  logic rst_ni,

  // A pixel, and what its frame is to have if it begins one (vista_frame_input).
  input  logic                 valid_i,
  output logic                 ready_o,
  input  logic                 sof_i,
  input  logic                 eol_i,
  input  logic [DataW-1:0]     data_i,
  input  logic                 enable_i,
  input  logic                 admit_i,     // enabled, and of a size that fits
  input  logic [ColW-1:0]      last_col_i,  // W - 1
  input  logic [RowW-1:0]      last_row_i,  // H - 1
  input  logic [SideWidth-1:0] side_i,      // whatever else belongs to the frame

  input  logic go_i,  // slots may be issued

  output vista_stereo_pkg::video_slot_t slot_next_o,  // of the next clock
  output logic [ColW-1:0]               slot_next_col_o,

  output logic             store_valid_o,
  output logic [ColW-1:0]  store_col_o,
  output logic             store_last_o,  // of its row
  output logic [DataW-1:0] store_data_o,

  // The frame being stored, which is that of the slot unless the slot is one of the last row, not the first.
  output logic [ColW-1:0]      last_col_o,
  output logic [RowW-1:0]      last_row_o,
  output logic [SideWidth-1:0] side_o,

  output logic frame_start_o,
  output logic error_early_eol_o,
  output logic error_late_eol_o,
  output logic error_early_sof_o,
  output logic error_late_sof_o,
  output logic error_size_o
);

  import vista_stereo_pkg::*;

  // Frame being stored.
  logic active_q, fill_q, lost_q;
  logic last_col_q, last_pixel_q;  // col_q is W - 1; and row_q is H - 1
  logic [ColW-1:0] col_q, width_less_1_q;
  logic [RowW-1:0] row_q, last_row_q;
  logic in_first_row_q, in_last_row_q;  // row_q is 0, is H - 1: `ready_o` and the frame's end do without comparing
  // Frame of the slots: one row behind.
  logic drain_q, drain_last_col_q, drain_cut_q;
  logic [ColW-1:0] drain_col_q, slot_width_less_1_q;
  logic slot_odd_q;  // of an odd number of rows

  logic head_sof, blocked, start, take, fill, step, frame_end, between, drop;
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
  assign between   = frame_end | ~(active_q | start);
  assign bad_eol   = (start | take) & (eol_i != last_col_q);

  always_ff @(posedge clk_i) begin
    if (start) begin
      active_q       <= 1'b1;
      width_less_1_q <= last_col_i;
      last_row_q     <= last_row_i;
      side_o         <= side_i;
    end
    if (step) begin
      col_q      <= last_col_q ? '0 : col_q + 1'b1;
      last_col_q <= ~start & (col_q + 1'b1 == width_less_1_q);
      last_pixel_q <= ~start & in_last_row_q & (col_q + 1'b1 == width_less_1_q);
      if (last_col_q) begin
        row_q          <= row_q + 1'b1;
        in_first_row_q <= 1'b0;
        in_last_row_q  <= (row_q + 1'b1 >= last_row_q);
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
      active_q <= 1'b0;
      fill_q   <= 1'b0;
      lost_q   <= 1'b1;
    end
    if (!rst_ni | between) begin
      last_col_q     <= 1'b0;
      last_pixel_q   <= 1'b0;
      in_first_row_q <= 1'b1;
      in_last_row_q  <= 1'b0;
      col_q          <= '0;
      row_q          <= '0;
    end
  end

  // Slots, one row behind.
  logic slot_valid, slot_first_row, slot_last_col;
  logic [ColW-1:0] slot_col;

  assign slot_valid     = drain_q ? go_i : step & ~in_first_row_q;
  assign slot_col       = drain_q ? drain_col_q : col_q;
  assign slot_first_row = ~drain_q & (32'(row_q) == 1);
  assign slot_last_col  = drain_q ? drain_last_col_q : last_col_q;

  always_comb begin
    slot_next_o           = '0;
    slot_next_o.valid     = slot_valid;
    slot_next_o.first_col = (slot_col == '0);
    slot_next_o.last_col  = slot_last_col;
    slot_next_o.first_row = slot_first_row;
    slot_next_o.last_row  = drain_q;
    slot_next_o.flat      = drain_q & slot_odd_q;
    slot_next_o.cut       = drain_q ? drain_cut_q : fill_q;
  end

  assign slot_next_col_o = slot_col;
  assign last_col_o      = width_less_1_q;
  assign last_row_o      = last_row_q;

  always_ff @(posedge clk_i) begin
    if (slot_valid & slot_first_row & slot_next_o.first_col) begin
      slot_width_less_1_q <= width_less_1_q;
      slot_odd_q          <= ~last_row_q[0];
    end

    if (drain_q & go_i) begin
      drain_col_q      <= drain_col_q + 1'b1;
      drain_last_col_q <= (drain_col_q + 1'b1 == slot_width_less_1_q);
      if (drain_last_col_q) drain_q <= 1'b0;
    end
    if (frame_end) begin
      drain_q          <= 1'b1;
      drain_col_q      <= '0;
      drain_last_col_q <= 1'b0;
      drain_cut_q      <= fill_q | bad_eol;
    end

    store_valid_o <= step;
    store_col_o   <= col_q;
    store_last_o  <= last_col_q;
    store_data_o  <= data_i;

    if (!rst_ni) begin
      drain_q       <= 1'b0;
      store_valid_o <= 1'b0;
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
