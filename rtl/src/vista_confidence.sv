// SPDX-License-Identifier: Apache-2.0
// Step 8 of the contract: the rival of the winner, how far away it is, and by how much it lost.
//
// A second tree looks at the costs again. Those of the winner and beside it have a further bit at the top, so that every
// other one is smaller.
//
// The margin, the largest k of 0 .. 15 with 32 M > k Smin, M = S(d2) - Smin, is divided out bit by bit: what is left of 2 M
// is doubled; if it is above Smin, the next bit is 1, and Smin is taken off. 2 M > Smin makes ones of all bits.
//
// Latency: SubpixelLatency of the package from `winner_i` and `smin_i`, which come UniquenessLatency after the costs.

module vista_confidence #(
  parameter int unsigned NumDisparities = 32,
  parameter int unsigned CostW = 15,
  localparam int unsigned IndexW = $clog2(NumDisparities),
  localparam int unsigned DistanceW = vista_stereo_pkg::DistanceW,
  localparam int unsigned MarginW = vista_stereo_pkg::MarginW
) (
  input  logic                                  clk_i,
  input  logic [NumDisparities-1:0]             near_i,     // dL and what is beside it
  input  logic [NumDisparities-1:0][CostW-1:0]  cost_i,
  input  logic [IndexW-1:0]                     winner_i,
  input  logic [CostW-1:0]                      smin_i,
  output logic signed [DistanceW-1:0]           distance_o,
  output logic [MarginW-1:0]                    margin_o
);

  import vista_stereo_pkg::*;

  localparam int unsigned RivalLatency = winner_latency(NumDisparities) - UniquenessLatency;  // from the winner
  localparam int unsigned DistanceLatency = SubpixelLatency - RivalLatency;

  if (DistanceLatency < MarginW + 1) begin : gen_bad_latency
    $fatal(1, "SubpixelLatency must leave a clock for the difference and one for each bit of the margin");
  end

  logic [NumDisparities-1:0][CostW:0] other;
  logic [IndexW-1:0] rival, winner;
  logic [CostW-1:0] rival_cost, smin;
  logic unused_top;

  for (genvar d = 0; d < NumDisparities; d++) begin : gen_other
    assign other[d] = {near_i[d], cost_i[d]};
  end

  vista_winner #(
    .NumDisparities (NumDisparities),
    .CostW (CostW + 1)
  ) u_rival (
    .clk_i,
    .cost_i      (other),
    .smin_o      ({unused_top, rival_cost}),
    .disparity_o (rival)
  );

  vista_delay #(
    .Width   (IndexW + CostW),
    .Latency (RivalLatency)
  ) u_winner (
    .clk_i,
    .data_i ({winner_i, smin_i}),
    .data_o ({winner, smin})
  );

  // Saturated; only more than 128 disparities need it.
  localparam int signed Nearest = -(2 ** (DistanceW - 1));
  localparam int signed Farthest = 2 ** (DistanceW - 1) - 1;

  logic signed [IndexW:0]        difference;
  logic signed [DistanceW-1:0]   distance;

  assign difference = $signed({1'b0, rival}) - $signed({1'b0, winner});
  assign distance   = (32'(difference) < Nearest)  ? DistanceW'(Nearest)
                    : (32'(difference) > Farthest) ? DistanceW'(Farthest)
                                                   : DistanceW'(difference);

  vista_delay #(
    .Width   (DistanceW),
    .Latency (DistanceLatency)
  ) u_distance (
    .clk_i,
    .data_i (distance),
    .data_o (distance_o)
  );

  // 1: M; from 2 on a bit each.
  logic [CostW-1:0] more1_q;
  logic [MarginW-1:0][CostW-1:0] rest, least_q;
  logic [MarginW-1:0][CostW:0]   twice;
  logic [MarginW-1:0] above;   // the bits of the margin, the highest first, a clock apart
  logic [MarginW-1:1] full_q;  // 2 M > Smin
  logic [MarginW-1:0] margin;

  always_ff @(posedge clk_i) begin
    more1_q    <= rival_cost - smin;
    least_q[0] <= smin;
    full_q[1]  <= ({more1_q, 1'b0} > {1'b0, least_q[0]});
  end

  assign rest[0] = {more1_q[CostW-2:0], 1'b0};

  for (genvar i = 0; i < MarginW; i++) begin : gen_bit
    assign twice[i] = {rest[i], 1'b0};
    assign above[i] = (twice[i] > {1'b0, least_q[i]});

    if (i < MarginW - 1) begin : gen_next
      logic [CostW-1:0] rest_q;
      logic [i:0]       bits_q;

      always_ff @(posedge clk_i) begin
        rest_q       <= above[i] ? CostW'(twice[i] - {1'b0, least_q[i]}) : twice[i][CostW-1:0];
        least_q[i+1] <= least_q[i];
      end

      if (i == 0) begin : gen_first
        always_ff @(posedge clk_i) bits_q <= above[i];
      end else begin : gen_later
        always_ff @(posedge clk_i) begin
          bits_q      <= {gen_bit[i-1].gen_next.bits_q, above[i]};
          full_q[i+1] <= full_q[i];
        end
      end

      assign rest[i+1] = rest_q;
    end
  end

  assign margin = {gen_bit[MarginW-2].gen_next.bits_q, above[MarginW-1]} | {MarginW{full_q[MarginW-1]}};

  vista_delay #(
    .Width   (MarginW),
    .Latency (DistanceLatency - MarginW)
  ) u_margin (
    .clk_i,
    .data_i (margin),
    .data_o (margin_o)
  );

endmodule
