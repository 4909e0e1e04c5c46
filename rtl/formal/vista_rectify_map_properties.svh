// SPDX-License-Identifier: Apache-2.0
// Properties of vista_rectify_map, inside it: no map comes into force of which a point needs more rows than there are, or
// a write was lost; every commit gets one verdict, and only an accepted one changes anything; nothing is written to the
// bank in force, nor to the other one while a frame that began with it is on its way.
//
// Assumed of vista_rectify: a frame is that of the bank two clocks before `frame_begin_i`; frames end in order, and no
// more than 5 are on their way.

logic              f_started = 1'b0;
logic              f_far, f_lost, f_bank1, f_bank2, f_commit, f_accepted;
logic              f_writing;
logic [CountW-1:0] f_old;  // frames on their way that do not have the bank in force
logic [CountW-1:0] f_old_now;

// A flip makes all of them old; one that begins just after it is old, too.
assign f_old_now = f_old + CountW'(frame_begin_i & (f_bank2 != bank_o)) - CountW'(frame_end_i & (f_old != '0));

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
  f_bank1    <= bank_o;
  f_bank2    <= f_bank1;
  f_commit   <= commit_i;
  f_accepted <= accepted;
  f_writing  <= take & ~full_q;
  f_old      <= accepted ? frames : f_old_now;
  if (!rst_ni) begin
    f_far      <= 1'b1;
    f_lost     <= 1'b1;
    f_commit   <= 1'b0;
    f_accepted <= 1'b0;
    f_old      <= '0;
    f_writing  <= 1'b0;
  end
  if (!rst_ni & !keep_i) begin
    f_bank1 <= 1'b0;
    f_bank2 <= 1'b0;
  end
end

`ifdef VERILATOR
`include "vista_settled.svh"
always_ff @(posedge clk_i) if (f_settled) begin
`else
always_comb begin
  if (!f_started) assume (!rst_ni && !keep_i);
  if (frame_begin_i) assume (32'(frames_q) < 5 && frame_bank_i == f_bank2);
  if (frame_end_i) assume (frames_q != '0);
`endif
  if (f_started) begin
    if (accepted) assert (!f_far && !f_lost && full_q);
    assert (2'(accepted_o) + 2'(refused_rows_o) + 2'(refused_size_o) == 2'(f_commit));
    assert (accepted_o == f_accepted);
    assert ((write_o != '0) == f_writing && write_o != 2'b11);
    if (write_o != '0 && !f_accepted) assert (write_addr_o[PointW] == ~bank_o);
    if (take) assert (f_old == '0);

    // What makes these inductive.
    if (loading_q) assert (too_far_q == f_far && ready_o && (!f_lost || wrong_q));
    if (f_bank1 != bank_o) assert (settle_q[0]);
    if (f_bank2 != f_bank1) assert (settle_q[1]);
    assert (f_old <= frames_q && 32'(frames_q) <= 5);
    assert (f_old == old_q);
    assert (f_bank1 == bank_o || f_bank2 == f_bank1);
  end
end
