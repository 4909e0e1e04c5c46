// SPDX-License-Identifier: Apache-2.0
// Step 1 of the contract: the x-Sobel of both images, or their grey values, and the texture |p - c| of the left one.
//
//   g(x, m) = v(x+1) - v(x-1),  v(x) = a(x, m-1) + 2 a(x, m) + a(x, m+1),  p = clamp(g, -c, c) + c
//
// Rows m-1 and m come from a line store, row m+1 is the one arriving. The rows beyond the frame mirror those inside:
// m+1 stands in for row -1, m-1 for row H. In the first and last column and in a flat row g is 0.
//
// Latency: 6 clocks from the slot of column x+1 (of the last column: 7 from its own slot). v needs 8+2 bits, g 11.

module vista_prefilter #(
  parameter int unsigned MaxWidth = 1024,
  parameter bit Parity = 1'b0,
  localparam int unsigned ColW = $clog2(MaxWidth),
  localparam int unsigned PixelW = vista_stereo_pkg::PixelW,
  localparam int unsigned TextureW = vista_stereo_pkg::TextureW
) (
  input  logic clk_i,
  input  logic rst_ni,

  input  vista_stereo_pkg::slot_t   slot_i,
  input  logic [ColW-1:0]           slot_col_i,
  input  vista_stereo_pkg::params_t params_i,

  input  logic                store_valid_i,
  input  logic [ColW-1:0]     store_col_i,
  input  logic [2*PixelW-1:0] store_data_i,  // {right, left}

  output vista_stereo_pkg::slot_t   slot_o,
  output logic [ColW-1:0]           slot_col_o,
  output vista_stereo_pkg::params_t params_o,  // of the frame being matched
  output logic [PixelW-1:0]         left_o,
  output logic [PixelW-1:0]         right_o,
  output logic [TextureW-1:0]       texture_o,
  output logic upset_o  // of a memory
);

  import vista_stereo_pkg::*;

  localparam int unsigned PairW = 2 * PixelW;
  localparam int unsigned VerticalW = PixelW + 2;

  // 1, 2: the two rows above come out of the store; the arriving pixel waits for them.
  slot_t slot1_q, slot2_q;
  logic [ColW-1:0] col1_q, col2_q, store_col1_q, store_col2_q;
  logic store1_q, store2_q;
  logic [PairW-1:0] below1_q, below2_q, above2, middle2;

  vista_line_store #(
    .Width (2 * PairW),
    .Depth (MaxWidth),
    .Parity(Parity)
  ) u_lines (
    .clk_i,
    .clear_i      (1'b0),
    .write_i      (store2_q),
    .write_col_i  (store_col2_q),
    .write_data_i ({middle2, below2_q}),
    .read_col_i   (slot_col_i),
    .read_data_o  ({above2, middle2}),
    .upset_o      (upset_o)
  );

  always_ff @(posedge clk_i) begin
    slot1_q      <= slot_i;
    slot2_q      <= slot1_q;
    col1_q       <= slot_col_i;
    col2_q       <= col1_q;
    store1_q     <= store_valid_i;
    store2_q     <= store1_q;
    store_col1_q <= store_col_i;
    store_col2_q <= store_col1_q;
    below1_q     <= store_data_i;
    below2_q     <= below1_q;
    if (!rst_ni) begin
      slot1_q.valid <= 1'b0;
      slot2_q.valid <= 1'b0;
      store1_q      <= 1'b0;
      store2_q      <= 1'b0;
    end
  end

  // 3: the vertical sums of column x+1; x and x-1 are kept.
  slot_t slot3_q, center_q;
  logic [ColW-1:0] col3_q, center_col_q;
  logic [PairW-1:0] above, below, grey3_q, grey_q;
  logic [1:0][VerticalW-1:0] vertical3_q, vertical_x_q, vertical_left_q;
  logic last_pending_q;

  assign above = slot2_q.first_row ? below2_q : above2;
  assign below = slot2_q.last_row ? above2 : below2_q;

  always_ff @(posedge clk_i) begin
    slot3_q <= slot2_q;
    col3_q  <= col2_q;
    grey3_q <= middle2;
    for (int unsigned i = 0; i < 2; i++) begin
      vertical3_q[i] <= VerticalW'(above[i*PixelW+:PixelW]) + VerticalW'(below[i*PixelW+:PixelW]) +
          {1'b0, middle2[i*PixelW+:PixelW], 1'b0};
    end
    if (slot3_q.valid) begin
      center_q        <= slot3_q;
      center_col_q    <= col3_q;
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

  // 4: the gradient of column x. The last column has no successor and leaves one clock after it came, when at most a
  // first column arrives, which sends nothing off. The parameters of a frame come with its first pixel, close behind the
  // last one of the frame before.
  slot_t                          slot4_q;
  logic [ColW-1:0]                col4_q;
  logic [PairW-1:0]               grey4_q;
  logic signed [1:0][VerticalW:0] gradient4_q;
  params_t params4_q;
  logic zero, follower;

  assign follower = slot3_q.valid & ~slot3_q.first_col;
  assign zero = center_q.first_col | center_q.last_col | center_q.flat;

  always_ff @(posedge clk_i) begin
    slot4_q       <= center_q;
    slot4_q.valid <= follower | last_pending_q;
    slot4_q.cut   <= center_q.cut | (follower & slot3_q.cut);
    if (follower & center_q.first_row & center_q.first_col) params4_q <= params_i;
    col4_q        <= center_col_q;
    grey4_q       <= grey_q;
    for (int unsigned i = 0; i < 2; i++) begin
      gradient4_q[i] <= zero ? '0 : {1'b0, vertical3_q[i]} - {1'b0, vertical_left_q[i]};
    end
    if (!rst_ni) slot4_q.valid <= 1'b0;
  end

  // 5: the gradient plus the cap, beside the verdicts on which side it leaves the range, and its magnitude where it does
  // not; 6: the choice among them. No carry chain waits for another.
  slot_t                        slot5_q;
  logic [ColW-1:0]              col5_q;
  logic [PairW-1:0]             grey5_q;
  logic [1:0] above5_q, below5_q;
  logic [1:0][VerticalW+1:0] raised4;
  logic [1:0][PixelW-1:0] raised5_q, sobel;
  logic [TextureW-1:0] magnitude5_q;

  always_comb begin
    for (int unsigned i = 0; i < 2; i++) begin
      raised4[i] = {gradient4_q[i][VerticalW], gradient4_q[i]} + (VerticalW + 2)'(params4_q.cap);
      sobel[i] = below5_q[i] ? '0 : above5_q[i] ? PixelW'({params_o.cap, 1'b0}) : raised5_q[i];
    end
  end

  always_ff @(posedge clk_i) begin
    slot5_q <= slot4_q;
    params_o   <= params4_q;
    col5_q  <= col4_q;
    grey5_q <= grey4_q;
    for (int unsigned i = 0; i < 2; i++) begin
      raised5_q[i] <= PixelW'(raised4[i]);
      below5_q[i]  <= raised4[i][VerticalW+1];
      above5_q[i]  <= $signed(gradient4_q[i]) > $signed((VerticalW + 1)'(params4_q.cap));
    end
    magnitude5_q <= gradient4_q[0][VerticalW] ? -TextureW'(gradient4_q[0]) : TextureW'(gradient4_q[0]);

    slot_o     <= slot5_q;
    slot_col_o <= col5_q;
    left_o     <= params_o.xsobel ? sobel[0] : grey5_q[0+:PixelW];
    right_o    <= params_o.xsobel ? sobel[1] : grey5_q[PixelW+:PixelW];
    texture_o  <= (above5_q[0] | below5_q[0]) ? params_o.cap : magnitude5_q;
    if (!rst_ni) begin
      slot5_q.valid <= 1'b0;
      slot_o.valid  <= 1'b0;
    end
  end

endmodule
