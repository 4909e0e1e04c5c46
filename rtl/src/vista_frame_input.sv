// SPDX-License-Identifier: Apache-2.0
// Buffer for incoming video (vista_skid) in which each pixel keeps what was set in the clock in which it was first
// offered: size, enable, and whatever else belongs to a frame. So what is set later never reaches a frame that has begun
// on the bus, however long its first pixels wait here or there.
//
// Latency 1 clock, one pixel a clock.

module vista_frame_input #(
  parameter int unsigned MaxWidth = 1024,
  parameter int unsigned SideWidth = 1,
  localparam int unsigned ColW = $clog2(MaxWidth),
  localparam int unsigned RowW = vista_stereo_pkg::HeightW,
  localparam int unsigned DataW = 2 * vista_stereo_pkg::PixelW
) (
  input  logic clk_i,
  input  logic rst_ni,

  // What is set now.
  input  logic                 enable_i,
  input  logic [ColW:0]        width_i,
  input  logic [RowW-1:0]      height_i,
  input  logic [SideWidth-1:0] side_i,

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

  // What was set when the pixel was offered. `admit_o`: enabled, and the size is one that the engine takes.
  output logic                 enable_o,
  output logic                 admit_o,
  output logic [ColW-1:0]      last_col_o,  // W - 1
  output logic [RowW-1:0]      last_row_o,  // H - 1
  output logic [SideWidth-1:0] side_o,

  output logic busy_o  // a pixel of a frame that is admitted waits
);

  import vista_stereo_pkg::*;

  localparam int unsigned SetW = 2 + ColW + RowW + SideWidth;

  if (MaxWidth < MinWidth || MaxWidth > LargestWidth) begin : gen_bad_width
    $fatal(1, "MaxWidth must be 4 .. 65535");
  end

  logic size_ok, waiting_q, comes, goes;
  logic [1:0] admitted_q;  // pixels that wait
  logic [SetW-1:0] now, set, held_q;

  assign size_ok = (32'(width_i) >= MinWidth) & (32'(width_i) <= MaxWidth) & (32'(height_i) >= MinHeight);
  assign now     = {enable_i, enable_i & size_ok, ColW'(width_i - 1'b1), height_i - 1'b1, side_i};
  assign set     = waiting_q ? held_q : now;
  assign comes   = valid_i & ~waiting_q & set[SetW-2];
  assign goes    = valid_o & ready_i & admit_o;
  assign busy_o  = (admitted_q != '0);

  always_ff @(posedge clk_i) begin
    waiting_q <= valid_i & ~ready_o;
    held_q    <= set;
    admitted_q <= admitted_q + 2'(comes) - 2'(goes);
    if (!rst_ni) begin
      waiting_q  <= 1'b0;
      admitted_q <= '0;
    end
  end

  vista_skid #(
    .Width(SetW + 2 + DataW)
  ) u_skid (
    .clk_i,
    .rst_ni,
    .valid_i,
    .ready_o,
    .data_i  ({set, sof_i, eol_i, data_i}),
    .valid_o,
    .ready_i,
    .data_o  ({enable_o, admit_o, last_col_o, last_row_o, side_o, sof_o, eol_o, data_o})
  );

`ifdef VISTA_ASSERT
  `include "vista_frame_input_properties.svh"
`endif

endmodule
