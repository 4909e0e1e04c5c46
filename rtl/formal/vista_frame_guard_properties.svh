// SPDX-License-Identifier: Apache-2.0
// Properties of vista_frame_guard, inside it, for any input that stays until it is taken: each frame leaves from its start
// on in raster order and ends whole, or, with at least three pixels, where its end of line is wrong; pixels leave as they
// were taken, once each and in order; no pixel of a sound frame is dropped; what waits holds still.

logic             f_started = 1'b0;
logic             f_inside;    // a frame is leaving
logic [ColW-1:0]  f_x;         // place of the pixel that is offered
logic [RowW-1:0]  f_y;
logic [1:0]       f_count;     // pixels of the frame that left, saturating
logic             f_last_x, f_end, f_waited, f_taken;
logic [DataW-1:0] f_data;
logic [DataW+1:0] f_held;

assign f_last_x = (f_x == last_col_o);
assign f_end    = (eol_o != f_last_x) | (f_last_x & (f_y == last_row_o));

always_ff @(posedge clk_i) begin
  if (!rst_ni) f_started <= 1'b1;
  if (valid_o & ready_i) begin
    f_inside <= ~f_end;
    f_count  <= f_end ? 2'd0 : (f_count == 2'd3) ? f_count : f_count + 1'b1;
    f_x      <= (f_end | f_last_x) ? '0 : f_x + 1'b1;
    f_y      <= f_end ? '0 : f_last_x ? f_y + 1'b1 : f_y;
  end
  f_taken  <= head_valid & head_ready & ~drop;
  f_data   <= head;
  f_waited <= valid_o & ~ready_i;
  f_held   <= {sof_o, eol_o, data_o};
  if (!rst_ni) begin
    f_inside <= 1'b0;
    f_count  <= '0;
    f_x      <= '0;
    f_y      <= '0;
    f_taken  <= 1'b0;
    f_waited <= 1'b0;
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
    // Framing of what leaves.
    if (valid_o) assert (sof_o == !f_inside);
    if (valid_o && eol_o != f_last_x) assert (32'(f_count) >= 2);
    if (valid_o) assert (f_end == (hold_end_q | (early_sof & ~broken_q)));
    if (f_waited) assert (valid_o && {sof_o, eol_o, data_o} == f_held);

    // Pixels: each one that was taken waits in the buffer, and the next one is taken only as it leaves.
    if (f_taken) assert (hold_valid_q && data_o == f_data);
    if (hold_valid_q && (start || take)) assert (valid_o && ready_i);
    if (drop) assert (!active_q);
    if (head_valid && active_q && !broken_q && !head_sof && ready_i) assert (take);
    if (start) assert (head_admit);

    // What makes these inductive.
    if (active_q || hold_valid_q) begin
      assert (32'(last_col_o) >= MinWidth - 1 && 32'(last_col_o) < MaxWidth && 32'(last_row_o) >= MinHeight - 1);
      assert (f_x <= last_col_o && f_y <= last_row_o);
      assert (count_q != '0 && hold_valid_q && hold_sof_q == !f_inside);
      assert (32'(count_q) == ((32'(f_count) < 3) ? 32'(f_count) + 1 : 3));
      assert (f_inside == (f_count != '0));
      assert (hold_end_q == !active_q);
    end else begin
      assert (!f_inside && f_count == 0 && f_x == 0 && f_y == 0);
    end
    if (active_q) begin
      assert (hold_eol_q == f_last_x);
      assert (f_last_x ? col_q == '0 && row_q == f_y + 1'b1 : col_q == f_x + 1'b1 && row_q == f_y);
      assert (row_q <= last_row_o && !(f_last_x && f_y == last_row_o));
      assert (last_col_q == (col_q == last_col_o));
      assert (!broken_q || count_q != 2'd3);
    end else begin
      assert (!broken_q);
    end
    if (hold_valid_q && hold_end_q) assert ((hold_eol_q != f_last_x) ? count_q == 2'd3 : f_y == last_row_o);
    if (32'(f_count) < 3 && (active_q || hold_valid_q)) assert (f_y == '0 && 32'(f_x) == 32'(f_count));
  end
end
