// SPDX-License-Identifier: Apache-2.0
// Fixed delay of a word by `Latency` clocks, without valid or enable, in registers, of which every logic cell has one to
// spare. A long one is a vista_delay_ring.

module vista_delay #(
  parameter int unsigned Width = 8,
  parameter int unsigned Latency = 4
) (
  input  logic             clk_i,
  input  logic [Width-1:0] data_i,
  output logic [Width-1:0] data_o
);

  logic [Latency-1:0][Width-1:0] data_q;

  always_ff @(posedge clk_i) begin
    data_q[0] <= data_i;
    for (int unsigned i = 1; i < Latency; i++) data_q[i] <= data_q[i-1];
  end

  assign data_o = data_q[Latency-1];

endmodule
