// SPDX-License-Identifier: Apache-2.0
// Smoothing of both images, part A of the contract, on the way to the engine:
//
//   s = (sum of [1 2 1]^T [1 2 1] over the 3x3 neighbours + 8) >> 4
//
// with borders mirrored without repeating the edge. With `smooth_i` off, pixels pass unchanged, with the same latency.
//
//   s_axis, m_axis  tdata {right[7:0], left[7:0]}, tuser start of frame, tlast end of line, one pixel pair a beat
//
// Framing errors: those of vista_framer. A frame that is cut ends with its last pixel that could be computed from what
// came (vista_pixel_writer); everything else is dropped up to the next start of frame.
//
// Latency: pixel (x, y) leaves 9 clocks after pixel (x+2, y+1) came. One pixel per clock, frames back to back.

module vista_smooth #(
  parameter int unsigned MaxWidth = 1024,
  parameter int unsigned SideWidth = 1,
  parameter bit Parity = 1'b0,
  localparam int unsigned ColW = $clog2(MaxWidth),
  localparam int unsigned RowW = vista_stereo_pkg::HeightW,
  localparam int unsigned PixelW = vista_stereo_pkg::PixelW
) (
  input  logic clk_i,
  input  logic rst_ni,

  // A frame has what is set in the clock in which its first pixel is first offered.
  input  logic                 enable_i,
  input  logic [ColW:0]        width_i,   // 4 .. MaxWidth
  input  logic [RowW-1:0]      height_i,  // 2 ..
  input  logic                 smooth_i,
  input  logic [SideWidth-1:0] side_i,    // whatever else belongs to the frame, passed on

  input  logic                s_axis_tvalid,
  output logic                s_axis_tready,
  input  logic [2*PixelW-1:0] s_axis_tdata,
  input  logic                s_axis_tuser,
  input  logic                s_axis_tlast,

  output logic                m_axis_tvalid,
  input  logic                m_axis_tready,
  output logic [2*PixelW-1:0] m_axis_tdata,
  output logic                m_axis_tuser,
  output logic                m_axis_tlast,

  // Properties of the frame that is leaving; they change when its first pixel is offered.
  output logic [ColW:0]        width_o,
  output logic [RowW-1:0]      height_o,
  output logic [SideWidth-1:0] side_o,

  // Events, one clock each.
  output logic frame_start_o,
  output logic error_early_eol_o,
  output logic error_late_eol_o,
  output logic error_early_sof_o,
  output logic error_late_sof_o,
  output logic error_size_o,
  output logic upset_o  // of a memory
);

  import vista_stereo_pkg::*;

  localparam int unsigned DataW = 2 * PixelW;
  localparam int unsigned VerticalW = PixelW + 2;
  localparam int unsigned SumW = PixelW + 4;
  localparam int unsigned AllSideW = SideWidth + RowW + ColW + 1;

  video_slot_t slot2;
  logic go, smooth2;
  logic [DataW-1:0] below2, above, below;
  logic [1:0][DataW-1:0] row2;
  logic [AllSideW-1:0] side2;

  logic rows_upset, writer_upset;
  assign upset_o = rows_upset | writer_upset;

  vista_rows #(
    .NumRows   (2),
    .MaxWidth  (MaxWidth),
    .SideWidth (1 + SideWidth),
    .Parity    (Parity)
  ) u_rows (
    .clk_i,
    .rst_ni,
    .enable_i,
    .width_i,
    .height_i,
    .side_i    ({smooth_i, side_i}),
    .valid_i   (s_axis_tvalid),
    .ready_o   (s_axis_tready),
    .sof_i     (s_axis_tuser),
    .eol_i     (s_axis_tlast),
    .data_i    (s_axis_tdata),
    .go_i      (go),
    .slot_o    (slot2),
    .odd_col_o (),
    .odd_row_o (),
    .below_o   (below2),
    .row_o     (row2),
    .width_o   (side2[ColW:0]),
    .height_o  (side2[ColW+1+:RowW]),
    .side_o    ({smooth2, side2[AllSideW-1-:SideWidth]}),
    .frame_start_o,
    .error_early_eol_o,
    .error_late_eol_o,
    .error_early_sof_o,
    .error_late_sof_o,
    .error_size_o,
    .upset_o (rows_upset)
  );

  // 3: the vertical sums of column x+1; x and x-1 are kept.
  video_slot_t slot3_q, center_q;
  logic smooth3_q, center_smooth_q, last_pending_q;
  logic [DataW-1:0] grey3_q, grey_q;
  logic [AllSideW-1:0] side3_q;
  logic [1:0][VerticalW-1:0] vertical3_q, vertical_x_q, vertical_left_q;

  assign above = slot2.first_row ? below2 : row2[1];
  assign below = slot2.last_row ? row2[1] : below2;

  always_ff @(posedge clk_i) begin
    slot3_q <= slot2;
    grey3_q <= row2[0];
    if (slot2.valid & slot2.first_row & slot2.first_col) begin
      smooth3_q <= smooth2;
      side3_q   <= side2;
    end
    for (int unsigned i = 0; i < 2; i++) begin
      vertical3_q[i] <= VerticalW'(above[i*PixelW+:PixelW]) + VerticalW'(below[i*PixelW+:PixelW]) +
          {1'b0, row2[0][i*PixelW+:PixelW], 1'b0};
    end
    if (slot3_q.valid) begin
      center_q        <= slot3_q;
      center_smooth_q <= smooth3_q;
      grey_q          <= grey3_q;
      vertical_x_q    <= vertical3_q;
      vertical_left_q <= vertical_x_q;
    end
    last_pending_q <= slot3_q.valid & slot3_q.last_col;
    if (!rst_ni) begin
      slot3_q.valid  <= 1'b0;
      last_pending_q <= 1'b0;
    end
  end

  // 4: the sum of column x. The last column has no successor and leaves one clock after it came, when at most a first
  // column arrives, which sends nothing off.
  logic valid4_q, sof4_q, eol4_q, end4_q, cut4_q, smooth4_q, follower;
  logic [DataW-1:0] grey4_q;
  logic [1:0][VerticalW-1:0] left, right;
  logic [1:0][SumW-1:0] sum4_q;

  assign follower = slot3_q.valid & ~slot3_q.first_col;
  assign left     = center_q.first_col ? vertical3_q : vertical_left_q;
  assign right    = center_q.last_col ? vertical_left_q : vertical3_q;

  always_ff @(posedge clk_i) begin
    valid4_q  <= follower | last_pending_q;
    sof4_q    <= center_q.first_row & center_q.first_col;
    eol4_q    <= center_q.last_col;
    end4_q    <= center_q.last_row & center_q.last_col;
    cut4_q    <= center_q.cut | (follower & slot3_q.cut);
    smooth4_q <= center_smooth_q;
    grey4_q   <= grey_q;
    for (int unsigned i = 0; i < 2; i++) begin
      sum4_q[i] <= SumW'(left[i]) + SumW'(right[i]) + SumW'({vertical_x_q[i], 1'b0});
    end
    if (!rst_ni) valid4_q <= 1'b0;
  end

  // 5: a sixteenth of it, half rounded up.
  localparam logic [SumW-1:0] Half = SumW'(8);

  logic valid5_q, sof5_q, eol5_q, end5_q, cut5_q;
  logic [DataW-1:0] data5_q;
  logic [1:0][PixelW-1:0] smoothed;

  always_comb begin
    for (int unsigned i = 0; i < 2; i++) smoothed[i] = PixelW'((sum4_q[i] + Half) >> 4);
  end

  always_ff @(posedge clk_i) begin
    valid5_q <= valid4_q;
    sof5_q   <= sof4_q;
    eol5_q   <= eol4_q;
    end5_q   <= end4_q;
    cut5_q   <= cut4_q;
    data5_q  <= smooth4_q ? smoothed : grey4_q;
    if (!rst_ni) valid5_q <= 1'b0;
  end

  vista_pixel_writer #(
    .SideWidth (AllSideW),
    .Parity    (Parity)
  ) u_writer (
    .clk_i,
    .rst_ni,
    .result_valid_i (valid5_q),
    .result_sof_i   (sof5_q),
    .result_eol_i   (eol5_q),
    .result_end_i   (end5_q),
    .result_cut_i   (cut5_q),
    .result_data_i  (data5_q),
    .result_side_i  (side3_q),
    .go_o           (go),
    .valid_o        (m_axis_tvalid),
    .ready_i        (m_axis_tready),
    .sof_o          (m_axis_tuser),
    .eol_o          (m_axis_tlast),
    .data_o         (m_axis_tdata),
    .side_o         ({side_o, height_o, width_o}),
    .upset_o        (writer_upset)
  );

endmodule
