// SPDX-License-Identifier: Apache-2.0
// Step 6 of the contract, second half: |dL - dR(x - dL)| <= lr_max_diff, and the verdict on each pixel.
//
// Candidates wait in a ring until the D-1 slots after them have passed, right winners in another; both are addressed by
// slot index (see vista_right_winner). The right winner of x - dL left the chain at slot i + D-1 - dL, i the index of x.
//
// A pixel that is decided by a cut slot is invalid, and as if unmatched: its right candidates were not all there.
//
// Latency: 6 clocks from the slot that decides a pixel, after `check_delay` of the package.

module vista_lr_check #(
  parameter int unsigned NumDisparities = 32,
  parameter int unsigned CostW = 15,
  parameter int unsigned RingW = 6,
  parameter bit Parity = 1'b0,
  localparam int unsigned IndexW = $clog2(NumDisparities),
  localparam int unsigned DisparityW = vista_stereo_pkg::DisparityW,
  localparam int unsigned SminW = vista_stereo_pkg::SminW
) (
  input  logic clk_i,
  input  logic rst_ni,

  input  logic       lr_enable_i,
  input  logic [7:0] lr_max_diff_i,

  input  logic                         candidate_valid_i,
  input  logic [RingW-1:0]             candidate_index_i,
  input  logic                         candidate_ok_i,
  input  logic [IndexW-1:0]            candidate_winner_i,
  input  logic [CostW-1:0]             candidate_smin_i,
  input  logic signed [DisparityW-1:0] candidate_disparity_i,

  input  logic              slot_valid_i,
  input  logic [RingW-1:0]  slot_index_i,
  input  logic [IndexW-1:0] right_winner_i,
  input  logic              decided_i,
  input  logic              cut_i,

  output logic                         valid_o,
  output logic signed [DisparityW-1:0] disparity_o,
  output logic [SminW-1:0]             smin_o,
  output logic upset_o  // of a memory
);

  import vista_stereo_pkg::*;

  localparam int unsigned CheckDelay = check_delay(NumDisparities);

  logic decided0, cut0;
  logic [RingW-1:0] index0;

  if (CheckDelay == 0) begin : gen_at_once
    assign {decided0, cut0, index0} = {decided_i, cut_i, slot_index_i};
  end else begin : gen_wait
    logic [CheckDelay-1:0] decided_q, cut_q;
    logic [CheckDelay-1:0][RingW-1:0] index_q;

    always_ff @(posedge clk_i) begin
      decided_q <= CheckDelay'({decided_q, decided_i});
      cut_q     <= CheckDelay'({cut_q, cut_i});
      index_q   <= (CheckDelay * RingW)'({index_q, slot_index_i});
      if (!rst_ni) decided_q <= '0;
    end

    assign {decided0, cut0, index0} = {decided_q[CheckDelay-1], cut_q[CheckDelay-1], index_q[CheckDelay-1]};
  end

  // 1, 2: the candidate comes out of its ring.
  logic decided1_q, decided2_q, decided3_q, decided4_q, decided5_q;
  logic cut1_q, cut2_q, cut3_q, cut4_q, cut5_q;
  logic [RingW-1:0] index1_q, index2_q;
  logic ok2, ok3_q, ok4_q, ok5_q;
  logic [IndexW-1:0] winner2, winner3_q, winner4_q, right_winner4, difference5_q;
  logic [CostW-1:0] smin2, smin3_q, smin4_q, smin5_q;
  logic signed [DisparityW-1:0] disparity2, disparity3_q, disparity4_q, disparity5_q;

  logic candidate_upset, right_upset;
  assign upset_o = candidate_upset | right_upset;

  vista_line_store #(
    .Width (1 + IndexW + CostW + DisparityW),
    .Depth (2 ** RingW),
    .Parity(Parity)
  ) u_candidates (
    .clk_i,
    .clear_i      (1'b0),
    .write_i      (candidate_valid_i),
    .write_col_i  (candidate_index_i),
    .write_data_i ({candidate_ok_i, candidate_winner_i, candidate_smin_i, candidate_disparity_i}),
    .read_col_i   (index0 - RingW'(NumDisparities - 1)),
    .read_data_o  ({ok2, winner2, smin2, disparity2}),
    .upset_o      (candidate_upset)
  );

  // 3, 4: the right winner out of the other.
  vista_line_store #(
    .Width (IndexW),
    .Depth (2 ** RingW),
    .Parity(Parity)
  ) u_right_winners (
    .clk_i,
    .clear_i      (1'b0),
    .write_i      (slot_valid_i),
    .write_col_i  (slot_index_i),
    .write_data_i (right_winner_i),
    .read_col_i   (index2_q - RingW'(winner2)),
    .read_data_o  (right_winner4),
    .upset_o      (right_upset)
  );

  always_ff @(posedge clk_i) begin
    decided1_q   <= decided0;
    decided2_q   <= decided1_q;
    decided3_q   <= decided2_q;
    decided4_q   <= decided3_q;
    decided5_q   <= decided4_q;
    cut1_q       <= cut0;
    cut2_q       <= cut1_q;
    index1_q     <= index0;
    index2_q     <= index1_q;
    cut3_q       <= cut2_q;
    cut4_q       <= cut3_q;
    cut5_q       <= cut4_q;
    ok3_q        <= ok2 & ~cut2_q;
    ok4_q        <= ok3_q;
    ok5_q        <= ok4_q;
    winner3_q    <= winner2;
    winner4_q    <= winner3_q;
    smin3_q      <= smin2;
    smin4_q      <= smin3_q;
    smin5_q      <= smin4_q;
    disparity3_q <= disparity2;
    disparity4_q <= disparity3_q;
    disparity5_q <= disparity4_q;
    // 5: |dL - dR|; 6: the verdict.
    difference5_q <= (winner4_q > right_winner4) ? winner4_q - right_winner4 : right_winner4 - winner4_q;
    valid_o       <= decided5_q;
    disparity_o   <= (ok5_q & ~(lr_enable_i & (8'(difference5_q) > lr_max_diff_i))) ? disparity5_q
                                                                                   : DisparityW'(Invalid);
    smin_o        <= (cut5_q | (32'(smin5_q) > 32'(SminW'('1)))) ? '1 : SminW'(smin5_q);
    if (!rst_ni) begin
      decided1_q <= 1'b0;
      decided2_q <= 1'b0;
      decided3_q <= 1'b0;
      decided4_q <= 1'b0;
      decided5_q <= 1'b0;
      valid_o    <= 1'b0;
    end
  end

endmodule
