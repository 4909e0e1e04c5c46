// SPDX-License-Identifier: Apache-2.0
// Step 3 of the contract: the disparity of smallest cost, ties to the larger one.
//
// A tree of comparisons, one level a clock. Leaves beyond D - 1 hold the all-ones word, which no cost reaches.
//
// Latency: clog2(D) clocks.

module vista_winner #(
  parameter int unsigned NumDisparities = 32,
  parameter int unsigned CostW = 15,
  localparam int unsigned IndexW = $clog2(NumDisparities)
) (
  input  logic                                  clk_i,
  input  logic [NumDisparities-1:0][CostW-1:0]  cost_i,
  output logic [CostW-1:0]                      smin_o,
  output logic [IndexW-1:0]                     disparity_o
);

  localparam int unsigned NumLeaves = 2 ** IndexW;

  for (genvar level = 0; level <= IndexW; level++) begin : gen_level
    localparam int unsigned NumNodes = NumLeaves >> level;
    logic [NumNodes-1:0][CostW-1:0]  cost;
    logic [NumNodes-1:0][IndexW-1:0] index;

    if (level == 0) begin : gen_leaves
      for (genvar i = 0; i < NumLeaves; i++) begin : gen_leaf
        assign index[i] = IndexW'(i);
        if (i < NumDisparities) begin : gen_used
          assign cost[i] = cost_i[i];
        end else begin : gen_spare
          assign cost[i] = '1;
        end
      end
    end else begin : gen_nodes
      for (genvar i = 0; i < NumNodes; i++) begin : gen_node
        logic upper;
        assign upper = ~(gen_level[level-1].cost[2*i] < gen_level[level-1].cost[2*i+1]);
        always_ff @(posedge clk_i) begin
          cost[i]  <= upper ? gen_level[level-1].cost[2*i+1] : gen_level[level-1].cost[2*i];
          index[i] <= upper ? gen_level[level-1].index[2*i+1] : gen_level[level-1].index[2*i];
        end
      end
    end
  end

  assign smin_o      = gen_level[IndexW].cost[0];
  assign disparity_o = gen_level[IndexW].index[0];

endmodule
