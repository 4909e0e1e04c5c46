// SPDX-License-Identifier: Apache-2.0
// Takes the maps of rectification, one point a write, and tells which of two banks holds the newest complete one.
//
// A map is loaded with `begin_i`, then a write for every control point, row by row, of the left camera and then of the
// right one, then `commit_i`. It is checked as it comes in: a point whose dy needs a row that the line buffer does not
// hold, a number of points that is not that of the size, or more points than there is memory for, and the commit is
// refused: the map before it stays in force. As only a whole load can be committed, no unchecked point is ever followed.
//
// A map that is committed counts for the frames that begin from then on. Frames on their way keep the other bank until
// the last of them was read; only then `ready_o` is up again, and a new load may begin. What is written while it is down
// is lost, and so is the load. A reset with `keep_i` drops the load and the frames, and the map in force stays.
//
// Latency: 1 clock from a write to the memory's; 1 from `commit_i` to the verdict.

module vista_rectify_map #(
  parameter int unsigned MaxWidth = 1024,
  parameter int unsigned NumRows = 64,
  parameter int unsigned MaxPoints = 2048,  // of a camera; rounded up to a power of two
  parameter bit Parity = 1'b0,
  localparam int unsigned ColW = $clog2(MaxWidth),
  localparam int unsigned RowW = vista_stereo_pkg::HeightW,
  localparam int unsigned PointW = $clog2(MaxPoints),
  localparam int unsigned OffsetW = vista_rectify_pkg::OffsetW
) (
  input  logic clk_i,
  input  logic rst_ni,
  input  logic keep_i,

  input  logic                 begin_i,
  input  logic [ColW:0]        width_i,   // of the frames that the map is for, with `begin_i`
  input  logic [RowW-1:0]      height_i,
  input  logic                 write_i,
  input  logic [2*OffsetW-1:0] data_i,    // {dy, dx}
  input  logic                 commit_i,
  output logic                 ready_o,

  output logic accepted_o,      // one clock: the map is in force
  output logic refused_rows_o,  // one clock: it needs more rows than the line buffer has
  output logic refused_size_o,  // one clock: wrong number of points, or more than the memory holds

  // The newest complete map.
  output logic            valid_o,
  output logic            bank_o,
  output logic [ColW:0]   width_o,
  output logic [RowW-1:0] height_o,

  input  logic frame_begin_i,  // the first pixel of a frame is offered: it has the bank in force
  input  logic frame_end_i,    // all points of the oldest frame were read
  input  logic frame_drop_i,   // the newest one but those that wait was dropped, which had this bank
  input  logic frame_bank_i,

  output logic [1:0]           write_o,  // to the memory of each camera, the left one first
  output logic [PointW:0]      write_addr_o,
  output logic [2*OffsetW-1:0] write_data_o,
  output logic                 upset_o  // what is known of the map in force is not as it was loaded
);

  import vista_rectify_pkg::*;

  localparam int signed Lowest = -int'(reach(NumRows) * Scale);
  localparam int signed Highest = int'((reach(NumRows) + 1) * Scale) - 1;
  localparam int unsigned PointsW = RowW - 3;  // of the control points along a side
  localparam int unsigned CountW = 4;  // of frames on their way

  // The load.
  logic loading_q, right_q, full_q, too_far_q, wrong_q;
  logic [PointsW-1:0] col_q, row_q, last_col_q, last_row_q;
  logic [PointW:0] addr_q;  // with a bit for those beyond the memory
  logic [ColW:0]   load_width_q;
  logic [RowW-1:0] load_height_q;
  logic take, row_end, camera_end, too_far, accepted;
  logic signed [OffsetW-1:0] dy;

  assign dy         = data_i[OffsetW+:OffsetW];
  assign too_far    = (int'(dy) < Lowest) | (int'(dy) > Highest);
  assign take       = write_i & ready_o & loading_q;
  assign row_end    = (col_q == last_col_q);
  assign camera_end = row_end & (row_q == last_row_q);
  assign accepted   = commit_i & loading_q & full_q & ~too_far_q & ~wrong_q & ~write_i;

  always_ff @(posedge clk_i) begin
    if (take) begin
      addr_q <= camera_end ? '0 : addr_q[PointW] ? addr_q : addr_q + 1'b1;
      col_q     <= row_end ? '0 : col_q + 1'b1;
      if (row_end) row_q <= camera_end ? '0 : row_q + 1'b1;
      if (camera_end) right_q <= 1'b1;
      if (camera_end & right_q) full_q <= 1'b1;
      too_far_q <= too_far_q | too_far;
      wrong_q   <= wrong_q | full_q | addr_q[PointW];
    end
    if (write_i & ~ready_o) loading_q <= 1'b0;
    if (commit_i) loading_q <= 1'b0;
    if (begin_i) begin
      loading_q     <= ready_o & ~commit_i;
      right_q       <= 1'b0;
      full_q        <= 1'b0;
      too_far_q     <= 1'b0;
      wrong_q       <= 1'b0;
      addr_q        <= '0;
      col_q         <= '0;
      row_q         <= '0;
      last_col_q    <= PointsW'(last_point(32'(width_i)));
      last_row_q    <= PointsW'(last_point(32'(height_i)));
      load_width_q  <= width_i;
      load_height_q <= height_i;
    end
    accepted_o     <= accepted;
    refused_rows_o <= commit_i & loading_q & too_far_q;
    refused_size_o <= commit_i & ~accepted & ~(loading_q & too_far_q);
    if (!rst_ni) begin
      loading_q      <= 1'b0;
      accepted_o     <= 1'b0;
      refused_rows_o <= 1'b0;
      refused_size_o <= 1'b0;
    end
  end

  always_ff @(posedge clk_i) begin
    write_o      <= {2{take & ~full_q}} & {right_q, ~right_q};
    write_addr_o <= {~bank_o, addr_q[PointW-1:0]};
    write_data_o <= data_i;
    if (!rst_ni) write_o <= '0;
  end

  always_ff @(posedge clk_i) begin
    if (accepted & rst_ni) begin
      valid_o  <= 1'b1;
      bank_o   <= ~bank_o;
      width_o  <= load_width_q;
      height_o <= load_height_q;
    end
    if (!rst_ni & !keep_i) begin
      valid_o <= 1'b0;
      bank_o  <= 1'b0;
    end
  end

  // The map in force outlives frames, so a bit of it that is upset stays until a map is loaded anew.
  if (Parity) begin : gen_parity
    logic parity_q, changed_q;

    always_ff @(posedge clk_i) begin
      changed_q <= accepted | ~rst_ni;
      if (changed_q) parity_q <= ^{valid_o, bank_o, width_o, height_o};
      upset_o <= ~accepted & ~changed_q & rst_ni & (parity_q != ^{valid_o, bank_o, width_o, height_o});
    end
  end else begin : gen_no_parity
    assign upset_o = 1'b0;
  end

  // The other bank is free once the frames were read or dropped that began with it. They end in order, those that began
  // with it before the others.
  logic [CountW-1:0] frames_q, old_q, frames;

  assign frames  = frames_q + CountW'(frame_begin_i) - CountW'(frame_end_i) - CountW'(frame_drop_i);
  assign ready_o = (old_q == '0);

  always_ff @(posedge clk_i) begin
    frames_q <= frames;
    if (accepted) old_q <= frames;
    else old_q <= old_q - CountW'(frame_end_i & (old_q != '0)) - CountW'(frame_drop_i & (frame_bank_i != bank_o));
    if (!rst_ni) begin
      frames_q <= '0;
      old_q    <= '0;
    end
  end

`ifdef VISTA_ASSERT
  `include "vista_rectify_map_properties.svh"
`endif

endmodule
