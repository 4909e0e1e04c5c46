// Stands in for vista_memory in the benches: what is undefined there, a word that is read while it is written, comes out
// inverted, so that a use shows. It has no parity, with which the benches take the memory itself.

module vista_memory #(
  parameter int unsigned Width = 16,
  parameter int unsigned Depth = 32,
  parameter bit KeepOld = 1'b0,
  parameter bit Parity = 1'b0,
  localparam int unsigned AddrW = $clog2(Depth)
) (
  input  logic             write_clk_i,
  input  logic             write_i,
  input  logic [AddrW-1:0] write_addr_i,
  input  logic [Width-1:0] write_data_i,

  input  logic             clk_i,
  input  logic             read_i,
  input  logic [AddrW-1:0] read_addr_i,
  output logic [Width-1:0] read_data_o,
  output logic             upset_o
);

  logic [Width-1:0] mem[Depth];

  always_ff @(posedge write_clk_i) begin
    if (write_i) mem[write_addr_i] <= write_data_i;
  end

  always_ff @(posedge clk_i) begin
    if (read_i) begin
      read_data_o <= (!KeepOld && write_i && write_addr_i == read_addr_i) ? ~mem[read_addr_i] : mem[read_addr_i];
    end
  end

  assign upset_o = 1'b0;

  if (Parity) begin : gen_parity
    $fatal(1, "no parity here");
  end

endmodule
