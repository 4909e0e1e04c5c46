// SPDX-License-Identifier: Apache-2.0
// Step 7 of the contract: the disparity to 1/16 px from the costs beside the winner.
//
// With q = p + n - 2 Smin + |p - n| = 2 (max(p, n) - Smin), the fraction 256 (p - n) / q is 128 (p - n) / den,
// den = max(p, n) - Smin. As p and n are no smaller than Smin, |p - n| <= den, and the quotient lies in 0 .. 128:
// eight steps of a restoring division, truncating the magnitude as the contract truncates towards zero. den = 0 means
// p = n, a fraction of 0.
//
// Latency: 11 clocks. Remainders need one bit more than a cost.

module vista_subpixel #(
  parameter int unsigned CostW = 15,
  parameter int unsigned IndexW = 5,
  localparam int unsigned DisparityW = vista_stereo_pkg::DisparityW
) (
  input  logic                         clk_i,
  input  logic [IndexW-1:0]            winner_i,
  input  logic [CostW-1:0]             smin_i,
  input  logic [CostW-1:0]             previous_i,  // p = S(dL - 1)
  input  logic [CostW-1:0]             next_i,      // n = S(dL + 1)
  output logic signed [DisparityW-1:0] disparity_o
);

  localparam int unsigned NumSteps = 8;

  // 1: differences; 2: dividend and divisor.
  logic signed [CostW:0] difference1_q;
  logic [CostW-1:0] previous1_q, next1_q;
  logic [CostW-1:0] num2_q, den2_q;
  logic                  negative2_q;
  logic [CostW-1:0]      den;

  assign den = difference1_q[CostW] ? next1_q : previous1_q;

  always_ff @(posedge clk_i) begin
    difference1_q <= {1'b0, previous_i} - {1'b0, next_i};
    previous1_q   <= previous_i - smin_i;
    next1_q       <= next_i - smin_i;
    num2_q        <= difference1_q[CostW] ? CostW'(-difference1_q) : difference1_q[CostW-1:0];
    negative2_q   <= difference1_q[CostW];
    den2_q        <= den;
    den2_q[0]     <= den[0] | (den == '0);
  end

  // 3 .. 10: the bits of the quotient, units first.
  logic [NumSteps:0][CostW:0]      remainder;
  logic [NumSteps:0][CostW-1:0]    divisor;
  logic [NumSteps:0][NumSteps-1:0] quotient;
  logic [NumSteps:0]               negative;

  assign remainder[0] = {1'b0, num2_q};
  assign divisor[0]   = den2_q;
  assign quotient[0]  = '0;
  assign negative[0]  = negative2_q;

  for (genvar i = 0; i < NumSteps; i++) begin : gen_step
    logic [CostW+1:0] rest;
    assign rest = {1'b0, remainder[i]} - {2'b0, divisor[i]};

    always_ff @(posedge clk_i) begin
      // What is left is below the divisor, so doubling it cannot overflow.
      remainder[i+1] <= rest[CostW+1] ? {remainder[i][CostW-1:0], 1'b0} : {rest[CostW-1:0], 1'b0};
      divisor[i+1]   <= divisor[i];
      quotient[i+1]  <= {quotient[i][NumSteps-2:0], ~rest[CostW+1]};
      negative[i+1]  <= negative[i];
    end
  end

  // 11: (256 dL +- fraction + 15) >> 4.
  logic [IndexW-1:0]          winner;
  logic signed [NumSteps:0]   fraction;
  logic signed [IndexW+NumSteps+1:0] scaled;

  vista_delay #(
    .Width   (IndexW),
    .Latency (NumSteps + 2)
  ) u_winner (
    .clk_i,
    .data_i (winner_i),
    .data_o (winner)
  );

  assign fraction = negative[NumSteps] ? -$signed({1'b0, quotient[NumSteps]})
                                       : $signed({1'b0, quotient[NumSteps]});
  assign scaled = $signed({2'b0, winner, 8'd15}) + (IndexW + NumSteps + 2)'(fraction);

  always_ff @(posedge clk_i) disparity_o <= DisparityW'(scaled >>> 4);

endmodule
