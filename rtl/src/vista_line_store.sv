// SPDX-License-Identifier: Apache-2.0
// A line of words in block memory, written and read at any column; one of up to 32 words is in distributed
// memory, as it would leave most of a block unused, of several blocks if its words are wide.
//
// Latency: 2 clocks from `read_col_i` to `read_data_o`. The second register keeps the slow output of a block RAM off
// the logic behind it. A word that is read while it is written is undefined: no user needs it, and the logic that would
// define it is saved (`no_rw_check`). The benches put tb/common/vista_line_store.sv in its place, of which it comes out
// inverted, so that a use would show.

module vista_line_store #(
  parameter int unsigned Width = 16,
  parameter int unsigned Depth = 1024,
  localparam int unsigned ColW = $clog2(Depth)
) (
  input  logic             clk_i,
  input  logic             clear_i,  // the word that comes out next reads as zero
  input  logic             write_i,
  input  logic [ColW-1:0]  write_col_i,
  input  logic [Width-1:0] write_data_i,
  input  logic [ColW-1:0]  read_col_i,
  output logic [Width-1:0] read_data_o
);

  (* no_rw_check, ram_style = Depth <= 32 ? "distributed" : "block" *)
  logic [Width-1:0] mem [Depth];
  logic [Width-1:0] read_q;

  always_ff @(posedge clk_i) begin
    if (write_i) mem[write_col_i] <= write_data_i;
  end

  always_ff @(posedge clk_i) begin
    read_q <= mem[read_col_i];
    read_data_o <= clear_i ? '0 : read_q;
  end

endmodule
