// SPDX-License-Identifier: Apache-2.0
// Step 5 of the contract: is there a d with |d - dL| > 1 and S(d) <= T?
//
// Latency: 2 clocks from `cost_i` and `bound_i`; `disparity_i` comes one clock before them, so the neighbourhood of dL
// is decoded by then.

module vista_uniqueness #(
  parameter int unsigned NumDisparities = 32,
  parameter int unsigned CostW = 15,
  localparam int unsigned IndexW = $clog2(NumDisparities)
) (
  input  logic                                  clk_i,
  input  logic [IndexW-1:0]                     disparity_i,
  input  logic [NumDisparities-1:0][CostW-1:0]  cost_i,
  input  logic [CostW-1:0]                      bound_i,
  output logic                                  rival_o,
  output logic [NumDisparities-1:0]             near_o  // |d - dL| <= 1, beside the costs
);

  logic [NumDisparities-1:0] near_q, hit_q;

  assign near_o = near_q;

  for (genvar d = 0; d < NumDisparities; d++) begin : gen_candidate
    always_ff @(posedge clk_i) begin
      near_q[d] <= (disparity_i == IndexW'(d)) | ((d > 0) & (disparity_i == IndexW'(d - 1))) |
          ((d < NumDisparities - 1) & (disparity_i == IndexW'(d + 1)));
      hit_q[d] <= ~near_q[d] & ~(bound_i < cost_i[d]);
    end
  end

  always_ff @(posedge clk_i) rival_o <= |hit_q;

endmodule
