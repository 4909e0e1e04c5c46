// One line of words, written and read at any column.
//
// Latency: 2 clocks from `read_col_i` to `read_data_o`. The second register keeps the slow output of a block RAM off
// the logic behind it. A word written and read in the same clock gives the old one.

module vista_line_store #(
  parameter int unsigned Width = 16,
  parameter int unsigned Depth = 1024,
  localparam int unsigned ColW = $clog2(Depth)
) (
  input  logic             clk_i,
  input  logic             write_i,
  input  logic [ColW-1:0]  write_col_i,
  input  logic [Width-1:0] write_data_i,
  input  logic [ColW-1:0]  read_col_i,
  output logic [Width-1:0] read_data_o
);

  logic [Width-1:0] mem [Depth];
  logic [Width-1:0] read_q;

  always_ff @(posedge clk_i) begin
    if (write_i) mem[write_col_i] <= write_data_i;
  end

  always_ff @(posedge clk_i) begin
    read_q      <= mem[read_col_i];
    read_data_o <= read_q;
  end

endmodule
