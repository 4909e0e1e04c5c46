// SPDX-License-Identifier: Apache-2.0
// Properties of vista_framer, inside it, for any input at all: every frame that is taken gives exactly W * H slots in
// raster order, with the flags of its columns and rows, and beside the first slot of each row its size and what else
// belongs to it; slots are issued by leave of `go_i` only; no pixel of a sound frame is dropped.
//
// Assumed of vista_frame_input: only sizes that the engine takes are admitted.
//
// f_n is any number: it starts anywhere and never changes. The f_n-th frame (modulo 8) is followed.

logic            f_started = 1'b0;
logic [2:0]      f_n, f_in, f_out;  // frames taken, frames that had all of their slots
logic [ColW-1:0] f_w, f_x;  // W - 1 of the frame that is followed; column of the next slot
logic [RowW-1:0] f_h, f_y;
logic [SideWidth-1:0] f_side;
logic            f_follow, f_wrap, f_end, f_taken, f_last;
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
      f_side <= side_i;
    end
  end
  if (slot_valid) begin
    f_x <= f_wrap ? '0 : f_x + 1'b1;
    if (f_wrap) f_y <= f_y + 1'b1;
  end
  if (f_end) begin
    f_out <= f_out + 1'b1;
    f_x   <= '0;
    f_y   <= '0;
  end
  f_taken <= valid_i & ready_o & ~drop;
  f_data  <= data_i;
  f_last  <= active_q & (col_q == width_less_1_q);
  if (!rst_ni) begin
    f_in    <= '0;
    f_out   <= '0;
    f_x     <= '0;
    f_y     <= '0;
    f_taken <= 1'b0;
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
        assert (slot_next_o.first_col == (f_x == 0) && slot_next_o.last_col == (f_x == f_w));
        assert (slot_next_o.first_row == (f_y == 0));
        assert (slot_next_o.last_row == (f_y == f_h) && f_end == (f_x == f_w && f_y == f_h));
        assert (slot_next_o.flat == (f_y == f_h && !f_h[0]));
        if (f_x == 0) assert (last_col_o == f_w && last_row_o == f_h && side_o == f_side);
      end
    end
    if (f_end && f_follow) assert (f_x == f_w && f_y == f_h);

    // Pixels.
    if (start) assert (admit_i);
    if (ready_o) assert (valid_i);
    if (valid_i && ready_o && active_q && !fill_q) assert (take && !sof_i);
    if (f_taken) assert (store_valid_o && store_data_o == f_data);
    if (store_valid_o) assert (store_last_o == f_last);

    // What makes these inductive.
    assert (in_first_row_q == (row_q == 0));
    assert (in_last_row_q == (active_q && row_q == last_row_q));
    assert (last_pixel_q == (last_col_q & in_last_row_q));
    assert (f_in - f_out == {2'b0, active_q} + {2'b0, drain_q});
    if (active_q) begin
      assert (32'(width_less_1_q) >= MinWidth - 1 && 32'(width_less_1_q) < MaxWidth && last_row_q != 0);
      assert (col_q <= width_less_1_q && row_q <= last_row_q);
      assert (last_col_q == (col_q == width_less_1_q));
      if (f_in - 3'd1 == f_n) assert (width_less_1_q == f_w && last_row_q == f_h && side_o == f_side);
    end else begin
      assert (col_q == 0 && row_q == 0 && !last_col_q && !fill_q);
    end
    if (drain_q) begin
      assert (32'(slot_width_less_1_q) >= MinWidth - 1);
      assert (drain_col_q <= slot_width_less_1_q);
      assert (drain_last_col_q == (drain_col_q == slot_width_less_1_q));
      assert (f_x == drain_col_q && f_y != 0);
      assert (row_q == 0 || (row_q == 1 && col_q == 0));
      if (drain_col_q == 0) begin
        assert (!active_q);
        if (f_out == f_n) assert (width_less_1_q == f_w && last_row_q == f_h && side_o == f_side);
      end
      if (f_out == f_n) assert (slot_width_less_1_q == f_w && f_y == f_h && slot_odd_q == !f_h[0]);
    end else if (row_q == 0) begin
      assert (f_x == 0 && f_y == 0);
    end else begin
      assert (f_x == col_q && f_y == row_q - 1'b1);
      if (f_x != 0 || f_y != 0) begin
        assert (slot_width_less_1_q == width_less_1_q && slot_odd_q == !last_row_q[0]);
      end
    end
  end
end
