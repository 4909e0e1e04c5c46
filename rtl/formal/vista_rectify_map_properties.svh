// SPDX-License-Identifier: Apache-2.0
// Properties of vista_rectify_map, inside it: no map comes into force of which a point needs more rows than there are, or
// a write was lost; every commit gets one verdict, and only an accepted one changes anything; nothing is written to the
// bank in force, nor to the other one while a frame that began with it is on its way.
//
// Assumed of vista_rectify: frames end in order, so those that began with the bank that was left do before the others; of
// those that are dropped it tells the bank; no more than 10 are on their way.

logic              f_started = 1'b0;
logic              f_far, f_lost, f_commit, f_accepted;
logic              f_writing;
// Frames on their way with the bank in force, and with the other one.
logic [CountW-1:0] f_new, f_old, f_new_now, f_old_now;

assign f_old_now = f_old - CountW'(frame_end_i & (f_old != '0)) - CountW'(frame_drop_i & (frame_bank_i != bank_o));
assign f_new_now = f_new - CountW'(frame_end_i & (f_old == '0)) - CountW'(frame_drop_i & (frame_bank_i == bank_o)) +
    CountW'(frame_begin_i);

always_ff @(posedge clk_i) begin
  if (!rst_ni) f_started <= 1'b1;
  if (write_i) begin
    f_far <= f_far | (int'(signed'(data_i[31:16])) < -int'((NumRows / 2 - 2) * 32)) |
        (int'(signed'(data_i[31:16])) >= int'((NumRows / 2 - 1) * 32));
    f_lost <= f_lost | ~take | full_q;
  end
  if (begin_i) begin
    f_far  <= 1'b0;
    f_lost <= ~ready_o | commit_i;
  end
  f_commit   <= commit_i;
  f_accepted <= accepted;
  f_writing  <= take & ~full_q;
  f_old      <= accepted ? f_old_now + f_new_now : f_old_now;
  f_new      <= accepted ? '0 : f_new_now;
  if (!rst_ni) begin
    f_far      <= 1'b1;
    f_lost     <= 1'b1;
    f_commit   <= 1'b0;
    f_accepted <= 1'b0;
    f_old      <= '0;
    f_new      <= '0;
    f_writing  <= 1'b0;
  end
end

`ifdef VERILATOR
`include "vista_settled.svh"
always_ff @(posedge clk_i) if (f_settled) begin
`else
always_comb begin
  if (!f_started) assume (!rst_ni && !keep_i);
`endif
  if (f_started) begin
    if (frame_begin_i) assume (32'(frames_q) < 10);
    if (frame_end_i && f_old == '0) assume (f_new != '0);
    if (frame_drop_i && frame_bank_i != bank_o) assume (f_old > CountW'(frame_end_i));
    if (frame_drop_i && frame_bank_i == bank_o) assume (f_new > CountW'(frame_end_i && f_old == '0));

    if (accepted) assert (!f_far && !f_lost && full_q);
    assert (2'(accepted_o) + 2'(refused_rows_o) + 2'(refused_size_o) == 2'(f_commit));
    assert (accepted_o == f_accepted);
    assert ((write_o != '0) == f_writing && write_o != 2'b11);
    if (write_o != '0 && !f_accepted) assert (write_addr_o[PointW] == ~bank_o);
    if (take) assert (f_old == '0);

    // What makes these inductive.
    if (loading_q) assert (too_far_q == f_far && ready_o && (!f_lost || wrong_q));
    assert (f_old == old_q && 32'(f_old) + 32'(f_new) == 32'(frames_q) && 32'(frames_q) <= 10);
  end
end
