// SPDX-License-Identifier: Apache-2.0
// Properties of vista_word_packer, inside it: no pixel is lost or doubled, a word that waits holds still, and a narrow word
// holds the pixel before and this one.
//
// Assumed of vista_frame_writer, and proved there and of vista_frame_positions: a pixel that waits holds still, a row keeps
// its format, and pixels complete their words as they should.

logic f_started = 1'b0;
logic f_first, f_first_sof;  // a first pixel of a pair has come, and not the second
logic f_waited_in, f_waited_out;
logic [DisparityW-1:0]       f_disparity;
logic [DisparityW+SminW+3:0] f_in, f_held_in;
logic [33:0] f_out, f_held_out;

assign f_in  = {sof_i, eol_i, narrow_i, complete_i, disparity_i, smin_i};
assign f_out = {sof_o, eol_o, word_o};

always_ff @(posedge clk_i) begin
  if (!rst_ni) f_started <= 1'b1;
  if (valid_i & ready_o) begin
    f_first     <= narrow_i & ~eol_i & ~f_first;
    f_first_sof <= sof_i;
    f_disparity <= disparity_i;
  end
  f_waited_in  <= valid_i & ~ready_o;
  f_held_in    <= f_in;
  f_waited_out <= valid_o & ~ready_i;
  f_held_out   <= f_out;
  if (!rst_ni) begin
    f_first      <= 1'b0;
    f_waited_in  <= 1'b0;
    f_waited_out <= 1'b0;
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
    if (f_waited_in) assume (valid_i && f_in == f_held_in);
    if (f_first && valid_i) assume (narrow_i && !sof_i);
    if (valid_i) assume (complete_i == (!narrow_i || f_first || eol_i));
    if (f_waited_out) assert (valid_o && f_out == f_held_out);
    if (valid_o) begin
      assert (valid_i && eol_o == eol_i && sof_o == (f_first ? f_first_sof : sof_i));
      if (!narrow_i) assert (word_o == {smin_i, 16'(disparity_i)});
      else if (f_first) assert (word_o == {16'(disparity_i), 16'($signed(f_disparity))});
      else assert (eol_i && word_o == {16'(Invalid), 16'(disparity_i)});
    end
    // A pixel leaves with its word, or waits alone for the second one.
    if (valid_i && ready_o) assert ((valid_o && ready_i) || (narrow_i && !f_first && !eol_i));

    // What makes these inductive.
    assert (held_q == f_first);
    if (f_first) assert (held_sof_q == f_first_sof && held_disparity_q == 16'($signed(f_disparity)));
    assert (!f_waited_out || f_waited_in);
  end
end
