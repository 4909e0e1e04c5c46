// SPDX-License-Identifier: Apache-2.0
// Puts the levels of a frame one after the other: level 0 from the source, each further one from the memory in which the
// reducer has stored it. A level that is followed by a smaller one also goes to the reducer.
//
// A level that the engine would not take, below 4x2 pixels, is not sent, and none after it.
// Frames come well ended (vista_frame_guard, vista_pixel_writer): whole, or with an end of line in the wrong place.
//
// Latency: 1 clock. No clock is lost from one level to the next or from one frame to the next.

module vista_levels #(
  parameter int unsigned MaxWidth = 1024,
  parameter int unsigned SideWidth = 1,
  localparam int unsigned ColW = $clog2(MaxWidth),
  localparam int unsigned RowW = vista_stereo_pkg::HeightW,
  localparam int unsigned DataW = 2 * vista_stereo_pkg::PixelW
) (
  input  logic clk_i,
  input  logic rst_ni,

  // Of the frame at the source, from its first pixel to its last.
  input  logic [ColW:0]        width_i,
  input  logic [RowW-1:0]      height_i,
  input  logic [2:0]           levels_i,  // 1 .. 4
  input  logic [SideWidth-1:0] side_i,

  input  logic             source_valid_i,
  output logic             source_ready_o,
  input  logic             source_eol_i,
  input  logic [DataW-1:0] source_data_i,

  input  logic             fetch_valid_i,
  output logic             fetch_ready_o,
  input  logic             fetch_eol_i,
  input  logic [DataW-1:0] fetch_data_i,

  output logic             reduce_valid_o,
  input  logic             reduce_ready_i,
  output logic             reduce_sof_o,
  output logic             reduce_eol_o,
  output logic [DataW-1:0] reduce_data_o,
  output logic [ColW:0]    reduce_width_o,
  output logic [RowW-1:0]  reduce_height_o,

  output logic             valid_o,
  input  logic             ready_i,
  output logic             sof_o,
  output logic             eol_o,
  output logic [DataW-1:0] data_o,

  // Of the level that is leaving; they change when its first pixel is offered.
  output logic [1:0]           level_o,
  output logic [ColW:0]        width_o,
  output logic [RowW-1:0]      height_o,
  output logic [SideWidth-1:0] side_o
);

  import vista_stereo_pkg::*;

  // A level is large enough to be followed by a smaller one.
  localparam int unsigned FollowedWidth = 2 * MinWidth - 1;
  localparam int unsigned FollowedHeight = 2 * MinHeight - 1;

  logic [1:0] level_q;
  logic [2:0] levels_q;
  logic [ColW:0]   width_q;   // of a level behind the first
  logic [RowW-1:0] height_q;
  logic [ColW-1:0] col_q;
  logic [RowW-1:0] row_q;

  logic first, more, valid, step, free, eol, last_col, last_row, level_end, level_sof;
  logic [2:0]      levels;
  logic [ColW:0]   width;
  logic [RowW-1:0] height;

  assign first  = (level_q == '0);
  assign levels = first ? levels_i : levels_q;
  assign width  = first ? width_i : width_q;
  assign height = first ? height_i : height_q;
  assign more   = (3'(level_q) + 3'd1 < levels) & (level_q != '1) & (32'(width) >= FollowedWidth) &
      (32'(height) >= FollowedHeight);

  assign valid = first ? source_valid_i : fetch_valid_i;
  assign eol   = first ? source_eol_i : fetch_eol_i;
  assign free  = ~valid_o | ready_i;
  assign step  = valid & free & (~more | reduce_ready_i);

  assign source_ready_o = step & first;
  assign fetch_ready_o  = step & ~first;

  assign reduce_valid_o  = valid & free & more;
  assign reduce_sof_o    = level_sof;
  assign reduce_eol_o    = eol;
  assign reduce_data_o   = first ? source_data_i : fetch_data_i;
  assign reduce_width_o  = width;
  assign reduce_height_o = height;

  assign level_sof = (col_q == '0) & (row_q == '0);
  assign last_col  = (32'(col_q) == 32'(width) - 1);
  assign last_row  = (32'(row_q) == 32'(height) - 1);
  assign level_end = (eol != last_col) | (last_col & last_row);

  always_ff @(posedge clk_i) begin
    if (step) begin
      col_q <= (level_end | last_col) ? '0 : col_q + 1'b1;
      if (level_end) row_q <= '0;
      else if (last_col) row_q <= row_q + 1'b1;
      if (first) levels_q <= levels_i;
      if (level_end) begin
        level_q  <= more ? level_q + 1'b1 : '0;
        width_q  <= (ColW + 1)'((32'(width) + 1) / 2);
        height_q <= RowW'((32'(height) + 1) / 2);
      end
    end
    if (free) begin
      valid_o <= step;
      sof_o   <= level_sof;
      eol_o   <= eol;
      data_o  <= reduce_data_o;
    end
    if (step & level_sof) begin
      level_o  <= level_q;
      width_o  <= width;
      height_o <= height;
      if (first) side_o <= side_i;
    end
    if (!rst_ni) begin
      level_q <= '0;
      col_q   <= '0;
      row_q   <= '0;
      valid_o <= 1'b0;
    end
  end

`ifdef FORMAL
  `include "vista_levels_properties.svh"
`endif

endmodule
