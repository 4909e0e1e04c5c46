// SPDX-License-Identifier: Apache-2.0
// The bound of step 5: T = Smin + floor(Smin * u / 100), saturated to the width of a cost.
//
// The division by 100 is a multiplication by R = ceil(2^30 / 100). With R * 100 = 2^30 + 76 it is exact as long as
// Smin * u * 76 < 2^30; Smin < 2^17 and u <= 100 stay below (tb/test_arithmetic.py tries them all). The *gain* u * R is
// formed bit by bit, since it stands for a whole frame. All ones, the saturated word, lies above every cost.
//
// A multiplier may lie far from the logic around it. It has registers of its own on both sides, which can go with it.
//
// Latency: 4 clocks from `smin_i`; `ratio_i` has to stand from 17 clocks before it on.

module vista_uniqueness_bound #(
  parameter int unsigned CostW = 15
) (
  input  logic             clk_i,
  input  logic             rst_ni,
  input  logic [6:0]       ratio_i,  // u, 0 .. 100
  input  logic [CostW-1:0] smin_i,
  output logic [CostW-1:0] bound_o
);

  localparam int unsigned Shift = 30;
  localparam int unsigned Half = Shift / 2;  // operands fit 18-bit multipliers
  localparam int unsigned GainW = Shift + 1;
  localparam logic [GainW-1:0] Reciprocal = GainW'(10737419);

  // The bits of u, the highest first.
  logic [2:0] step_q;
  logic [6:0] ratio_q;
  logic [GainW-2:0] product_q;
  logic [GainW-1:0] product, gain_q;
  logic [GainW-1:0] gain1_q;  // beside the multipliers, whose registers have no enable that follows the steps

  assign product = {product_q, 1'b0} + (ratio_q[6] ? Reciprocal : '0);

  always_ff @(posedge clk_i) begin
    step_q    <= step_q - 1'b1;
    ratio_q   <= {ratio_q[5:0], 1'b0};
    product_q <= product[GainW-2:0];
    if (step_q == '0) begin
      step_q    <= 3'd6;
      ratio_q   <= ratio_i;
      product_q <= '0;
      gain_q    <= product;
    end
    if (!rst_ni) step_q <= '0;
  end

  // 1: Smin beside its multipliers; 2: products; 3: margin; 4: bound.
  logic [CostW-1:0] smin1_q, smin2_q, smin3_q;
  logic [CostW+Half-1:0] low2_q;
  logic [CostW+GainW-Half-1:0] high2_q, sum;
  logic [CostW-1:0]            margin3_q;
  logic [CostW:0]              bound;

  assign sum   = high2_q + (CostW + GainW - Half)'(low2_q[CostW+Half-1:Half]);
  assign bound = {1'b0, smin3_q} + {1'b0, margin3_q};

  always_ff @(posedge clk_i) begin
    gain1_q   <= gain_q;
    smin1_q   <= smin_i;
    low2_q    <= (CostW + Half)'(smin1_q) * (CostW + Half)'(gain1_q[Half-1:0]);
    high2_q   <= (CostW + GainW - Half)'(smin1_q) * (CostW + GainW - Half)'(gain1_q[GainW-1:Half]);
    smin2_q   <= smin1_q;
    smin3_q   <= smin2_q;
    margin3_q <= sum[CostW+Half-1:Half];
    bound_o   <= bound[CostW] ? '1 : bound[CostW-1:0];
  end

  // u <= 100 leaves the margin within Smin.
  logic unused_sum;
  assign unused_sum = ^{sum[CostW+GainW-Half-1:CostW+Half], sum[Half-1:0], low2_q[Half-1:0]};

endmodule
