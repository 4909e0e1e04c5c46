// SPDX-License-Identifier: Apache-2.0
// Properties of vista_framer, inside it, for any input at all: every frame that is taken begins to leave exactly once and
// gives exactly W * H slots in raster order, with the flags of its columns and rows; slots are issued by leave of `go_i`
// only; no pixel of a sound frame is dropped.
//
// Assumed of vista_frame_input: only sizes that the engine takes are admitted.
//
// f_n is any number: it starts anywhere and never changes. The f_n-th frame (modulo 8) is followed.

logic            f_started = 1'b0;
logic [2:0]      f_n, f_in, f_out;  // frames taken, frames that had all of their slots
logic [ColW-1:0] f_w, f_x;  // W - 1 of the frame that is followed; column of the next slot
logic [RowW-1:0] f_h, f_y;
logic [2:0]      f_since;  // clocks since a frame began to leave, saturating
logic            f_narrow;
logic            f_follow, f_wrap, f_end, f_begun, f_go, f_begin_follow, f_taken;
logic [DataW-1:0] f_data;

assign f_follow = (f_out == f_n) & (f_in != f_out);
assign f_wrap   = f_follow ? (f_x == f_w) : slot_last_col;
assign f_end    = slot_valid & drain_q & drain_last_col_q;

always_ff @(posedge clk_i) begin
  if (!rst_ni) f_started <= 1'b1;
  f_n       <= f_n;
  if (start) begin
    f_in <= f_in + 1'b1;
    if (f_in == f_n) begin
      f_w <= last_col_i;
      f_h <= last_row_i;
      f_narrow <= params_i.narrow;
    end
  end
  if (slot_valid) begin
    f_x <= f_wrap ? '0 : f_x + 1'b1;
    if (f_wrap) f_y <= f_y + 1'b1;
  end
  if (begin_now) f_begun <= 1'b1;
  if (f_end) begin
    f_out   <= f_out + 1'b1;
    f_x     <= '0;
    f_y     <= '0;
    f_begun <= 1'b0;
  end
  f_since        <= begin_now ? 3'd1 : (f_since == 3'd4) ? f_since : f_since + 1'b1;
  f_go           <= go_i;
  f_begin_follow <= begin_now & f_follow;
  f_taken        <= valid_i & ready_o & ~drop;
  f_data         <= data_i;
  if (!rst_ni) begin
    f_in           <= '0;
    f_out          <= '0;
    f_x            <= '0;
    f_y            <= '0;
    f_begun        <= 1'b0;
    f_since        <= 3'd4;
    f_begin_follow <= 1'b0;
    f_taken        <= 1'b0;
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
    if (valid_i & admit_i)
      assume (enable_i && 32'(last_col_i) >= MinWidth - 1 && 32'(last_col_i) < MaxWidth && last_row_i != '0);

    // Slots.
    if (slot_valid) begin
      assert (go_i && slot_col == f_x);
      if (f_follow) begin
        assert (slot_d.first_col == (f_x == 0) && slot_d.last_col == (f_x == f_w));
        assert (slot_d.first_row == (f_y == 0));
        assert (slot_d.before_col == (32'(f_x) < NumDisparities - 1));
        assert (slot_d.early_col == (32'(f_x) < NumDisparities - 1 + BlockSize));
        assert (slot_d.last_row == (f_y == f_h) && f_end == (f_x == f_w && f_y == f_h));
        assert (slot_d.leave == (32'(f_y) >= BlockSize));
        assert (slot_d.match == (32'(f_y) >= BlockSize - 1 && 32'(f_x) >= FirstMatchCol));
        assert (slot_d.match_row == (32'(f_y) >= BlockSize - 1 && 32'(f_w) >= FirstMatchCol));
      end
    end
    if (slot_o.valid) assert (f_go);
    if (f_end && f_follow) assert (f_x == f_w && f_y == f_h);

    // Beginnings: one a frame, at the first column of a row no later than r, four clocks apart at least.
    if (begin_now) assert (!f_begun && f_x == 0 && 32'(f_y) <= Radius && f_since == 3'd4);
    if (f_end) assert (f_begun);
    if (f_begin_follow) assert (begin_valid_o && begin_last_col_o == f_w && begin_last_row_o == f_h);
    if (f_begin_follow) assert (begin_narrow_o == f_narrow);

    // Pixels.
    if (start) assert (admit_i);
    if (ready_o) assert (valid_i);
    if (valid_i && ready_o && active_q && !fill_q) assert (take && !sof_i);
    if (f_taken) assert (store_valid_o && store_data_o == f_data);

    // What makes these inductive.
    assert (in_first_row_q == (row_q == 0));
    assert (in_last_row_q == (active_q && row_q == last_row_q));
    assert (last_pixel_q == (last_col_q & in_last_row_q));
    assert (f_in - f_out == {2'b0, active_q} + {2'b0, drain_q});
    if (active_q) begin
      assert (32'(width_less_1_q) >= MinWidth - 1 && 32'(width_less_1_q) < MaxWidth && last_row_q != 0);
      assert (col_q <= width_less_1_q && row_q <= last_row_q);
      assert (last_col_q == (col_q == width_less_1_q));
      if (f_in - 3'd1 == f_n) assert (width_less_1_q == f_w && last_row_q == f_h && params_o.narrow == f_narrow);
    end else begin
      assert (col_q == 0 && row_q == 0 && !last_col_q && !fill_q);
    end
    if (drain_q) begin
      assert (32'(match_width_less_1_q) >= MinWidth - 1 && match_last_row_q != 0);
      assert (match_wide_q == (32'(match_width_less_1_q) >= FirstMatchCol));
      assert (drain_col_q <= match_width_less_1_q);
      assert (drain_last_col_q == (drain_col_q == match_width_less_1_q));
      assert (f_x == drain_col_q && f_y == match_last_row_q);
      assert (row_q == 0 || (row_q == 1 && col_q == 0));
      if (drain_col_q == 0) begin
        assert (!active_q);
        if (f_out == f_n) assert (params_o.narrow == f_narrow);
      end
      assert (f_begun == begun_q && (f_begun || (drain_col_q == 0 && 32'(f_y) <= Radius)));
      if (f_out == f_n) assert (match_width_less_1_q == f_w && match_last_row_q == f_h);
    end else if (row_q == 0) begin
      assert (f_x == 0 && f_y == 0);
    end else begin
      assert (f_x == col_q && f_y == row_q - 1'b1);
      if (f_x != 0 || f_y != 0) begin
        assert (match_width_less_1_q == width_less_1_q && match_last_row_q == last_row_q);
        assert (match_wide_q == (32'(width_less_1_q) >= FirstMatchCol));
        assert (f_begun == begun_q);
        assert (f_begun == (32'(f_y) > Radius || (32'(f_y) == Radius && f_x != 0)));
      end
    end
    if (f_x == 0 && f_y == 0) assert (!f_begun);
    if (f_y != 0) assert (32'(rows_q) == ((32'(f_y) < BlockSize) ? 32'(f_y) : BlockSize));
    assert (f_since <= 3'd4 && (f_x != 0 || f_since == 3'd4));
    assert (32'(f_since) >= ((f_x < 3) ? 32'(f_x) : 3));
  end
end
