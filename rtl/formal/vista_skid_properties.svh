// SPDX-License-Identifier: Apache-2.0
// Properties of vista_skid, inside it: words leave as they came, once each, in order; a waiting word holds still.
//
// f_n is any number: it starts anywhere and never changes. The f_n-th word (modulo 16) is followed through the buffer.

logic             f_started = 1'b0;
logic [3:0]       f_n, f_in, f_out, f_level, f_place;
logic             f_seen, f_waited;
logic [Width-1:0] f_word, f_waiting;

assign f_level = {3'b0, valid_q} + {3'b0, spill_valid_q};
assign f_place = f_n - f_out;  // words before the one that is followed

always_ff @(posedge clk_i) begin
  if (!rst_ni) f_started <= 1'b1;
  f_n       <= f_n;
  if (valid_i & ready_o) f_in <= f_in + 1'b1;
  if (valid_o & ready_i) f_out <= f_out + 1'b1;
  if (valid_i & ready_o & (f_in == f_n)) begin
    f_seen <= 1'b1;
    f_word <= data_i;
  end
  if (valid_o & ready_i & (f_out == f_n)) f_seen <= 1'b0;
  f_waited  <= valid_o & ~ready_i;
  f_waiting <= data_o;
  if (!rst_ni) begin
    f_in     <= '0;
    f_out    <= '0;
    f_seen   <= 1'b0;
    f_waited <= 1'b0;
  end
end

`ifdef VERILATOR
`include "vista_settled.svh"
always_ff @(posedge clk_i) if (f_settled) begin
`else
always_comb begin
  if (!f_started) assume (!rst_ni);
`endif
  if (f_started) begin
    assert (f_in - f_out == f_level);
    assert (!spill_valid_q || valid_q);
    assert (f_seen == (f_place < f_level));
    if (f_seen && f_place == 0) assert (data_q == f_word);
    if (f_seen && f_place == 1) assert (spill_q == f_word);
    if (f_waited) assert (valid_o && data_o == f_waiting);
  end
end
