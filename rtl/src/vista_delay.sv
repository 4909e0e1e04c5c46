// SPDX-License-Identifier: Apache-2.0
// Fixed delay of a word by `Latency` clocks, without valid or enable.
//
// Up to 12 clocks it is made of registers, of which every logic cell has one to spare, beyond of distributed memory: a
// ring whose word leaves through a register.

module vista_delay #(
  parameter int unsigned Width = 8,
  parameter int unsigned Latency = 4
) (
  input  logic             clk_i,
  input  logic             rst_ni,
  input  logic [Width-1:0] data_i,
  output logic [Width-1:0] data_o
);

  if (Latency <= 12) begin : gen_registers
    logic [Latency-1:0][Width-1:0] data_q;

    always_ff @(posedge clk_i) begin
      data_q[0] <= data_i;
      for (int unsigned i = 1; i < Latency; i++) data_q[i] <= data_q[i-1];
    end

    assign data_o = data_q[Latency-1];

    logic unused_rst;
    assign unused_rst = rst_ni;
  end else begin : gen_ring
    // A word is read a turn of Latency - 1 clocks after it was written, just before it is overwritten.
    localparam int unsigned PtrW = $clog2(Latency - 1);

    logic [Width-1:0] mem [2**PtrW];
    logic [PtrW-1:0]  ptr_q;

    always_ff @(posedge clk_i) begin
      ptr_q <= (32'(ptr_q) == Latency - 2) ? '0 : ptr_q + 1'b1;
      if (!rst_ni) ptr_q <= '0;
    end

    always_ff @(posedge clk_i) begin
      mem[ptr_q] <= data_i;
    end

    always_ff @(posedge clk_i) begin
      data_o <= mem[ptr_q];
    end
  end

endmodule
