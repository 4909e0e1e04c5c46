// SPDX-License-Identifier: Apache-2.0
// Properties of vista_pair_sync, inside it, for any input that stays until it is taken: what waits holds still; a pair is
// made of two pixels that are both there, both the first of a frame or neither, and neither behind a gap, and takes both; a
// pixel alone is only dropped.

logic f_started = 1'b0;
logic f_waited;
logic [2*PixelW+1:0] f_held;
logic [1:0] f_waits;
logic [1:0][PixelW+2:0] f_beat, f_before;

for (genvar i = 0; i < 2; i++) begin : gen_f
  assign f_beat[i] = {gap_i[i], sof_i[i], eol_i[i], data_i[i]};
end

always_ff @(posedge clk_i) begin
  if (!rst_ni) f_started <= 1'b1;
  f_waited <= rst_ni & valid_o & ~ready_i;
  f_held   <= {sof_o, eol_o, data_o};
  f_waits  <= {2{rst_ni}} & valid_i & ~ready_o;
  f_before <= f_beat;
end

`ifdef VERILATOR
`include "vista_settled.svh"
always_ff @(posedge clk_i) if (f_settled) begin
`else
always_comb begin
  if (!f_started) assume (!rst_ni);
`endif
  if (f_started && rst_ni) begin
    for (int unsigned i = 0; i < 2; i++) if (f_waits[i]) assume (valid_i[i] && f_beat[i] == f_before[i]);

    if (f_waited) assert (valid_o && {sof_o, eol_o, data_o} == f_held);
    assert ((ready_o & ~valid_i) == '0);
    if (valid_o && !ending_q) begin
      assert (valid_i == '1 && gap_i == '0 && sof_i[0] == sof_i[1] && sof_o == sof_i[0]);
      assert (data_o == data_i && ready_o == {2{ready_i}});
      if (!sof_o) assert (eol_i[0] == eol_i[1] && paired_q);
    end else begin
      assert (!pair_o && !(ready_o != '0 && paired_q && refused_o == '0));
    end

    // What makes these inductive.
    assert (!(ending_q && paired_q) && !((ending_q || paired_q) && stale_q != '0));
  end
end
