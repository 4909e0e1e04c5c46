// SPDX-License-Identifier: Apache-2.0
// One camera's line buffer, and the pixels that rectification takes from it, part C of the contract:
//
//   X = clamp(32 x + dx), Y = clamp(32 y + dy)
//   a = (32 - fx) p00 + fx p10,  b = (32 - fx) p01 + fx p11,  pixel = ((32 - fy) a + fy b + 512) >> 10
//
// The line buffer has four banks, of even and odd rows and columns, so that the four pixels around any place are read at
// once. What has no weight is not looked at: it may lie outside the image, or be written in that clock.
//
// Offsets come as straight pieces: at `load_i` the value of a piece at its first pixel, times 16, and its slope; every
// `step_i` takes the next pixel of it.
//
// Latency: SampleLatency clocks from `step_i` to `pixel_o`.

module vista_rectify_sample #(
  parameter int unsigned MaxWidth = 1024,
  parameter int unsigned NumRows = 64,
  parameter bit Parity = 1'b0,
  localparam int unsigned ColW = $clog2(MaxWidth),
  localparam int unsigned RowW = vista_stereo_pkg::HeightW,
  localparam int unsigned RingW = $clog2(NumRows),
  localparam int unsigned PixelW = vista_stereo_pkg::PixelW,
  localparam int unsigned ValueW = vista_rectify_pkg::ValueW,
  localparam int unsigned SlopeW = vista_rectify_pkg::SlopeW
) (
  input  logic clk_i,

  input  logic              write_i,
  input  logic [RingW-1:0]  write_row_i,
  input  logic [ColW-1:0]   write_col_i,
  input  logic [PixelW-1:0] write_data_i,

  input  logic load_i,
  input  logic signed [1:0][ValueW-1:0] value_i,  // dx, dy
  input  logic signed [1:0][SlopeW-1:0] slope_i,

  input  logic             step_i,
  input  logic [ColW-1:0]  x_i,
  input  logic [RowW-1:0]  y_i,
  input  logic [ColW-1:0]  last_x_i,
  input  logic [RowW-1:0]  last_y_i,
  input  logic [RingW-1:0] base_i,  // the row of the line buffer that has the frame's first one

  output logic [PixelW-1:0] pixel_o,
  output logic upset_o  // of a memory
);

  import vista_rectify_pkg::*;

  logic [1:0][1:0] upset;
  assign upset_o = |upset;

  localparam int unsigned SumW = ValueW + StepW + 1;
  localparam int unsigned PlaceW = ((ColW > RowW) ? ColW : RowW) + FractionW + 2;  // before it is clamped; signed
  localparam int unsigned HalfWidth = (MaxWidth + 1) / 2;
  localparam int unsigned BankDepth = NumRows / 2 * HalfWidth;
  localparam int unsigned AddrW = (BankDepth > 1) ? $clog2(BankDepth) : 1;

  // A row begins here in its bank. This is a table, since a product of so few bits would be slower.
  typedef logic [NumRows/2-1:0][AddrW-1:0] starts_t;

  function automatic starts_t starts_of_rows();
    starts_t starts;
    for (int unsigned row = 0; row < NumRows / 2; row++) starts[row] = AddrW'(row * HalfWidth);
    return starts;
  endfunction

  localparam starts_t RowStart = starts_of_rows();

  // 1: the offset of the pixel.
  logic signed [1:0][SumW-1:0] sum_q;
  logic signed [1:0][SlopeW-1:0] slope_q;
  logic signed [1:0][OffsetW-1:0] offset1_q;
  logic [ColW-1:0] x1_q, last_x1_q, last_x2_q;
  logic [RowW-1:0] y1_q, last_y1_q, last_y2_q;
  logic [RingW-1:0] base1_q, base2_q, base3_q;

  always_ff @(posedge clk_i) begin
    for (int unsigned i = 0; i < 2; i++) begin
      if (load_i) begin
        sum_q[i]   <= SumW'(signed'({value_i[i], StepW'(0)})) + SumW'(128);
        slope_q[i] <= slope_i[i];
      end else if (step_i) begin
        sum_q[i] <= SumW'(signed'(sum_q[i])) + SumW'(signed'(slope_q[i]));
      end
      offset1_q[i] <= OffsetW'(signed'(sum_q[i]) >>> (2 * StepW));
    end
    x1_q      <= x_i;
    y1_q      <= y_i;
    last_x1_q <= last_x_i;
    last_y1_q <= last_y_i;
    base1_q   <= base_i;
  end

  // 2: its source; 3: clamped to the image.
  logic signed [PlaceW-1:0] x2_q, y2_q;
  logic [ColW+FractionW-1:0] x3_q;
  logic [RowW+FractionW-1:0] y3_q;

  always_ff @(posedge clk_i) begin
    x2_q      <= PlaceW'({x1_q, FractionW'(0)}) + PlaceW'(signed'(offset1_q[0]));
    y2_q      <= PlaceW'({y1_q, FractionW'(0)}) + PlaceW'(signed'(offset1_q[1]));
    last_x2_q <= last_x1_q;
    last_y2_q <= last_y1_q;
    base2_q   <= base1_q;

    if (x2_q < 0) x3_q <= '0;
    else if (x2_q > PlaceW'({last_x2_q, FractionW'(0)})) x3_q <= {last_x2_q, FractionW'(0)};
    else x3_q <= (ColW + FractionW)'(x2_q);
    if (y2_q < 0) y3_q <= '0;
    else if (y2_q > PlaceW'({last_y2_q, FractionW'(0)})) y3_q <= {last_y2_q, FractionW'(0)};
    else y3_q <= (RowW + FractionW)'(y2_q);
    base3_q <= base2_q;
  end

  // 4: its row in the line buffer; 5: the addresses in the banks; 6 to 8: what they hold.
  logic [ColW+FractionW-1:0] x4_q;
  logic [FractionW-1:0] fy4_q;
  logic [RingW-1:0] row4_q, row4_next;
  logic [ColW:0] col4_next;
  logic [1:0][RingW-2:0] row_half;
  logic [1:0][ColW-1:0] col_half;
  logic [1:0][1:0][AddrW-1:0] addr5_q;  // by the parity of the row, then of the column
  logic [1:0][1:0][PixelW-1:0] bank7, bank8_q;

  assign row4_next   = row4_q + 1'b1;
  assign col4_next   = {1'b0, x4_q[FractionW+:ColW]} + 1'b1;
  assign row_half[0] = row4_next[RingW-1:1];
  assign row_half[1] = row4_q[RingW-1:1];
  assign col_half[0] = col4_next[ColW:1];
  assign col_half[1] = ColW'(x4_q[FractionW+ColW-1:FractionW+1]);

  always_ff @(posedge clk_i) begin
    x4_q   <= x3_q;
    fy4_q  <= y3_q[FractionW-1:0];
    row4_q <= base3_q + RingW'(y3_q >> FractionW);
    for (int unsigned r = 0; r < 2; r++) begin
      for (int unsigned c = 0; c < 2; c++) begin
        addr5_q[r][c] <= RowStart[row_half[r]] + AddrW'(col_half[c]);
      end
    end
  end

  logic write_q;
  logic write_odd_row_q, write_odd_col_q;
  logic [AddrW-1:0]  write_addr_q;
  logic [PixelW-1:0] write_data_q;

  always_ff @(posedge clk_i) begin
    write_q         <= write_i;
    write_odd_row_q <= write_row_i[0];
    write_odd_col_q <= write_col_i[0];
    write_addr_q    <= RowStart[write_row_i[RingW-1:1]] + AddrW'(write_col_i[ColW-1:1]);
    write_data_q    <= write_data_i;
  end

  for (genvar r = 0; r < 2; r++) begin : gen_row
    for (genvar c = 0; c < 2; c++) begin : gen_col
      vista_line_store #(
        .Width (PixelW),
        .Depth (BankDepth),
        .Parity(Parity)
      ) u_bank (
        .clk_i,
        .clear_i      (1'b0),
        .write_i      (write_q & (write_odd_row_q == 1'(r)) & (write_odd_col_q == 1'(c))),
        .write_col_i  (write_addr_q),
        .write_data_i (write_data_q),
        .read_col_i   (addr5_q[r][c]),
        .read_data_o  (bank7[r][c]),
        .upset_o      (upset[r][c])
      );
    end
  end

  logic odd_row8, odd_col8;
  logic [FractionW-1:0] fx8, fy8;

  vista_delay #(
    .Width   (2 + 2 * FractionW),
    .Latency (4)
  ) u_place (
    .clk_i,
    .data_i ({row4_q[0], x4_q[FractionW], x4_q[FractionW-1:0], fy4_q}),
    .data_o ({odd_row8, odd_col8, fx8, fy8})
  );

  // 9: the four pixels around the place; 10 to 12: between two of a row; 13 to 15: between the rows. Products may be
  // negative, but no sum is: they have no sign bit of their own.
  localparam int unsigned BlendW = PixelW + FractionW;

  logic [1:0] right, below;
  logic [1:0][PixelW-1:0] left9_q, right9_q, left10_q, left11_q;  // upper row, lower row
  logic signed [1:0][PixelW:0] difference10_q;
  logic [1:0][BlendW-1:0] product11_q;
  logic [1:0][BlendW-1:0] blend12_q;
  logic signed [BlendW:0] difference13_q;
  logic [BlendW+FractionW-1:0] product14_q;
  logic [BlendW-1:0] upper13_q, upper14_q;
  logic [FractionW-1:0] fx9_q, fx10_q, fy9_q, fy10_q, fy11_q, fy12_q, fy13_q;

  assign right = (fx8 == '0) ? {2{odd_col8}} : {odd_col8, ~odd_col8};  // {left, right}: the columns' parities
  assign below = (fy8 == '0) ? {2{odd_row8}} : {odd_row8, ~odd_row8};  // {upper, lower}

  always_ff @(posedge clk_i) begin
    bank8_q  <= bank7;
    left9_q  <= {bank8_q[below[0]][right[1]], bank8_q[below[1]][right[1]]};
    right9_q <= {bank8_q[below[0]][right[0]], bank8_q[below[1]][right[0]]};
    fx9_q    <= fx8;
    fx10_q   <= fx9_q;
    fy9_q    <= fy8;
    fy10_q   <= fy9_q;
    fy11_q   <= fy10_q;
    fy12_q   <= fy11_q;
    fy13_q   <= fy12_q;
    left10_q <= left9_q;
    left11_q <= left10_q;
    for (int unsigned i = 0; i < 2; i++) begin
      difference10_q[i] <= (PixelW + 1)'(right9_q[i]) - (PixelW + 1)'(left9_q[i]);
      product11_q[i]    <= BlendW'(signed'(difference10_q[i])) * BlendW'(fx10_q);
      blend12_q[i]      <= {left11_q[i], FractionW'(0)} + product11_q[i];
    end
    difference13_q <= (BlendW + 1)'(blend12_q[1]) - (BlendW + 1)'(blend12_q[0]);
    upper13_q      <= blend12_q[0];
    product14_q    <= (BlendW + FractionW)'(signed'(difference13_q)) * (BlendW + FractionW)'(fy13_q);
    upper14_q      <= upper13_q;
    pixel_o        <= PixelW'(({upper14_q, FractionW'(0)} + product14_q + (BlendW + FractionW)'(512))
                              >> (2 * FractionW));
  end

endmodule
