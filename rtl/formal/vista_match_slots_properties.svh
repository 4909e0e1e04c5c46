// SPDX-License-Identifier: Apache-2.0
// Properties of vista_match_slots, inside it: every frame begins to leave exactly once, with its size and format, and no
// two within four clocks; rows and columns that fill the block are marked.
//
// Assumed of vista_framer: each frame gives its slots in raster order, with the flags of their columns and rows, and its
// size and format beside the first slot of each row.
//
// The next slot of the frame is (f_x, f_y); f_w, f_h and f_narrow are those beside its first slot.

logic            f_started = 1'b0;
logic [ColW-1:0] f_w, f_w_next, f_x;  // W - 1; column of the next slot
logic [RowW-1:0] f_h, f_h_next, f_y;
logic            f_narrow, f_narrow_next, f_inside, f_begun, f_begin;
logic [2:0]      f_since;  // clocks since a frame began to leave, saturating

assign f_inside = (f_x != 0) | (f_y != 0);

assign f_w_next      = f_inside ? f_w : last_col_i;
assign f_h_next      = f_inside ? f_h : last_row_i;
assign f_narrow_next = f_inside ? f_narrow : narrow_i;

always_ff @(posedge clk_i) begin
  if (!rst_ni) f_started <= 1'b1;
  f_begin <= begin_now;
  f_since <= begin_now ? 3'd1 : (f_since == 3'd4) ? f_since : f_since + 1'b1;
  if (slot_next_i.valid) begin
    f_w      <= f_w_next;
    f_h      <= f_h_next;
    f_narrow <= f_narrow_next;
    f_x      <= (f_x == f_w_next) ? '0 : f_x + 1'b1;
    if (f_x == f_w_next) f_y <= (f_y == f_h_next) ? '0 : f_y + 1'b1;
    if (begin_now) f_begun <= 1'b1;
    if (f_x == f_w_next && f_y == f_h_next) f_begun <= 1'b0;
  end
  if (!rst_ni) begin
    f_begin <= 1'b0;
    f_begun <= 1'b0;
    f_since <= 3'd4;
    f_x     <= '0;
    f_y     <= '0;
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
    if (slot_next_i.valid) begin
      assume (32'(f_w_next) >= MinWidth - 1 && 32'(f_w_next) < MaxWidth && f_h_next != 0);
      assume (slot_next_col_i == f_x && slot_next_i.first_col == (f_x == 0) && slot_next_i.last_col == (f_x == f_w_next));
      assume (slot_next_i.first_row == (f_y == 0) && slot_next_i.last_row == (f_y == f_h_next));
      if (f_x == 0) assume (last_col_i == f_w_next && last_row_i == f_h_next && narrow_i == f_narrow_next);

      assert (slot_d.before_col == (32'(f_x) < NumDisparities - 1));
      assert (slot_d.early_col == (32'(f_x) < NumDisparities - 1 + BlockSize));
      assert (slot_d.leave == (32'(f_y) >= BlockSize));
      assert (slot_d.match == (32'(f_y) >= BlockSize - 1 && 32'(f_x) >= FirstMatchCol));
      assert (slot_d.match_row == (32'(f_y) >= BlockSize - 1 && 32'(f_w_next) >= FirstMatchCol));
      if (f_x == f_w_next && f_y == f_h_next) assert (f_begun);
    end

    // Beginnings: one a frame, at the first column of a row no later than r, four clocks apart at least.
    if (begin_now) assert (!f_begun && f_x == 0 && 32'(f_y) <= Radius && f_since == 3'd4);
    if (f_begin) assert (begin_valid_o && begin_last_col_o == f_w && begin_last_row_o == f_h && begin_narrow_o == f_narrow);

    // What makes these inductive.
    assert (f_x <= f_w_next && f_y <= f_h_next);
    if (f_inside) begin
      assert (32'(f_w) >= MinWidth - 1 && 32'(f_w) < MaxWidth && f_h != 0);
      assert (match_wide_q == (32'(f_w) >= FirstMatchCol));
      assert (f_begun == begun_q);
      assert (f_begun == (32'(f_y) > Radius || (32'(f_y) == Radius && f_x != 0) || (f_y == f_h && f_x != 0)));
    end else begin
      assert (!f_begun);
    end
    if (f_y != 0) assert (32'(rows_q) == ((32'(f_y) < BlockSize) ? 32'(f_y) : BlockSize));
    assert (f_since <= 3'd4 && (f_x != 0 || f_since == 3'd4));
    assert (32'(f_since) >= ((f_x < 3) ? 32'(f_x) : 3));
    if (f_begin) assert (32'(f_x) == 1 && f_since == 3'd1);
  end
end
