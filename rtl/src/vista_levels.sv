// SPDX-License-Identifier: Apache-2.0
// Puts the levels of a frame one after the other: level 0 from the source, each further one from the memory in which the
// reducer has stored it. A level that is followed by a smaller one also goes to the reducer.
//
// Which levels are sent comes with the frame, and moves on by one with each level.
// Frames come well ended (vista_frame_guard, vista_pixel_writer): whole, or with an end of line in the wrong place. So a
// level starts where the source or the memory says that it does. If it does not, a bit was upset somewhere, and it is not
// known any more which level of which frame is where: `lost_o` asks for a reset of all that deals with frames.
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

  // Properties of the frame at the source, from its first pixel to its last.
  input  logic [ColW-1:0]      last_col_i,  // W - 1
  input  logic [RowW-1:0]      last_row_i,  // H - 1
  input  logic [2:0]           sent_i,      // bit k: level k + 1 is sent
  input  logic [SideWidth-1:0] side_i,

  input  logic             source_valid_i,
  output logic             source_ready_o,
  input  logic             source_sof_i,
  input  logic             source_eol_i,
  input  logic [DataW-1:0] source_data_i,

  input  logic             fetch_valid_i,
  output logic             fetch_ready_o,
  input  logic             fetch_sof_i,
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

  // Properties of the level that is leaving; they change when its first pixel is offered.
  output logic                 lost_o,     // one clock
  output logic                 follows_o,  // one clock: a level begins that a smaller one follows
  output logic [1:0]           level_o,
  output logic [ColW:0]        width_o,
  output logic [RowW-1:0]      height_o,
  output logic [SideWidth-1:0] side_o
);

  import vista_stereo_pkg::*;

  logic [1:0]      level_q;
  logic            first_q;  // level_q is 0
  logic [2:0]      sent_q;   // of a level behind the first, as the sizes: bit k: the level k + 1 after it is sent
  logic [ColW-1:0] end_col_q;
  logic [RowW-1:0] end_row_q;
  logic            last_col_q;  // col_q is that of the end of a line
  logic [ColW-1:0] col_q;
  logic [RowW-1:0] row_q;

  logic more, valid, step, free, eol, last_row, level_end, level_sof;
  logic [2:0]      sent;
  logic [ColW-1:0] end_col;
  logic [RowW-1:0] end_row;

  // The smaller level has ((W + 1) / 2) - 1 = (W - 1) / 2 columns but one.
  assign sent    = first_q ? sent_i : sent_q;
  assign more    = sent[0];
  assign end_col = first_q ? last_col_i : end_col_q;
  assign end_row = first_q ? last_row_i : end_row_q;

  assign valid = first_q ? source_valid_i : fetch_valid_i;
  assign eol   = first_q ? source_eol_i : fetch_eol_i;
  assign free  = ~valid_o | ready_i;
  assign step  = valid & free & (~more | reduce_ready_i);

  assign source_ready_o = step & first_q;
  assign fetch_ready_o  = step & ~first_q;

  assign reduce_valid_o  = valid & free & more;
  assign reduce_sof_o    = level_sof;
  assign reduce_eol_o    = eol;
  assign reduce_data_o   = first_q ? source_data_i : fetch_data_i;
  assign reduce_width_o  = (ColW + 1)'(end_col) + 1'b1;
  assign reduce_height_o = end_row + 1'b1;

  assign follows_o = step & level_sof & more;
  assign level_sof = (col_q == '0) & (row_q == '0);
  assign last_row  = (row_q == end_row);
  assign level_end = (eol != last_col_q) | (last_col_q & last_row);

  always_ff @(posedge clk_i) begin
    if (step) begin
      col_q      <= (level_end | last_col_q) ? '0 : col_q + 1'b1;
      last_col_q <= ~level_end & (col_q + 1'b1 == end_col);
      if (level_end) row_q <= '0;
      else if (last_col_q) row_q <= row_q + 1'b1;
      if (level_end) begin
        level_q   <= more ? level_q + 1'b1 : '0;
        first_q   <= ~more;
        end_col_q <= end_col >> 1;
        end_row_q <= end_row >> 1;
        sent_q    <= sent >> 1;
      end
    end
    lost_o <= step & ((first_q ? source_sof_i : fetch_sof_i) != level_sof);
    if (free) begin
      valid_o <= step;
      sof_o   <= level_sof;
      eol_o   <= eol;
      data_o  <= reduce_data_o;
    end
    if (step & level_sof) begin
      level_o  <= level_q;
      width_o  <= reduce_width_o;
      height_o <= reduce_height_o;
      if (first_q) side_o <= side_i;
    end
    if (!rst_ni) begin
      level_q    <= '0;
      first_q    <= 1'b1;
      col_q      <= '0;
      last_col_q <= 1'b0;
      row_q      <= '0;
      valid_o    <= 1'b0;
      lost_o     <= 1'b0;
    end
  end

`ifdef VISTA_ASSERT
  `include "vista_levels_properties.svh"
`endif

endmodule
