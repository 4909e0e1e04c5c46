// SPDX-License-Identifier: Apache-2.0
// Two-entry stream buffer: cuts every combinational path between its two sides at one word a clock.
//
// Latency 1 clock. `ready_o` and `valid_o` come straight from registers.

module vista_skid #(
  parameter int unsigned Width = 8
) (
  input  logic             clk_i,
  input  logic             rst_ni,
  input  logic             valid_i,
  output logic             ready_o,
  input  logic [Width-1:0] data_i,
  output logic             valid_o,
  input  logic             ready_i,
  output logic [Width-1:0] data_o
);

  logic valid_q, spill_valid_q;
  logic [Width-1:0] data_q, spill_q;

  assign ready_o = ~spill_valid_q;
  assign valid_o = valid_q;
  assign data_o  = data_q;

  always_ff @(posedge clk_i) begin
    if (~valid_q | ready_i) begin
      valid_q <= spill_valid_q | valid_i;
      data_q  <= spill_valid_q ? spill_q : data_i;
      spill_valid_q <= 1'b0;
    end else if (valid_i & ready_o) begin
      spill_valid_q <= 1'b1;
    end
    if (ready_o) spill_q <= data_i;
    if (!rst_ni) begin
      valid_q       <= 1'b0;
      spill_valid_q <= 1'b0;
    end
  end

`ifdef VISTA_ASSERT
  `include "vista_skid_properties.svh"
`endif

endmodule
