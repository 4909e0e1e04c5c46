// SPDX-License-Identifier: Apache-2.0
// Properties of vista_result_fifo, inside it: it never overflows, and as many words leave as came.
//
// Assumed of the writer, as vista_stereo_core arranges it: no word comes later than InFlight - 3 clocks after `go_o` was
// last up.

logic                f_started = 1'b0;
logic [PtrW:0]       f_age;      // clocks since `go_o` was up, saturating
logic [PtrW:0]       f_stored;   // in memory
logic [PtrW:0]       f_stored1;  // the clock before
logic [PtrW+1:0]     f_balance;  // words that came, less those that left
logic [2:0]          f_ahead, f_claimed;  // words that are ahead, and those that will be

assign f_ahead   = read1_ptr_q - {2'b0, read2_q} - out_ptr_q;
assign f_claimed = f_ahead + {2'b0, read1_q} + {2'b0, read2_q};

always_ff @(posedge clk_i) begin
  if (!rst_ni) f_started <= 1'b1;
  if (go_o) f_age <= (PtrW + 1)'(1);
  else if (32'(f_age) <= InFlight - 3) f_age <= f_age + 1'b1;
  f_stored  <= f_stored + (PtrW + 1)'(write_i) - (PtrW + 1)'(read);
  f_stored1 <= f_stored;
  f_balance <= f_balance + (PtrW + 2)'(write_i) - (PtrW + 2)'(take);
  if (!rst_ni) begin
    f_age     <= (PtrW + 1)'(InFlight - 2);
    f_stored1 <= '0;
    f_stored  <= '0;
    f_balance <= '0;
  end
end

`ifdef VERILATOR
`include "vista_settled.svh"
always_ff @(posedge clk_i) if (f_settled) begin
`else
always_comb begin
  if (!f_started) assume (!rst_ni);
`endif
  if (f_started) assume (!write_i || go_o || 32'(f_age) <= InFlight - 3);
  if (f_started) begin
    assert (32'(f_stored) < Depth);
    assert (level_q == f_stored1[PtrW-1:0] && 32'(f_stored1) < Depth);
    assert (f_stored <= f_stored1 + 1'b1 && f_age != '0 && 32'(f_age) <= InFlight - 2);
    assert (32'(f_stored) <= Depth - InFlight + 1 + (go_o ? 0 : 32'(f_age)));
    assert (f_stored[PtrW-1:0] == write_ptr_q - read_ptr_q);
    assert (32'(f_claimed) <= Ahead && 32'(f_ahead) <= Ahead);
    assert (claimed == f_claimed && valid_o == (f_ahead != '0));
    assert (read1_ptr_q[1:0] == read2_ptr_q + 2'(read2_q) && read_ptr_q[2:0] == read1_ptr_q + 3'(read1_q));
    assert (32'(f_balance) == 32'(f_stored) + 32'(f_claimed));
  end
end
