// One word of many, by number, in two steps: within groups of eight, then among the groups.
//
// Latency: 2 clocks from `word_i` and `index_i`.

module vista_select #(
  parameter int unsigned NumWords = 32,
  parameter int unsigned Width = 15,
  localparam int unsigned IndexW = $clog2(NumWords)
) (
  input  logic                            clk_i,
  input  logic [IndexW-1:0]               index_i,
  input  logic [NumWords-1:0][Width-1:0]  word_i,
  output logic [Width-1:0]                word_o
);

  localparam int unsigned NumGroups = (NumWords + 7) / 8;
  localparam int unsigned GroupW = $clog2(NumGroups);

  logic [NumGroups*8-1:0][Width-1:0] padded;
  logic [NumGroups-1:0][Width-1:0]   group_q;
  logic [GroupW-1:0]                 group_index_q;

  assign padded = (NumGroups * 8 * Width)'(word_i);

  for (genvar g = 0; g < NumGroups; g++) begin : gen_group
    logic [7:0][Width-1:0] members;
    assign members = padded[g*8+:8];
    always_ff @(posedge clk_i) group_q[g] <= members[index_i[2:0]];
  end

  always_ff @(posedge clk_i) begin
    group_index_q <= index_i[IndexW-1:3];
    word_o        <= group_q[group_index_q];
  end

endmodule
