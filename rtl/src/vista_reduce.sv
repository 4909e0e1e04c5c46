// SPDX-License-Identifier: Apache-2.0
// Half-size images of both cameras, one step of the pyramid, part B of the contract:
//
//   out(X, Y) = (sum of [1 4 6 4 1]^T [1 4 6 4 1] around (2X, 2Y) + 128) >> 8
//
// of (W + 1) / 2 x (H + 1) / 2 pixels, with borders mirrored without repeating the edge.
//
//   s_axis, m_axis  tdata {right[7:0], left[7:0]}, tuser start of frame, tlast end of line, one pixel pair a beat
//
// Framing errors: as in vista_smooth. A frame that leaves with no more than three pixels is filled up instead of cut.
//
// Latency: pixel (X, Y) leaves 12 clocks after pixel (2X+4, 2Y+2) came. One pixel per clock comes in,
// frames back to back.

module vista_reduce #(
  parameter int unsigned MaxWidth = 1024,
  parameter bit Parity = 1'b0,
  localparam int unsigned ColW = $clog2(MaxWidth),
  localparam int unsigned RowW = vista_stereo_pkg::HeightW,
  localparam int unsigned PixelW = vista_stereo_pkg::PixelW
) (
  input  logic clk_i,
  input  logic rst_ni,

  // A frame has what is set in the clock in which its first pixel is first offered.
  input  logic            enable_i,
  input  logic [ColW:0]   width_i,   // 4 .. MaxWidth
  input  logic [RowW-1:0] height_i,  // 2 ..

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
  localparam int unsigned VerticalW = PixelW + 4;
  localparam int unsigned SumW = PixelW + 8;

  video_slot_t slot2;
  logic go, odd_col2, odd_row2;
  logic [DataW-1:0] below2;
  logic [3:0][DataW-1:0] row2;

  logic rows_upset, writer_upset;
  assign upset_o = rows_upset | writer_upset;

  vista_rows #(
    .NumRows  (4),
    .MaxWidth (MaxWidth),
    .Parity   (Parity)
  ) u_rows (
    .clk_i,
    .rst_ni,
    .enable_i,
    .width_i,
    .height_i,
    .side_i    (1'b0),
    .valid_i   (s_axis_tvalid),
    .ready_o   (s_axis_tready),
    .sof_i     (s_axis_tuser),
    .eol_i     (s_axis_tlast),
    .data_i    (s_axis_tdata),
    .go_i      (go),
    .slot_o    (slot2),
    .odd_col_o (odd_col2),
    .odd_row_o (odd_row2),
    .below_o   (below2),
    .row_o     (row2),
    .width_o   (),
    .height_o  (),
    .side_o    (),
    .frame_start_o,
    .error_early_eol_o,
    .error_late_eol_o,
    .error_early_sof_o,
    .error_late_sof_o,
    .error_size_o,
    .upset_o (rows_upset)
  );

  // A row of slots that sends pixels off is centred on row m-1, which is even. The last one of an odd height is centred
  // on row m itself, and rows m-1 and m-2 stand for those below it. Else row m-1 stands for row m+1 in a last row, and
  // rows 1 and 2 for those above row 0.
  logic center_last, second_row_q, second_row;
  logic [DataW-1:0] lower2, lower1, center, upper1, upper2;

  assign center_last = slot2.last_row & ~odd_row2;
  assign second_row  = second_row_q & ~slot2.first_row;

  always_comb begin
    lower2 = slot2.last_row ? row2[1] : below2;
    lower1 = row2[0];
    center = row2[1];
    upper1 = second_row ? row2[0] : row2[2];
    upper2 = second_row ? lower2 : row2[3];
    if (center_last) begin
      lower2 = row2[2];
      lower1 = row2[1];
      center = row2[0];
      upper1 = row2[1];
      upper2 = row2[2];
    end
  end

  // What goes along with a column.
  typedef struct packed {
    logic valid;
    logic first_col;
    logic last_col;
    logic odd_col;
    logic emit;    // the row sends pixels off
    logic top;     // row 0 of the smaller frame
    logic bottom;  // its last row
    logic cut;
  } column_t;

  // 3: sums of what has the same weight; 4, 5: the vertical sum of a column.
  column_t column2, column3_q, column4_q, column5_q;
  logic [1:0][PixelW:0] outer3_q, inner3_q;
  logic [1:0][PixelW-1:0] center3_q;
  logic [1:0][VerticalW-1:0] outer4_q;
  logic [1:0][PixelW+2:0] center4_q;
  logic [1:0][VerticalW-1:0] vertical5_q;

  always_comb begin
    column2.valid     = slot2.valid;
    column2.first_col = slot2.first_col;
    column2.last_col  = slot2.last_col;
    column2.odd_col   = odd_col2;
    column2.emit      = odd_row2 | slot2.last_row;
    column2.top       = second_row;
    column2.bottom    = slot2.last_row;
    column2.cut       = slot2.cut;
  end

  always_ff @(posedge clk_i) begin
    if (slot2.valid & slot2.last_col) second_row_q <= slot2.first_row;
    column3_q <= column2;
    column4_q <= column3_q;
    column5_q <= column4_q;
    for (int unsigned i = 0; i < 2; i++) begin
      outer3_q[i]    <= {1'b0, upper2[i*PixelW+:PixelW]} + {1'b0, lower2[i*PixelW+:PixelW]};
      inner3_q[i]    <= {1'b0, upper1[i*PixelW+:PixelW]} + {1'b0, lower1[i*PixelW+:PixelW]};
      center3_q[i]   <= center[i*PixelW+:PixelW];
      outer4_q[i]    <= VerticalW'(outer3_q[i]) + VerticalW'({inner3_q[i], 2'b0});
      center4_q[i]   <= {1'b0, center3_q[i], 2'b0} + {2'b0, center3_q[i], 1'b0};
      vertical5_q[i] <= outer4_q[i] + {1'b0, center4_q[i]};
    end
    if (!rst_ni) begin
      column3_q.valid <= 1'b0;
      column4_q.valid <= 1'b0;
      column5_q.valid <= 1'b0;
    end
  end

  // The columns before it, newest first. A pixel is sent off when an even column comes, for the one two before; when the
  // last one comes and is odd, for the one before; and one clock after the last one came if it is even, for that one: at
  // most a first column arrives then, which sends nothing off.
  column_t last_q;
  logic [3:0][1:0][VerticalW-1:0] before_q;
  logic first_q, first_center_q, pending_q;  // before_q[0] is column 0, before_q[1] is
  logic even, odd_end;

  assign even    = column5_q.valid & ~column5_q.odd_col & ~column5_q.first_col;
  assign odd_end = column5_q.valid & column5_q.odd_col & column5_q.last_col;

  always_ff @(posedge clk_i) begin
    if (column5_q.valid) begin
      last_q         <= column5_q;
      before_q       <= {before_q[2:0], vertical5_q};
      first_q        <= column5_q.first_col;
      first_center_q <= first_q;
    end
    pending_q <= column5_q.valid & column5_q.last_col & ~column5_q.odd_col;
    if (!rst_ni) pending_q <= 1'b0;
  end

  // 6: sums of what has the same weight; 7, 8: a 256th of the sum, half rounded up.
  localparam logic [SumW-1:0] Half = SumW'(128);

  typedef struct packed {
    logic valid;
    logic sof;
    logic eol;
    logic last;
    logic cut;
  } result_t;

  result_t result6_q, result7_q, result8_q;
  column_t newest;
  logic [1:0][VerticalW:0] outer6_q, inner6_q;
  logic [1:0][VerticalW-1:0] center6_q;
  logic [1:0][SumW-1:0] outer7_q, center7_q, sum8;
  logic [1:0][PixelW-1:0] data8_q;

  assign newest = pending_q ? last_q : column5_q;

  always_comb begin
    for (int unsigned i = 0; i < 2; i++) sum8[i] = outer7_q[i] + center7_q[i] + Half;
  end

  always_ff @(posedge clk_i) begin
    result6_q.valid <= (even | odd_end | pending_q) & newest.emit;
    result6_q.sof   <= newest.top & even & first_center_q;
    result6_q.eol   <= ~even;
    result6_q.last  <= newest.bottom & ~even;
    result6_q.cut   <= newest.cut;
    result7_q       <= result6_q;
    result8_q       <= result7_q;
    for (int unsigned i = 0; i < 2; i++) begin
      if (even) begin
        outer6_q[i]  <= {1'b0, vertical5_q[i]} + {1'b0, first_center_q ? vertical5_q[i] : before_q[3][i]};
        inner6_q[i]  <= {1'b0, before_q[0][i]} + {1'b0, first_center_q ? before_q[0][i] : before_q[2][i]};
        center6_q[i] <= before_q[1][i];
      end else begin
        outer6_q[i]  <= {1'b0, before_q[2][i]} + {1'b0, pending_q ? before_q[2][i] : before_q[0][i]};
        inner6_q[i]  <= {1'b0, before_q[1][i]} + {1'b0, pending_q ? before_q[1][i] : vertical5_q[i]};
        center6_q[i] <= before_q[0][i];
      end
      outer7_q[i]  <= SumW'(outer6_q[i]) + SumW'({inner6_q[i], 2'b0});
      center7_q[i] <= SumW'({center6_q[i], 2'b0}) + SumW'({center6_q[i], 1'b0});
      data8_q[i]   <= sum8[i][SumW-1-:PixelW];
    end
    if (!rst_ni) begin
      result6_q.valid <= 1'b0;
      result7_q.valid <= 1'b0;
      result8_q.valid <= 1'b0;
    end
  end

  vista_pixel_writer #(
    .SideWidth (1),
    .InFlight  (13),
    .Parity    (Parity)
  ) u_writer (
    .clk_i,
    .rst_ni,
    .result_valid_i (result8_q.valid),
    .result_sof_i   (result8_q.sof),
    .result_eol_i   (result8_q.eol),
    .result_end_i   (result8_q.last),
    .result_cut_i   (result8_q.cut),
    .result_data_i  (data8_q),
    .result_side_i  (1'b0),
    .go_o           (go),
    .valid_o        (m_axis_tvalid),
    .ready_i        (m_axis_tready),
    .sof_o          (m_axis_tuser),
    .eol_o          (m_axis_tlast),
    .data_o         (m_axis_tdata),
    .side_o         (),
    .upset_o        (writer_upset)
  );

endmodule
