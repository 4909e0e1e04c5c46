// SPDX-License-Identifier: Apache-2.0
// A line of words in memory, written and read at any column.
//
// Latency: 2 clocks from `read_col_i` to `read_data_o`. The second register keeps the slow output of a block RAM off
// the logic behind it. A word that is read while it is written is undefined: no user needs it.

module vista_line_store #(
  parameter int unsigned Width = 16,
  parameter int unsigned Depth = 1024,
  parameter bit Parity = 1'b0,
  localparam int unsigned ColW = $clog2(Depth)
) (
  input  logic             clk_i,
  input  logic             clear_i,  // the word that comes out next reads as zero
  input  logic             write_i,
  input  logic [ColW-1:0]  write_col_i,
  input  logic [Width-1:0] write_data_i,
  input  logic [ColW-1:0]  read_col_i,
  output logic [Width-1:0] read_data_o,
  output logic             upset_o
);

  logic [Width-1:0] read;

  vista_memory #(
    .Width  (Width),
    .Depth  (Depth),
    .Parity (Parity)
  ) u_memory (
    .write_clk_i  (clk_i),
    .write_i,
    .write_addr_i (write_col_i),
    .write_data_i,
    .clk_i,
    .read_i       (1'b1),
    .read_addr_i  (read_col_i),
    .read_data_o  (read),
    .upset_o
  );

  always_ff @(posedge clk_i) begin
    read_data_o <= clear_i ? '0 : read;
  end

endmodule
