// SPDX-License-Identifier: Apache-2.0
// Properties of vista_rectify_rows, inside it: each frame is handed over row by row from 0 to H - 1, each with what it
// needs and frees; a row comes only when the rows that it needs are there; its control points are read once each, in
// order; and a segment always finds room.
//
// Assumed of vista_rectify_ring and the framer: the frame that waits begins behind the rows that are needed, and the line
// buffer holds what lies between.

localparam int unsigned FLatency = ValueLatency + 2;  // from the read of a lower point to its segment

logic            f_started = 1'b0;
logic [RowW-1:0] f_y;     // the row that is handed over next, or is being read
logic            f_busy;  // there is a frame
logic [FLatency-2:0] f_pipe;  // segments that will come
logic [3:0]      f_coming;
logic [1:0]      f_held;  // segments in the buffer

always_comb begin
  f_coming = '0;
  for (int unsigned i = 0; i < FLatency - 1; i++) f_coming += 4'(f_pipe[i]);
end

assign f_held = {1'b0, segment_valid_o} + {1'b0, ~segments_ready};

always_ff @(posedge clk_i) begin
  if (!rst_ni) f_started <= 1'b1;
  f_pipe <= {f_pipe[FLatency-3:0], read & (point_q != '0)};
  if (frame_valid_i & frame_ready_o) begin
    f_busy <= 1'b1;
    f_y    <= '0;
  end
  if (row_end) begin
    f_y <= f_y + 1'b1;
    if (f_y == last_row_q) f_busy <= 1'b0;
  end
  if (!rst_ni) begin
    f_busy <= 1'b0;
    f_pipe <= '0;
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
    if (state_q == StWait && frame_valid_i) assume (base_i - needed_o != '0 && base_i - needed_o <= NumberW'(NumRows));
    if (state_q == StPoints) assert (last_taken_q == (f_y == last_row_q));

    assert (f_busy == (state_q != StIdle));
    assert (frame_ready_o == (frame_valid_i & ~f_busy));
    if (f_busy) assert (y_q == f_y && f_y <= last_row_q);
    if (state_q == StWait) begin
      assert (needed_o == base_q + NumberW'((32'(f_y) + Reach + 1 < 32'(last_row_q)) ? f_y + RowW'(Reach + 1)
                                                                                    : last_row_q));
      assert (ended_q == (f_y == last_row_q) && end_q == base_q + NumberW'(last_row_q) + 1'b1);
      assert (free_q == base_q + NumberW'((32'(f_y) + 1 > Reach) ? f_y + 1'b1 - RowW'(Reach) : '0));
    end
    if (row_valid) assert (number_i != needed_o && state_q == StWait);
    if (frame_end) assert (f_y == last_row_q && point_q == last_point_q);
    if (state_q == StPoints) assert (point_q <= last_point_q);

    assert (!segment_valid_q || segments_ready);
    assert (4'(ahead_q) == f_coming + 4'(f_held) && 32'(ahead_q) <= Ahead);

    // What makes these inductive.
    assert (f_pipe[0] == (lower1_q & ~first1_q));
    for (int unsigned i = 0; i < ValueLatency - 1; i++)
      assert (f_pipe[i+1] == (value_valid_q[i] & ~value_first_q[i]));
    assert (segment_valid_q == f_pipe[FLatency-2]);
    if (f_busy) assert (number_q == base_q + NumberW'(f_y));
    if (state_q == StNeed) assert (far_q == (32'(last_row_q) > 32'(f_y) + Reach + 1));
    if (state_q == StWait || state_q == StPoints)
      assert (32'(far_rows_q) == ((32'(last_row_q) > Reach + 2) ? 32'(last_row_q) - Reach - 2 : 0));
    if (lower_q && state_q == StPoints) assert (far_next_q == (32'(last_row_q) > 32'(f_y) + Reach + 2));
    if (lower_q && state_q == StPoints && point_q != '0) assert (32'(ahead_q) < Ahead);
  end
end
