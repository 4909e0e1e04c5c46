// SPDX-License-Identifier: Apache-2.0
// First-in first-out buffer of results in block memory, behind a pipeline that cannot stop.
//
// The writer has no `ready`: `go_o` falls early enough that what is still on its way, at most `InFlight` words, fits.
// The reader sees up to four words ahead in registers, so one word a clock leaves although the memory takes two clocks.
//
// Latency: 5 clocks from a write to `valid_o`.

module vista_result_fifo #(
  parameter int unsigned Width = 29,
  parameter int unsigned InFlight = 81,
  parameter bit Parity = 1'b0,
  localparam int unsigned PtrW = $clog2(2 * InFlight)
) (
  input  logic             clk_i,
  input  logic             rst_ni,
  input  logic             write_i,
  input  logic [Width-1:0] data_i,
  output logic             go_o,
  output logic             valid_o,
  input  logic             ready_i,
  output logic [Width-1:0] data_o,
  output logic upset_o  // of a memory
);

  localparam int unsigned Depth = 2 ** PtrW;
  localparam int unsigned Ahead = 4;

  logic [PtrW-1:0] write_ptr_q, read_ptr_q, level_q;
  logic read, read1_q, read2_q, take;
  logic [Width-1:0] read_data;

  vista_line_store #(
    .Width (Width),
    .Depth (Depth),
    .Parity(Parity)
  ) u_words (
    .clk_i,
    .clear_i      (1'b0),
    .write_i,
    .write_col_i  (write_ptr_q),
    .write_data_i (data_i),
    .read_col_i   (read_ptr_q),
    .read_data_o  (read_data),
    .upset_o      (upset_o)
  );

  logic [Ahead-1:0][Width-1:0] ahead_q;
  logic [1:0] ahead_write_q, ahead_read_q;
  logic [2:0] ahead_level_q, ahead_claimed_q;

  // Read as soon as a place ahead is free; places are claimed when the read begins.
  assign read    = (write_ptr_q != read_ptr_q) & (32'(ahead_claimed_q) != Ahead);
  assign take    = valid_o & ready_i;
  assign valid_o = (ahead_level_q != '0);
  assign data_o  = ahead_q[ahead_read_q];

  always_ff @(posedge clk_i) begin
    if (write_i) write_ptr_q <= write_ptr_q + 1'b1;
    if (read) read_ptr_q <= read_ptr_q + 1'b1;
    level_q <= write_ptr_q - read_ptr_q;
    go_o    <= 32'(level_q) < Depth - InFlight;

    read1_q <= read;
    read2_q <= read1_q;
    if (read2_q) begin
      ahead_q[ahead_write_q] <= read_data;
      ahead_write_q          <= ahead_write_q + 1'b1;
    end
    if (take) ahead_read_q <= ahead_read_q + 1'b1;
    ahead_level_q   <= ahead_level_q + 3'(read2_q) - 3'(take);
    ahead_claimed_q <= ahead_claimed_q + 3'(read) - 3'(take);

    if (!rst_ni) begin
      write_ptr_q     <= '0;
      read_ptr_q      <= '0;
      level_q         <= '0;
      go_o            <= 1'b0;
      read1_q         <= 1'b0;
      read2_q         <= 1'b0;
      ahead_write_q   <= '0;
      ahead_read_q    <= '0;
      ahead_level_q   <= '0;
      ahead_claimed_q <= '0;
    end
  end

`ifdef VISTA_ASSERT
  `include "vista_result_fifo_properties.svh"
`endif

endmodule
