// SPDX-License-Identifier: Apache-2.0
// Properties of vista_frame_positions, inside it: every frame gives exactly W * H positions in raster order, its start,
// the ends of its rows and its end marked, those that are matched, and those that complete a word of its format; a position
// that waits holds still. A frame that waits begins as soon as the one before it ends.
//
// Assumed of the framer, and proved there: sizes in range.
//
// f_n is any number: it starts anywhere and never changes. The f_n-th frame (modulo 16) is followed.

import vista_stereo_pkg::MinWidth, vista_stereo_pkg::MinHeight;

logic            f_started = 1'b0;
logic [3:0]      f_n, f_open;  // frames that began to leave
logic [ColW-1:0] f_w, f_x;  // W - 1 of the frame that is followed; column of the next word
logic [RowW-1:0] f_h, f_y;
logic f_follow, f_wrap, f_matchable, f_row, f_matched, f_stepped, f_follow_stepped, f_waited;
logic f_narrow;
logic [4:0] f_flags;
logic [5:0] f_held;

assign f_follow    = busy_q & (f_open - 4'd1 == f_n);
assign f_wrap      = f_follow ? (f_x == f_w) : row_end_q;
assign f_matchable = (32'(f_w) >= FirstX + Radius) & (32'(f_h) >= 2 * Radius);
assign f_row       = f_matchable & (32'(f_y) >= Radius) & (32'(f_y) + Radius <= 32'(f_h));
assign f_matched   = f_row & (32'(f_x) >= FirstX) & (32'(f_x) + Radius <= 32'(f_w));

always_ff @(posedge clk_i) begin
  if (!rst_ni) f_started <= 1'b1;
  f_n       <= f_n;
  if (step) begin
    f_x <= f_wrap ? '0 : f_x + 1'b1;
    if (f_wrap) f_y <= f_y + 1'b1;
  end
  if (open) begin
    f_open <= f_open + 1'b1;
    if (f_open == f_n) begin
      f_w <= begin_last_col_i;
      f_h <= begin_last_row_i;
      f_narrow <= begin_narrow_i;
    end
    f_x    <= '0;
    f_y    <= '0;
  end
  f_stepped        <= step;
  f_follow_stepped <= step & f_follow;
  f_flags          <= {f_x == 0 && f_y == 0, f_x == f_w, f_x == f_w && f_y == f_h,
                       f_matched, !f_narrow || f_x[0] || f_x == f_w};
  f_waited         <= valid_o & ~ready_i;
  f_held           <= {sof_o, eol_o, last_o, matched_o, complete_o, narrow_o};
  if (!rst_ni) begin
    f_open           <= '0;
    f_stepped        <= 1'b0;
    f_follow_stepped <= 1'b0;
    f_waited         <= 1'b0;
  end
end

`ifdef VERILATOR
`include "vista_settled.svh"
always_ff @(posedge clk_i) if (f_settled) begin
`else
always_comb begin
  if (!f_started) assume (!rst_ni);
`endif
  if (f_started && begin_valid_i) begin
    assume (32'(begin_last_col_i) >= MinWidth - 1 && 32'(begin_last_row_i) >= MinHeight - 1);
  end
  if (f_started) begin
    // Positions.
    assert (valid_o == (f_stepped | f_waited));
    assert (!(f_stepped & f_waited));
    if (f_follow_stepped) assert ({sof_o, eol_o, last_o, matched_o, complete_o} == f_flags);
    if (f_follow_stepped) assert (narrow_o == f_narrow);
    if (f_waited) assert ({sof_o, eol_o, last_o, matched_o, complete_o, narrow_o} == f_held);
    if (f_follow) begin
      assert (frame_end == (step & f_x == f_w & f_y == f_h));
      assert (matched_q == f_matched);
    end
    if (f_follow && f_x == f_w && f_y == f_h && (!valid_o || ready_i)) assert (frame_end);

    // Frames.
    if (begin_valid_i && (!busy_q || frame_end)) assert (open);

    // What makes these inductive.
    if (f_follow) assert (narrow_q == f_narrow);
    if (f_follow) assert (32'(f_w) >= MinWidth - 1 && 32'(f_h) >= MinHeight - 1);
    if (busy_q) assert (x_q == f_x && y_q == f_y);
    if (f_follow) begin
      assert (first_q == (f_x == 0 && f_y == 0));
      assert (last_x_q == f_w && last_y_q == f_h && f_x <= f_w && f_y <= f_h);
      assert (match_last_x_q == f_w - ColW'(Radius) && match_last_y_q == f_h - RowW'(Radius));
      assert (matchable_q == f_matchable && row_q == f_row);
      assert (row_end_q == (f_x == f_w));
      assert (before_match_q == (32'(f_x) == FirstX - 1));
      assert (last_match_q == (f_x != 0 && f_x == match_last_x_q));
      if (f_x != 0) begin
        assert (last_row_q == (f_y == f_h));
        assert (before_match_row_q == (32'(f_y) == Radius - 1));
        assert (last_match_row_q == (f_y == match_last_y_q));
      end
    end
  end
end
