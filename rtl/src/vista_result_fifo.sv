// SPDX-License-Identifier: Apache-2.0
// First-in first-out buffer of results in block memory, behind a pipeline that cannot stop.
//
// The writer has no `ready`: `go_o` falls early enough that what is still on its way, at most `InFlight` words, fits.
// The reader sees up to four words ahead in registers, so one word a clock leaves although the memory takes two clocks.
// How many words there are is the difference of the places of writing and reading, and counted nowhere else: whatever
// the places are, the buffer is in order again once it was read empty to there.
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
  localparam int unsigned AheadW = 2;
  localparam int unsigned Ahead = 2 ** AheadW;

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
  logic [AheadW:0] read1_ptr_q;  // the place of reading, as the words come out that were read there
  logic [AheadW-1:0] read2_ptr_q;
  logic [AheadW:0] out_ptr_q, out_ptr, claimed;

  // Read as soon as a place ahead is free; places are claimed when the read begins.
  assign claimed = read_ptr_q[AheadW:0] - out_ptr_q;
  assign read    = (write_ptr_q != read_ptr_q) & ~claimed[AheadW];
  assign take    = valid_o & ready_i;
  assign out_ptr = out_ptr_q + (AheadW + 1)'(take);
  assign data_o  = ahead_q[out_ptr_q[AheadW-1:0]];

  always_ff @(posedge clk_i) begin
    if (write_i) write_ptr_q <= write_ptr_q + 1'b1;
    if (read) read_ptr_q <= read_ptr_q + 1'b1;
    level_q <= write_ptr_q - read_ptr_q;
    go_o    <= 32'(level_q) < Depth - InFlight;

    read1_q     <= read;
    read2_q     <= read1_q;
    read1_ptr_q <= read_ptr_q[AheadW:0];
    read2_ptr_q <= read1_ptr_q[AheadW-1:0];
    if (read2_q) ahead_q[read2_ptr_q] <= read_data;
    out_ptr_q <= out_ptr;
    valid_o   <= (read1_ptr_q != out_ptr);

    if (!rst_ni) begin
      write_ptr_q <= '0;
      read_ptr_q  <= '0;
      level_q     <= '0;
      go_o        <= 1'b0;
      read1_q     <= 1'b0;
      read2_q     <= 1'b0;
      read1_ptr_q <= '0;
      read2_ptr_q <= '0;
      out_ptr_q   <= '0;
      valid_o     <= 1'b0;
    end
  end

`ifdef VISTA_ASSERT
  `include "vista_result_fifo_properties.svh"
`endif

endmodule
