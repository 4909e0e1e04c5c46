// SPDX-License-Identifier: Apache-2.0
// Fixed delay of a word by `Latency` clocks, 4 or more, in a ring in memory whose word leaves through a register. A reset
// leaves the memory as it is; `since_reset_o` tells that the word that leaves came after it.

module vista_delay_ring #(
  parameter int unsigned Width = 8,
  parameter int unsigned Latency = 16,
  parameter bit Parity = 1'b0
) (
  input  logic             clk_i,
  input  logic             rst_ni,
  input  logic [Width-1:0] data_i,
  output logic [Width-1:0] data_o,
  output logic             since_reset_o,
  output logic             upset_o
);

  // A word is read a turn of Latency - 1 clocks after it was written, just before it is overwritten.
  localparam int unsigned PtrW = $clog2(Latency - 1);

  logic [PtrW-1:0] ptr_q;
  logic turn_end, turned_q;

  assign turn_end = (32'(ptr_q) == Latency - 2);

  always_ff @(posedge clk_i) begin
    ptr_q         <= turn_end ? '0 : ptr_q + 1'b1;
    turned_q      <= turned_q | turn_end;
    since_reset_o <= turned_q;
    if (!rst_ni) begin
      ptr_q         <= '0;
      turned_q      <= 1'b0;
      since_reset_o <= 1'b0;
    end
  end

  vista_memory #(
    .Width   (Width),
    .Depth   (2 ** PtrW),
    .KeepOld (1'b1),
    .Parity  (Parity)
  ) u_memory (
    .write_clk_i  (clk_i),
    .write_i      (1'b1),
    .write_addr_i (ptr_q),
    .write_data_i (data_i),
    .clk_i,
    .read_i       (1'b1),
    .read_addr_i  (ptr_q),
    .read_data_o  (data_o),
    .upset_o
  );

endmodule
