// SPDX-License-Identifier: Apache-2.0
// Step 6 of the contract, first half: the winner of each right pixel, from the costs of the left ones.
//
// The costs of a right pixel xr lie on a diagonal: S(xr + d, d). A chain of D registers moves with x: stage d holds the
// best of the disparities 0 .. d for xr = x - d, having taken over what stage d-1 held one slot before and compared it
// with S(x, d). Ties go to S(x, d), the larger disparity. What leaves stage D-1 is dR(x - D + 1).
//
// After the last matched pixel of a row the chain is moved on by itself for D-1 *flush* slots without costs, which also
// leave it empty (all ones) for the next row. The next matched pixel lies at least D-1+2r columns away: no clock is lost.
//
// Each slot has an index, modulo the depth of the rings in vista_lr_check. The pixel of index i is decided, all its
// right candidates known, at slot i + D-1.
//
// Latency: 1 clock from `cost_i`; `match_*_i` come one clock before the costs, since the enable of the chain goes to all of
// its registers and has to come straight from one itself.

module vista_right_winner #(
  parameter int unsigned NumDisparities = 32,
  parameter int unsigned CostW = 15,
  parameter int unsigned RingW = 6,
  localparam int unsigned IndexW = $clog2(NumDisparities)
) (
  input  logic clk_i,
  input  logic rst_ni,

  input  logic                                  match_i,
  input  logic                                  match_last_i,  // of the row
  input  logic                                  match_cut_i,
  input  logic [NumDisparities-1:0][CostW-1:0]  cost_i,
  output logic [RingW-1:0]                      match_index_o,  // of the pixel of `cost_i`, at once

  output logic              slot_valid_o,
  output logic [RingW-1:0]  slot_index_o,
  output logic [IndexW-1:0] winner_o,   // of the right pixel that this slot completes
  output logic              decided_o,  // a pixel is decided, D-1 slots after its own
  output logic              cut_o
);

  logic [RingW-1:0] index_q;
  logic [IndexW-1:0] flush_q, age_q;
  logic match_q, match_last_q, cut_q, slot_valid_q, old_enough;

  assign old_enough    = (32'(age_q) == NumDisparities - 1);
  assign match_index_o = index_q;

  always_ff @(posedge clk_i) begin
    match_q      <= match_i;
    match_last_q <= match_i & match_last_i;
    slot_valid_q <= match_i | match_last_q | (32'(flush_q) > 1);
    if (match_i) cut_q <= match_cut_i;

    if (match_last_q) flush_q <= IndexW'(NumDisparities - 1);
    else if (flush_q != '0) flush_q <= flush_q - 1'b1;

    if (slot_valid_q) begin
      index_q <= index_q + 1'b1;
      if (32'(flush_q) == 1) age_q <= '0;
      else if (!old_enough) age_q <= age_q + 1'b1;
    end

    slot_valid_o <= slot_valid_q;
    slot_index_o <= index_q;
    decided_o    <= slot_valid_q & old_enough;
    cut_o        <= cut_q;
    if (!rst_ni) begin
      match_q      <= 1'b0;
      match_last_q <= 1'b0;
      slot_valid_q <= 1'b0;
      flush_q      <= '0;
      age_q        <= '0;
      index_q      <= '0;
      slot_valid_o <= 1'b0;
      decided_o    <= 1'b0;
    end
  end

  logic [NumDisparities-1:0][CostW-1:0]  best_q;
  logic [NumDisparities-1:0][IndexW-1:0] best_index_q;

  for (genvar d = 0; d < NumDisparities; d++) begin : gen_stage
    if (d == 0) begin : gen_first
      assign best_index_q[d] = '0;
      always_ff @(posedge clk_i) begin
        if (slot_valid_q) best_q[d] <= match_q ? cost_i[d] : '1;
        if (!rst_ni) best_q[d] <= '1;
      end
    end else begin : gen_next
      logic better;
      assign better = match_q & ~(best_q[d-1] < cost_i[d]);
      always_ff @(posedge clk_i) begin
        if (slot_valid_q) begin
          best_q[d]       <= better ? cost_i[d] : best_q[d-1];
          best_index_q[d] <= better ? IndexW'(d) : best_index_q[d-1];
        end
        if (!rst_ni) best_q[d] <= '1;
      end
    end
  end

  assign winner_o = best_index_q[NumDisparities-1];

`ifdef VISTA_ASSERT
  `include "vista_right_winner_properties.svh"
`endif

endmodule
