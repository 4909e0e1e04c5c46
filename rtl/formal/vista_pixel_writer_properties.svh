// SPDX-License-Identifier: Apache-2.0
// Properties of vista_pixel_writer, inside it: it never overflows; every pixel that was computed leaves once, in order,
// with its start and end of line; the last one of a frame that was cut leaves with its end of line wrong, and the first
// three pixels of a frame leave in any case; a pixel that waits holds still, with what goes along.
//
// Assumed of the filter: no result comes later than InFlight - 3 clocks after `go_o` was last up; in a frame, filler is
// followed by filler until it ends.
//
// f_n is any number: it starts anywhere and never changes. The f_n-th pixel that leaves (modulo 64) is followed.

logic                 f_started = 1'b0;
logic [5:0]           f_n, f_in, f_out, f_place;  // pixels that were handed over to the memory, and that left
logic [PtrW:0]        f_age;                      // clocks since `go_o` was up, saturating
logic [PtrW:0]        f_level1;                   // the level a clock ago
logic                 f_seen, f_waited, f_loaded, f_end;
logic [WordW-1:0]     f_word, f_held;
logic [DataW-1:0]     f_data;                     // the newest result that was not cut
logic                 f_sof, f_eol;
logic                 f_cut;                      // the frame at the input is filler by now
logic [1:0]           f_count;                    // pixels of it, saturating
logic [PtrW-1:0]      f_at;

assign f_place = f_n - f_out;
assign f_at    = read_ptr_q[PtrW-1:0] + PtrW'(f_place - 6'd1);  // of the pixel that is followed, behind the one that is offered

always_ff @(posedge clk_i) begin
  if (!rst_ni) f_started <= 1'b1;
  f_n       <= f_n;
  if (go_o) f_age <= (PtrW + 1)'(1);
  else if (32'(f_age) <= InFlight - 3) f_age <= f_age + 1'b1;
  f_level1 <= level;
  if (write) begin
    f_in <= f_in + 1'b1;
    if (f_in == f_n) begin
      f_seen <= 1'b1;
      f_word <= {hold_side_q, hold_sof_q, write_eol, hold_data_q};
    end
  end
  if (valid_o & ready_i) begin
    f_out <= f_out + 1'b1;
    if (f_out == f_n) f_seen <= 1'b0;
  end
  if (result_valid_i) begin
    f_cut   <= result_cut_i & ~result_end_i;
    f_count <= result_sof_i ? 2'd1 : (f_count == 2'd3) ? f_count : f_count + 1'b1;
    f_end   <= result_end_i;
  end
  f_waited <= valid_o & ~ready_i;
  f_held   <= word;
  // What the result of this clock has to become.
  f_loaded <= result_valid_i & (~result_cut_i | result_sof_i | (f_count != 2'd3));
  f_data   <= result_data_i;
  f_sof    <= result_sof_i;
  f_eol    <= result_eol_i;
  if (!rst_ni) begin
    f_in     <= '0;
    f_out    <= '0;
    f_seen   <= 1'b0;
    f_age    <= (PtrW + 1)'(InFlight - 2);
    f_level1 <= '0;
    f_cut    <= 1'b0;
    f_end    <= 1'b1;
    f_waited <= 1'b0;
    f_loaded <= 1'b0;
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
    assume (!result_valid_i || go_o || 32'(f_age) <= InFlight - 3);
    if (result_valid_i) assume (result_sof_i == f_end);
    if (result_valid_i && f_cut) assume (result_cut_i);

    // Never too many.
    assert (32'(level) <= Depth);
    assert (!write || 32'(level) < Depth);

    // In order, once each.
    assert (f_in - f_out == 6'(level) + 6'(valid_o));
    assert (f_seen == (f_place < f_in - f_out));
    if (f_seen && f_place == 0 && valid_o) assert (word == f_word);
    if (f_seen && !(f_place == 0 && valid_o)) assert (WordW'(u_waiting.mem[valid_o ? f_at : read_ptr_q[PtrW-1:0] + PtrW'(f_place)]) == f_word);
    if (f_waited) assert (valid_o && word == f_held);

    // From the result to the pixel that is handed over.
    if (f_loaded) assert (hold_valid_q && hold_data_q == f_data && hold_sof_q == f_sof && hold_eol_q == f_eol);
    if (write && !hold_end_q) assert (write_eol == (hold_eol_q ^ ~load));
    if (write && hold_end_q) assert (write_eol == hold_eol_q);
    if (hold_valid_q && hold_end_q) assert (write);
    if (write && !hold_end_q && !load) assert (f_count == 2'd3);

    // What makes these inductive.
    assert (!go_o || 32'(f_level1) < Depth - InFlight);
    assert (32'(level) + 32'(hold_valid_q) <= 32'(f_level1) + 2);
    assert (32'(level) + 32'(hold_valid_q) <= Depth - InFlight + 1 + (go_o ? 0 : 32'(f_age)));
    assert (f_age != '0 && 32'(f_age) <= InFlight - 2);
    if (!f_end) assert (count_q == f_count && count_q != '0);
    if (hold_valid_q) assert (hold_end_q == f_end);
    if (hold_valid_q && !hold_end_q) assert (!f_end);
  end
end
