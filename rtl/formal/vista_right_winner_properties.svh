// SPDX-License-Identifier: Apache-2.0
// Properties of vista_right_winner, inside it: the last slot comes at most D clocks after the last match. Together with
// the fixed latencies before and behind it this bounds what is on its way when the framer is stopped
// (`results_in_flight` of the package), which vista_result_fifo counts on.

logic            f_started = 1'b0;
logic [IndexW:0] f_since;  // clocks since a match, saturating

always_ff @(posedge clk_i) begin
  if (!rst_ni) f_started <= 1'b1;
  if (match_i) f_since <= (IndexW + 1)'(1);
  else if (32'(f_since) <= NumDisparities) f_since <= f_since + 1'b1;
  if (!rst_ni) f_since <= (IndexW + 1)'(NumDisparities + 1);
end

`ifdef VERILATOR
`include "vista_settled.svh"
always_ff @(posedge clk_i) if (f_settled) begin
`else
always_comb begin
  if (!f_started) assume (!rst_ni);
`endif
  if (f_started) begin
    if (slot_valid_q) assert (32'(f_since) <= NumDisparities);
    assert (slot_valid_q == (match_q || flush_q != '0));
    assert (match_q == (32'(f_since) == 1) && (match_q || !match_last_q));
    if (flush_q != '0) assert (32'(f_since) + 32'(flush_q) <= NumDisparities + 1);
    assert (f_since != '0 && 32'(f_since) <= NumDisparities + 1);
  end
end
