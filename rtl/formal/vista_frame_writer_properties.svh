// SPDX-License-Identifier: Apache-2.0
// Properties of vista_frame_writer, inside it: each position that was counted gives one word, with its marks, matched
// ones with the next result, or invalid if a frame begins there, and every other one invalid; no word is lost or doubled,
// and a word that waits holds still. A result is used once, and dropped only when no frame is leaving; a beginning goes
// with the first position of its frame. That the positions are those of the frame, in order, is proved of vista_frame_positions and vista_skid.

logic f_started = 1'b0;
logic f_stepped, f_last, f_waited;
logic [DisparityW+SminW+3:0] f_word, f_held;

always_ff @(posedge clk_i) begin
  if (!rst_ni) f_started <= 1'b1;
  f_stepped <= step;
  f_last    <= step & last;
  f_word    <= {sof, eol, narrow, complete, matched && !queued_begin_i ? {result_disparity_i, result_smin_i} : {DisparityW'(Invalid), SminW'('1)}};
  f_waited  <= valid_o & ~ready_i;
  f_held    <= {sof_o, eol_o, narrow_o, complete_o, disparity_o, smin_o};
  if (!rst_ni) begin
    f_stepped <= 1'b0;
    f_last    <= 1'b0;
    f_waited  <= 1'b0;
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
    // Words.
    assert (valid_o == (f_stepped | f_waited));
    assert (!(f_stepped & f_waited));
    if (f_stepped) assert ({sof_o, eol_o, narrow_o, complete_o, disparity_o, smin_o} == f_word);
    if (f_waited) assert ({sof_o, eol_o, narrow_o, complete_o, disparity_o, smin_o} == f_held);
    assert (frame_end_o == f_last);

    // A position is used up with its word, and a result with the word of a matched one. One that is not matched waits for
    // nothing but room.
    if (step) assert (place_valid);
    if (matched && step) assert (queued_valid_i);
    assert ((waiting_result & queued_ready_o) == ((step & matched & waiting_result) | stray));
    assert ((waiting_begin & queued_ready_o) == (step & sof & waiting_begin));
    if (place_valid && !matched && (!valid_o || ready_i)) assert (step);
  end
end
