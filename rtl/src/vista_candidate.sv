// SPDX-License-Identifier: Apache-2.0
// From the costs of a pixel to its candidate disparity: winner, uniqueness and sub-pixel (steps 3, 5, 7); with Confidence
// also distance and margin of its rival (step 8), which are 0 without.
//
// The costs go two ways: through the tree of the winner, and through a delay of the time that the winner and the bound
// of the uniqueness take, after which they are looked at a second time.
//
// Latency: candidate_latency(D) of the package, clocks; one pixel a clock.

module vista_candidate #(
  parameter int unsigned NumDisparities = 32,
  parameter int unsigned BlockSize = 11,
  parameter bit Confidence = 1'b0,
  localparam int unsigned CostW = vista_stereo_pkg::cost_width(BlockSize),
  localparam int unsigned IndexW = $clog2(NumDisparities),
  localparam int unsigned DisparityW = vista_stereo_pkg::DisparityW,
  localparam int unsigned DistanceW = vista_stereo_pkg::DistanceW,
  localparam int unsigned MarginW = vista_stereo_pkg::MarginW
) (
  input  logic                                  clk_i,
  input  logic                                  rst_ni,
  input  logic [6:0]                            uniqueness_ratio_i,
  input  logic [NumDisparities-1:0][CostW-1:0]  cost_i,
  output logic [IndexW-1:0]                     winner_o,
  output logic [CostW-1:0]                      smin_o,
  output logic                                  rival_o,  // not unique
  output logic signed [DisparityW-1:0]          disparity_o,
  output logic signed [DistanceW-1:0]           distance_o,
  output logic [MarginW-1:0]                    margin_o
);

  import vista_stereo_pkg::*;

  localparam int unsigned WinnerLatency = winner_latency(NumDisparities);

  logic [IndexW-1:0] winner;
  logic [CostW-1:0]  smin;

  vista_winner #(
    .NumDisparities (NumDisparities),
    .CostW (CostW)
  ) u_winner (
    .clk_i,
    .cost_i,
    .smin_o      (smin),
    .disparity_o (winner)
  );

  // Aligned with the bound.
  logic [NumDisparities-1:0][CostW-1:0] cost;
  logic [CostW-1:0]                     bound;

  vista_delay #(
    .Width   (NumDisparities * CostW),
    .Latency (WinnerLatency + ThresholdLatency)
  ) u_costs (
    .clk_i,
    .data_i (cost_i),
    .data_o (cost)
  );

  vista_uniqueness_bound #(
    .CostW(CostW)
  ) u_bound (
    .clk_i,
    .rst_ni,
    .ratio_i (uniqueness_ratio_i),
    .smin_i  (smin),
    .bound_o (bound)
  );

  logic [IndexW-1:0] winner_ahead;  // of its costs by one clock
  logic [CostW-1:0] cost_previous, cost_next;
  logic rival;
  logic [NumDisparities-1:0] near;

  vista_delay #(
    .Width   (IndexW),
    .Latency (ThresholdLatency - 1)
  ) u_winner_ahead (
    .clk_i,
    .data_i (winner),
    .data_o (winner_ahead)
  );

  vista_uniqueness #(
    .NumDisparities (NumDisparities),
    .CostW (CostW)
  ) u_uniqueness (
    .clk_i,
    .disparity_i (winner_ahead),
    .cost_i      (cost),
    .bound_i     (bound),
    .rival_o     (rival),
    .near_o      (near)
  );

  vista_neighbours #(
    .NumDisparities (NumDisparities),
    .CostW (CostW)
  ) u_neighbours (
    .clk_i,
    .disparity_i (winner_ahead),
    .cost_i      (cost),
    .previous_o  (cost_previous),
    .next_o      (cost_next)
  );

  logic [IndexW-1:0] winner_subpixel;
  logic [CostW-1:0]  smin_subpixel;

  vista_delay #(
    .Width   (IndexW + CostW),
    .Latency (ThresholdLatency + UniquenessLatency)
  ) u_to_subpixel (
    .clk_i,
    .data_i ({winner, smin}),
    .data_o ({winner_subpixel, smin_subpixel})
  );

  vista_subpixel #(
    .CostW (CostW),
    .IndexW (IndexW)
  ) u_subpixel (
    .clk_i,
    .winner_i    (winner_subpixel),
    .smin_i      (smin_subpixel),
    .previous_i  (cost_previous),
    .next_i      (cost_next),
    .disparity_o
  );

  vista_delay #(
    .Width   (IndexW + CostW + 1),
    .Latency (SubpixelLatency)
  ) u_past_subpixel (
    .clk_i,
    .data_i ({winner_subpixel, smin_subpixel, rival}),
    .data_o ({winner_o, smin_o, rival_o})
  );

  if (Confidence) begin : gen_confidence
    vista_confidence #(
      .NumDisparities (NumDisparities),
      .CostW (CostW)
    ) u_confidence (
      .clk_i,
      .near_i   (near),
      .cost_i   (cost),
      .winner_i (winner_subpixel),
      .smin_i   (smin_subpixel),
      .distance_o,
      .margin_o
    );
  end else begin : gen_no_confidence
    logic unused_near;
    assign unused_near = ^near;
    assign distance_o  = '0;
    assign margin_o    = '0;
  end

endmodule
