// The bound of step 5: T = Smin + floor(Smin * u / 100), saturated to the width of a cost.
//
// The division by 100 is a multiplication by R = ceil(2^30 / 100). With R * 100 = 2^30 + 76 it is exact as long as
// Smin * u * 76 < 2^30; Smin < 2^17 and u <= 100 stay below (tb/test_arithmetic.py tries them all). u * R is formed once
// a frame, from two parts of R that fit a multiplier each. All ones, the saturated word, lies above every cost.
//
// Latency: 3 clocks from `smin_i`; `ratio_i` stands from 3 clocks before it on.

module vista_uniqueness_bound #(
  parameter int unsigned CostW = 15
) (
  input  logic             clk_i,
  input  logic [6:0]       ratio_i,  // u, 0 .. 100
  input  logic [CostW-1:0] smin_i,
  output logic [CostW-1:0] bound_o
);

  localparam int unsigned Shift = 30;
  localparam int unsigned Half = Shift / 2;  // operands fit 18-bit multipliers
  localparam int unsigned GainW = Shift + 1;
  localparam logic [23:0] Reciprocal = 24'd10737419;

  localparam int unsigned PartW = 17;  // of R, unsigned in an 18-bit multiplier

  logic [6:0]       ratio_q;
  logic [PartW+7-1:0] gain_low_q;
  logic [GainW-PartW-1:0] gain_high_q;
  logic [GainW-1:0] gain_q;

  always_ff @(posedge clk_i) begin
    ratio_q     <= ratio_i;
    gain_low_q  <= (PartW + 7)'(ratio_q) * (PartW + 7)'(Reciprocal[PartW-1:0]);
    gain_high_q <= (GainW - PartW)'(ratio_q) * (GainW - PartW)'(Reciprocal[23:PartW]);
    gain_q      <= {gain_high_q, PartW'(0)} + GainW'(gain_low_q);
  end

  logic [CostW-1:0] smin1_q, smin2_q;
  logic [CostW+Half-1:0] low1_q;
  logic [CostW+GainW-Half-1:0] high1_q, sum;
  logic [CostW-1:0]            margin2_q;
  logic [CostW:0]              bound;

  assign sum   = high1_q + (CostW + GainW - Half)'(low1_q[CostW+Half-1:Half]);
  assign bound = {1'b0, smin2_q} + {1'b0, margin2_q};

  always_ff @(posedge clk_i) begin
    low1_q    <= (CostW + Half)'(smin_i) * (CostW + Half)'(gain_q[Half-1:0]);
    high1_q   <= (CostW + GainW - Half)'(smin_i) * (CostW + GainW - Half)'(gain_q[GainW-1:Half]);
    smin1_q   <= smin_i;
    smin2_q   <= smin1_q;
    margin2_q <= sum[CostW+Half-1:Half];
    bound_o   <= bound[CostW] ? '1 : bound[CostW-1:0];
  end

  // u <= 100 leaves the margin within Smin.
  logic unused_sum;
  assign unused_sum = ^{sum[CostW+GainW-Half-1:CostW+Half], sum[Half-1:0], low1_q[Half-1:0]};

endmodule
