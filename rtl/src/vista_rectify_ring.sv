// SPDX-License-Identifier: Apache-2.0
// Counts the rows that go round in the line buffers, and stops the video before it runs into rows that are still needed.
//
// Rows are numbered on and on, from frame to frame. A row may begin once the one that lay in its place, NumRows before
// it, is free. Of each row it is kept whether there is filler in it, which a frame that was cut ends with.
//
// Latency: none from a stored pixel to `go_o`, which belongs to the pixel behind it; 1 clock to `number_o`, and from
// `free_i` to `go_o`.

module vista_rectify_ring #(
  parameter int unsigned NumRows = 64,
  localparam int unsigned RingW = $clog2(NumRows),
  localparam int unsigned NumberW = RingW + 2
) (
  input  logic clk_i,
  input  logic rst_ni,

  input  logic            frame_start_i,  // beside the first pixel of a frame
  input  logic            broken_i,       // the next pixels of the frame are filler
  input  logic            store_valid_i,
  input  logic            store_last_i,   // of its row
  input  logic            frame_room_i,   // a frame may begin
  output logic            go_o,           // a further pixel may come

  output logic [NumberW-1:0] number_o,  // of the row that is arriving, or comes next
  input  logic [NumberW-1:0] free_i,    // the oldest row that is still needed
  input  logic [RingW-1:0]   row_i,     // a place
  output logic               cut_o      // there is filler in its row
);

  logic [NumRows-1:0] cut_rows_q;
  logic cut_q, begins_q, begins, row_end, room_q, more_room_q;
  logic [NumberW-1:0] room;

  assign row_end = store_valid_i & store_last_i;
  assign begins  = store_valid_i ? row_end : begins_q;  // the next pixel begins a row
  // Rows that may come, with the one that arrives in the next clock. Less than none there are only after an upset; then
  // the reader has to catch up.
  assign room    = free_i + NumberW'(NumRows) - number_o - NumberW'(row_end);
  assign go_o    = ~begins | ((row_end ? more_room_q : room_q) & frame_room_i);
  assign cut_o   = cut_rows_q[row_i];

  always_ff @(posedge clk_i) begin
    room_q      <= ~room[NumberW-1] & (room != '0);
    more_room_q <= ~room[NumberW-1] & (room > NumberW'(1));
    if (row_end) begin
      number_o                        <= number_o + 1'b1;
      cut_rows_q[number_o[RingW-1:0]] <= cut_q;
    end
    begins_q <= begins;
    if (frame_start_i) cut_q <= 1'b0;
    if (broken_i) cut_q <= 1'b1;
    if (!rst_ni) begin
      number_o    <= '0;
      cut_q       <= 1'b0;
      begins_q    <= 1'b1;
      room_q      <= 1'b1;
      more_room_q <= 1'b1;
    end
  end

`ifdef VISTA_ASSERT
  `include "vista_rectify_ring_properties.svh"
`endif

endmodule
