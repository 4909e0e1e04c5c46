// SPDX-License-Identifier: Apache-2.0
// The control points of one camera, and the offsets between two that lie one below the other, times StepPx:
//
//   value = (16 - j) * upper + j * lower = 16 * upper + j * (lower - upper)
//
// The address of the upper one comes first, that of the lower one in the clock after it, together with j.
//
// Latency: ValueLatency clocks from the address of the upper point to `value_o`.

module vista_rectify_points #(
  parameter int unsigned MaxPoints = 2048,
  parameter bit Parity = 1'b0,
  localparam int unsigned AddrW = $clog2(MaxPoints) + 1,
  localparam int unsigned OffsetW = vista_rectify_pkg::OffsetW,
  localparam int unsigned StepW = vista_rectify_pkg::StepW,
  localparam int unsigned ValueW = vista_rectify_pkg::ValueW
) (
  input  logic clk_i,

  input  logic                 write_i,
  input  logic [AddrW-1:0]     write_addr_i,  // the bank is its first bit
  input  logic [2*OffsetW-1:0] write_data_i,  // {dy, dx}

  input  logic             on_i,  // 0: all offsets are 0
  input  logic [StepW-1:0] j_i,
  input  logic [AddrW-1:0] addr_i,

  output logic signed [1:0][ValueW-1:0] value_o,  // dx, dy
  output logic upset_o  // of a memory
);

  localparam int unsigned DifferenceW = OffsetW + 1;

  logic [2*OffsetW-1:0] stored, point;

  vista_line_store #(
    .Width (2 * OffsetW),
    .Depth (2 ** AddrW),
    .Parity(Parity)
  ) u_points (
    .clk_i,
    .clear_i      (1'b0),
    .write_i,
    .write_col_i  (write_addr_i),
    .write_data_i,
    .read_col_i   (addr_i),
    .read_data_o  (stored),
    .upset_o      (upset_o)
  );

  // Off, points are zeros: before the first map nobody knows what the memory holds.
  logic on1_q, on2_q;

  always_ff @(posedge clk_i) begin
    on1_q <= on_i;
    on2_q <= on1_q;
  end

  assign point = on2_q ? stored : '0;

  // j comes with the lower point's address and is wanted 3 clocks later, beside the difference.
  logic [StepW-1:0] j;

  vista_delay #(
    .Width   (StepW),
    .Latency (3)
  ) u_j (
    .clk_i,
    .data_i (j_i),
    .data_o (j)
  );

  logic signed [1:0][OffsetW-1:0] upper3_q, upper4_q, upper5_q;
  logic signed [1:0][DifferenceW-1:0] difference4_q;
  logic signed [1:0][DifferenceW+StepW-1:0] product5_q;

  always_ff @(posedge clk_i) begin
    upper3_q <= point;
    upper4_q <= upper3_q;
    for (int unsigned i = 0; i < 2; i++) begin
      difference4_q[i] <= DifferenceW'(signed'(point[i*OffsetW+:OffsetW])) - DifferenceW'(signed'(upper3_q[i]));
      product5_q[i] <= (DifferenceW + StepW)'(signed'(difference4_q[i])) * (DifferenceW + StepW)'(signed'({1'b0, j}));
      upper5_q[i]   <= upper4_q[i];
      value_o[i]    <= ValueW'(signed'({upper5_q[i], StepW'(0)})) + ValueW'(signed'(product5_q[i]));
    end
  end

endmodule
