// SPDX-License-Identifier: Apache-2.0
// Properties of vista_levels, inside it, for any pattern of valid and ready: each beat that is taken is offered next, with
// its start and end; it also goes to the reducer, at the same time, exactly if a smaller level follows; levels of a frame
// come in order, each with half the size of the one before it, as many as are to be sent; a frame
// begins with level 0 and its own size; what waits holds still.
//
// Assumed of vista_frame_guard: the size is one the engine takes, and stays until the frame has left; of vista_pyramid:
// no level is to be sent that is too small; of the guard and the memory: a frame and a level start where the one before
// it ended. Then nothing is ever lost, and every level has a size that the engine takes.

logic             f_started = 1'b0;
logic             f_stepped, f_waited, f_reduce_waited, f_more, f_new, f_follows, f_inside;
logic [DataW+1:0] f_beat, f_held, f_reduce_held;
logic [1:0]       f_level, f_held_level;      // of the level that is being taken
logic [ColW:0]    f_width, f_held_width;
logic [RowW-1:0]  f_height, f_held_height, f_source_height;
logic [ColW-1:0]  f_source_width;
logic [2:0]       f_sent, f_source_sent;  // as its frame had them

assign f_more = (f_level != 2'd3) & f_sent[f_level];

// The reference: level and size of what is taken.
assign f_level  = level_q;
assign f_width  = (ColW + 1)'(32'(end_col) + 1);
assign f_height = RowW'(32'(end_row) + 1);

logic [1:0]      f_last_level;   // as they were at the end of the level before
logic [ColW:0]   f_last_width;
logic [RowW-1:0] f_last_height;
logic [2:0]      f_sent_q, f_last_sent;

assign f_sent = first_q ? sent_i : f_sent_q;

always_ff @(posedge clk_i) begin
  if (!rst_ni) f_started <= 1'b1;
  f_stepped <= step;
  f_beat    <= {level_sof, eol, first_q ? source_data_i : fetch_data_i};
  f_waited  <= valid_o & ~ready_i;
  f_held    <= {sof_o, eol_o, data_o};
  f_held_level  <= level_o;
  f_held_width  <= width_o;
  f_held_height <= height_o;
  f_reduce_waited <= reduce_valid_o & ~reduce_ready_i;
  f_reduce_held   <= {reduce_sof_o, reduce_eol_o, reduce_data_o};
  f_source_width  <= last_col_i;
  f_source_height <= last_row_i;
  f_source_sent   <= sent_i;
  f_sent_q        <= f_sent;
  if (step) f_inside <= ~level_end;
  f_new <= step & level_end;
  f_follows <= f_more;
  if (step & level_end) begin
    f_last_level  <= f_level;
    f_last_width  <= f_width;
    f_last_height <= f_height;
    f_last_sent   <= f_sent;
  end
  if (!rst_ni) begin
    f_stepped <= 1'b0;
    f_waited  <= 1'b0;
    f_reduce_waited <= 1'b0;
    f_inside  <= 1'b0;
    f_new     <= 1'b0;
  end
end

logic f_source_held;  // a beat of the source or of the memory that was not taken
logic f_fetch_held;
logic [DataW:0] f_source_beat, f_fetch_beat;

always_ff @(posedge clk_i) begin
  f_source_held <= source_valid_i & ~source_ready_o;
  f_fetch_held  <= fetch_valid_i & ~fetch_ready_o;
  f_source_beat <= {source_eol_i, source_data_i};
  f_fetch_beat  <= {fetch_eol_i, fetch_data_i};
  if (!rst_ni) begin
    f_source_held <= 1'b0;
    f_fetch_held  <= 1'b0;
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
    if (source_valid_i || (first_q && f_inside)) begin
      assume (32'(last_col_i) >= MinWidth - 1 && 32'(last_col_i) < MaxWidth);
      assume (32'(last_row_i) >= MinHeight - 1 && last_row_i != '1);
      for (int unsigned k = 0; k < 3; k++)
        assume (!sent_i[k] || (32'(last_col_i) >> k >= 2 * MinWidth - 2 && 32'(last_row_i) >> k >= 2 * MinHeight - 2));
    end
    if (first_q && f_inside)
      assume (last_col_i == f_source_width && last_row_i == f_source_height && sent_i == f_source_sent);
    if (f_source_held) begin
      assume (source_valid_i && {source_eol_i, source_data_i} == f_source_beat);
      assume (last_col_i == f_source_width && last_row_i == f_source_height && sent_i == f_source_sent);
    end
    if (f_fetch_held) assume (fetch_valid_i && {fetch_eol_i, fetch_data_i} == f_fetch_beat);

    if (source_valid_i && first_q) assume (source_sof_i == level_sof);
    if (fetch_valid_i && !first_q) assume (fetch_sof_i == level_sof);
    assert (!lost_o);

    // Beats.
    assert (step == ((source_valid_i & source_ready_o) | (fetch_valid_i & fetch_ready_o)));
    assert (!(source_ready_o & fetch_ready_o));
    assert (valid_o == (f_stepped | f_waited) && !(f_stepped & f_waited));
    if (f_stepped) assert ({sof_o, eol_o, data_o} == f_beat);
    if (f_waited) begin
      assert ({sof_o, eol_o, data_o} == f_held);
      assert (level_o == f_held_level && width_o == f_held_width && height_o == f_held_height);
    end

    // The reducer.
    assert ((reduce_valid_o & reduce_ready_i) == (step & f_more));
    if (reduce_valid_o) begin
      assert ({reduce_sof_o, reduce_eol_o, reduce_data_o} == {level_sof, eol, first_q ? source_data_i : fetch_data_i});
      assert (reduce_width_o == f_width && reduce_height_o == f_height);
    end
    if (f_reduce_waited) assert (reduce_valid_o && {reduce_sof_o, reduce_eol_o, reduce_data_o} == f_reduce_held);

    // Levels.
    assert (level_sof == !f_inside);
    if (f_new && f_follows) begin
      assert (f_level == f_last_level + 2'd1 && f_sent == f_last_sent);
      assert (32'(f_width) == (32'(f_last_width) + 1) / 2 && 32'(f_height) == (32'(f_last_height) + 1) / 2);
    end
    if (f_new && !f_follows) assert (f_level == '0);
    if (level_q != '0) assert (source_ready_o == 1'b0);
    if (level_q == '0) assert (fetch_ready_o == 1'b0);

    // What makes these inductive.
    assert (first_q == (level_q == '0));
    if (!f_inside) assert (!last_col_q);
    if (!first_q || f_inside || source_valid_i) begin
      assert (32'(end_col) >= MinWidth - 1 && 32'(end_col) < MaxWidth);
      assert (32'(end_row) >= MinHeight - 1 && end_row != '1);
      assert (col_q <= end_col && row_q <= end_row && last_col_q == (col_q == end_col));
      assert (more == f_more);
    end
    if (level_q != '0) assert (sent_q == f_sent_q >> level_q);
    for (int unsigned k = 0; k < 3; k++)
      if (sent[k] && (!first_q || f_inside || source_valid_i))
        assert (32'(end_col) >> k >= 2 * MinWidth - 2 && 32'(end_row) >> k >= 2 * MinHeight - 2);
  end
end
