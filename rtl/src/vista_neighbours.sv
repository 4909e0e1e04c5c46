// SPDX-License-Identifier: Apache-2.0
// The costs beside the winner for step 7: p = S(dL - 1), n = S(dL + 1). At an end of the range the inner one is both.
//
// The two lie 2 apart, so one of them has d mod 4 in {0, 1}, the other in {2, 3}. Each of these *lanes* of D / 2 costs
// gives one word, and the two are put in order at the end: half the multiplexers of two choices among all costs.
// A lane chooses within groups of eight first, then among the groups.
//
// Latency: 2 clocks from `cost_i`; `disparity_i` comes one clock before it.

module vista_neighbours #(
  parameter int unsigned NumDisparities = 32,
  parameter int unsigned CostW = 15,
  localparam int unsigned IndexW = $clog2(NumDisparities)
) (
  input  logic                                  clk_i,
  input  logic [IndexW-1:0]                     disparity_i,  // dL
  input  logic [NumDisparities-1:0][CostW-1:0]  cost_i,
  output logic [CostW-1:0]                      previous_o,
  output logic [CostW-1:0]                      next_o
);

  localparam int unsigned LaneWords = NumDisparities / 2;
  localparam int unsigned PlaceW = IndexW - 1;  // of a word within its lane
  localparam int unsigned NumGroups = (LaneWords > 8) ? LaneWords / 8 : 2;
  localparam int unsigned GroupW = $clog2(NumGroups);

  // Both neighbours of an even dL are odd and the other way round. With dL = 4 k + 3 the next one has 4 (k + 1), with
  // dL = 4 k the previous one 4 (k - 1) + 3.
  logic [1:0][PlaceW-1:0] place_q;
  logic previous_high, previous_high_q, previous_high1_q, next_high_q, next_high1_q;

  assign previous_high = (disparity_i[1] == disparity_i[0]);  // in the lane of {2, 3}

  always_ff @(posedge clk_i) begin
    place_q[0]       <= {disparity_i[IndexW-1:2] + (IndexW - 2)'(disparity_i[1:0] == 2'd3), ~disparity_i[0]};
    place_q[1]       <= {disparity_i[IndexW-1:2] - (IndexW - 2)'(disparity_i[1:0] == 2'd0), ~disparity_i[0]};
    previous_high_q  <= previous_high & (disparity_i != '0);
    next_high_q      <= ~previous_high | (32'(disparity_i) == NumDisparities - 1);
    previous_high1_q <= previous_high_q;
    next_high1_q     <= next_high_q;
  end

  logic [1:0][CostW-1:0] word;

  for (genvar lane = 0; lane < 2; lane++) begin : gen_lane
    logic [NumGroups*8-1:0][CostW-1:0] members;
    logic [NumGroups-1:0][CostW-1:0]   group_q;
    logic [GroupW-1:0]                 group_index_q;

    for (genvar i = 0; i < NumGroups * 8; i++) begin : gen_member
      assign members[i] = (i < LaneWords) ? cost_i[(i/2*4+lane*2+i%2)%NumDisparities] : '0;
    end

    for (genvar g = 0; g < NumGroups; g++) begin : gen_group
      logic [7:0][CostW-1:0] eight;
      assign eight = members[g*8+:8];
      always_ff @(posedge clk_i) group_q[g] <= eight[place_q[lane][2:0]];
    end

    always_ff @(posedge clk_i) group_index_q <= GroupW'(place_q[lane] >> 3);

    assign word[lane] = group_q[group_index_q];
  end

  always_ff @(posedge clk_i) begin
    previous_o <= previous_high1_q ? word[1] : word[0];
    next_o     <= next_high1_q ? word[1] : word[0];
  end

endmodule
