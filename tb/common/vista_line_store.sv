// Stands in for vista_line_store in the benches: what is undefined there, a word that is read while it is written, comes
// out inverted, so that a use shows.

module vista_line_store #(
  parameter int unsigned Width = 16,
  parameter int unsigned Depth = 1024,
  localparam int unsigned ColW = $clog2(Depth)
) (
  input  logic             clk_i,
  input  logic             clear_i,
  input  logic             write_i,
  input  logic [ColW-1:0]  write_col_i,
  input  logic [Width-1:0] write_data_i,
  input  logic [ColW-1:0]  read_col_i,
  output logic [Width-1:0] read_data_o
);

  logic [Width-1:0] mem[Depth];
  logic [Width-1:0] read_q;

  always_ff @(posedge clk_i) begin
    if (write_i) mem[write_col_i] <= write_data_i;
    read_q      <= (write_i && write_col_i == read_col_i) ? ~mem[read_col_i] : mem[read_col_i];
    read_data_o <= clear_i ? '0 : read_q;
  end

endmodule
