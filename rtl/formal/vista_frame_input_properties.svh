// SPDX-License-Identifier: Apache-2.0
// Properties of vista_frame_input, inside it: a pixel leaves with what was set in the clock in which it was first offered,
// whatever is set later and however long it waits; only sizes that the engine takes are admitted.
//
// f_n is any number: it starts anywhere and never changes. The f_n-th pixel (modulo 16) is followed. Assumed of the bus,
// as AXI has it: what is offered stays until it is accepted.

logic                 f_started = 1'b0;
logic [3:0]           f_n, f_offered, f_taken, f_left;  // pixels; offered: begun to be
logic                 f_waited, f_seen;
logic [DataW+1:0]     f_beat, f_pixel;
logic                 f_enable;
logic [ColW:0]        f_width;
logic [RowW-1:0]      f_height;
logic [SideWidth-1:0] f_side;
logic                 f_begins, f_fits, f_stays, f_ended;
logic [SetW+DataW+1:0] f_kept;  // what is kept of all this

// No set admits a size that the engine does not take.
function automatic logic f_legal(logic [SetW-1:0] set);
  logic enable, admit;
  logic [ColW-1:0] last_col;
  logic [RowW-1:0] last_row;
  {enable, admit, last_col, last_row} = set[SetW-1:SideWidth];
  return !admit || (enable && 32'(last_col) >= MinWidth - 1 && 32'(last_col) < MaxWidth && last_row != '0);
endfunction

logic [1:0] f_admitted;  // of those that wait here or on the bus
logic f_here, f_head, f_spill;
assign f_here     = waiting_q & held_q[SetW-2];
assign f_head     = u_skid.valid_q & u_skid.data_q[DataW+SetW];
assign f_spill    = u_skid.spill_valid_q & u_skid.spill_q[DataW+SetW];
assign f_admitted = 2'(f_here) + 2'(f_head) + 2'(f_spill);

assign f_stays   = !f_waited | !rst_ni | (valid_i & ({sof_i, eol_i, data_i} == f_beat));
assign f_begins  = valid_i & ~f_waited;
assign f_offered = f_taken + {3'b0, f_waited};
assign f_kept    = {f_enable, f_enable & f_fits, ColW'(f_width - 1'b1), f_height - 1'b1, f_side, f_pixel};
assign f_fits    = (32'(f_width) >= MinWidth) & (32'(f_width) <= MaxWidth) & (32'(f_height) >= MinHeight);

always_ff @(posedge clk_i) begin
  if (!rst_ni) f_started <= 1'b1;
  f_n      <= f_n;
  f_waited <= valid_i & ~ready_o;
  f_beat   <= {sof_i, eol_i, data_i};
  if (valid_i & ready_o) f_taken <= f_taken + 1'b1;
  if (valid_o & ready_i) f_left <= f_left + 1'b1;
  if (f_begins & (f_taken == f_n)) begin
    f_seen   <= 1'b1;
    f_pixel  <= {sof_i, eol_i, data_i};
    f_enable <= enable_i;
    f_width  <= width_i;
    f_height <= height_i;
    f_side   <= side_i;
  end
  if (valid_o & ready_i & (f_left == f_n)) f_seen <= 1'b0;
  if (!rst_ni) begin
    f_waited <= 1'b0;
    f_taken  <= '0;
    f_left   <= '0;
    f_seen   <= 1'b0;
  end
end

`ifdef VERILATOR
`include "vista_settled.svh"
// The reset of a bus ends at once what it offers, and comes here a clock later: meanwhile nothing is asked for.
always_ff @(posedge clk_i) f_ended <= f_settled & !f_stays;
always_ff @(posedge clk_i) if (f_settled) begin
  if (f_ended) assert (!rst_ni);
`else
assign f_ended = 1'b0;
always_comb begin
  if (!f_started) assume (!rst_ni);
  if (f_started) assume (f_stays);
`endif
  if (f_started && f_stays && !f_ended) begin
    if (valid_o && f_left == f_n) begin
      assert (f_seen && {sof_o, eol_o, data_o} == f_pixel && side_o == f_side);
      assert (enable_o == f_enable && admit_o == (f_enable && f_fits));
      if (admit_o) assert (32'(last_col_o) + 1 == 32'(f_width) && 32'(last_row_o) + 1 == 32'(f_height));
    end
    if (valid_o && admit_o)
      assert (enable_o && 32'(last_col_o) >= MinWidth - 1 && 32'(last_col_o) < MaxWidth && last_row_o != '0);

    // A pixel that is admitted is told of for as long as it waits.
    assert (busy_o == (f_admitted != '0));

    // What makes these inductive.
    assert (admitted_q == f_admitted);
    if (waiting_q) assert (f_legal(held_q));
    if (u_skid.valid_q) assert (f_legal(u_skid.data_q[2+DataW+:SetW]));
    if (u_skid.spill_valid_q) assert (f_legal(u_skid.spill_q[2+DataW+:SetW]));
    assert (waiting_q == f_waited);
    assert (f_taken - f_left == {3'b0, u_skid.valid_q} + {3'b0, u_skid.spill_valid_q});
    assert (!u_skid.spill_valid_q || u_skid.valid_q);
    assert (f_seen == ((f_n - f_left) < (f_offered - f_left)));
    if (f_waited && f_seen && f_taken == f_n)
      assert ({held_q, f_beat} == f_kept);
    if (f_seen && f_left == f_n && u_skid.valid_q)
      assert (u_skid.data_q == f_kept);
    if (f_seen && f_left + 4'd1 == f_n && u_skid.spill_valid_q)
      assert (u_skid.spill_q == f_kept);
  end
end
