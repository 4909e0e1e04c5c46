// SPDX-License-Identifier: Apache-2.0
// Properties of vista_rectify_ring, inside it: no pixel is written where a row lies that is still needed, and a row is
// known to have filler in it if and only if a frame broke before its last pixel.
//
// Assumed of the framer, and proved there: a pixel comes only a clock after `go_o` was up, and a frame begins with the
// first of the 4 or more pixels of its first row. Assumed of vista_rectify_rows: rows are freed in order, none before it
// was written.

logic               f_started = 1'b0;
logic               f_go, f_filler, f_row_end, f_row_filler;
logic               f_first;  // the next pixel is the first of its row
logic [NumberW-1:0] f_free1;  // a clock ago
logic [RingW-1:0]   f_row;

always_ff @(posedge clk_i) begin
  if (!rst_ni) f_started <= 1'b1;
  f_go    <= go_o;
  f_free1 <= free_i;
  if (store_valid_i) f_first <= row_end;
  if (frame_start_i) f_filler <= 1'b0;
  if (broken_i) f_filler <= 1'b1;
  f_row_end    <= row_end;
  f_row        <= number_o[RingW-1:0];
  f_row_filler <= f_filler;
  if (!rst_ni) begin
    f_go      <= 1'b0;
    f_first   <= 1'b1;
    f_free1   <= '0;
    f_filler  <= 1'b0;
    f_row_end <= 1'b0;
  end
end

`ifdef VERILATOR
`include "vista_settled.svh"
always_ff @(posedge clk_i) if (f_settled) begin
`else
always_comb begin
  if (!f_started) assume (!rst_ni);
  if (store_valid_i) assume (f_go && !(f_first && store_last_i));
  if (frame_start_i) assume (store_valid_i && f_first);
  assume (free_i - f_free1 <= number_o - f_free1);
`endif
  if (f_started) begin
    assert (!store_valid_i || number_o - free_i < NumberW'(NumRows));
    assert (number_o - free_i <= NumberW'(NumRows));
    if (f_row_end) assert (cut_rows_q[f_row] == f_row_filler);

    // What makes these inductive.
    assert (number_o - f_free1 <= NumberW'(NumRows));
    assert (cut_q == f_filler);
    assert (begins_q == f_first);
    if (room_q) assert (number_o - f_free1 < NumberW'(NumRows));
    if (more_room_q) assert (number_o - f_free1 < NumberW'(NumRows - 1));
    if ((f_go && f_first) || !f_first) assert (number_o - f_free1 < NumberW'(NumRows));
  end
end
