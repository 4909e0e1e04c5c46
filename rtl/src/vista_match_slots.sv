// SPDX-License-Identifier: Apache-2.0
// Adds to the slots of video what the matching of blocks needs: which rows and columns fill the block, and when the words
// of a frame may begin to leave.
//
// Latency: none; `slot_o` and `begin_*_o` belong to what came a clock before, as `store_*_o` of vista_framer do.

module vista_match_slots #(
  parameter int unsigned NumDisparities = 32,
  parameter int unsigned BlockSize = 11,
  parameter int unsigned MaxWidth = 1024,
  localparam int unsigned ColW = $clog2(MaxWidth),
  localparam int unsigned RowW = vista_stereo_pkg::HeightW
) (
  input  logic clk_i,
  input  logic rst_ni,

  // The slot of the next clock; and, as long as it is the first one of its row, its frame (vista_framer).
  input  vista_stereo_pkg::video_slot_t slot_next_i,
  input  logic [ColW-1:0]               slot_next_col_i,
  input  logic [ColW-1:0]               last_col_i,  // W - 1
  input  logic [RowW-1:0]               last_row_i,  // H - 1
  input  logic                          narrow_i,    // words of two disparities

  output vista_stereo_pkg::slot_t slot_o,
  output logic [ColW-1:0]         slot_col_o,

  // The frame whose words may start to leave.
  output logic            begin_valid_o,
  output logic [ColW-1:0] begin_last_col_o,
  output logic [RowW-1:0] begin_last_row_o,
  output logic            begin_narrow_o
);

  import vista_stereo_pkg::*;

  localparam int unsigned Radius = BlockSize / 2;
  localparam int unsigned RowsW = $clog2(BlockSize + 1);
  localparam int unsigned FirstMatchCol = NumDisparities - 1 + 2 * Radius;

  logic [RowsW-1:0] rows_q, rows;  // of the frame before this one, saturating at B
  logic match_wide_q;  // wide enough for a row to have matched pixels
  slot_t slot_d;

  assign rows = slot_next_i.first_row ? '0 : rows_q;

  always_comb begin
    slot_d            = '0;
    slot_d.valid      = slot_next_i.valid;
    slot_d.first_col  = slot_next_i.first_col;
    slot_d.last_col   = slot_next_i.last_col;
    slot_d.before_col = (32'(slot_next_col_i) < NumDisparities - 1);
    slot_d.early_col  = (32'(slot_next_col_i) < NumDisparities - 1 + BlockSize);
    slot_d.first_row  = slot_next_i.first_row;
    slot_d.last_row   = slot_next_i.last_row;
    slot_d.flat       = slot_next_i.flat;
    slot_d.leave      = (32'(rows) == BlockSize);
    slot_d.match_row  = (32'(rows) >= BlockSize - 1) & match_wide_q;
    slot_d.match      = slot_d.match_row & (32'(slot_next_col_i) >= FirstMatchCol);
    slot_d.cut        = slot_next_i.cut;
  end

  always_ff @(posedge clk_i) begin
    if (slot_next_i.valid & slot_next_i.last_col & (32'(rows) != BlockSize)) rows_q <= rows + 1'b1;
    if (slot_next_i.valid & slot_next_i.first_row & slot_next_i.first_col) begin
      match_wide_q <= (32'(last_col_i) >= FirstMatchCol);
    end
    slot_o     <= slot_d;
    slot_col_o <= slot_next_col_i;
    if (!rst_ni) slot_o.valid <= 1'b0;
  end

  // Words may leave once row r is being matched: from there on they keep pace with the input. A frame of no more than r
  // rows has no such row and begins with its last one.
  logic begun_q, begin_now;

  assign begin_now = slot_next_i.valid & slot_next_i.first_col & ~begun_q &
      (slot_next_i.last_row | (32'(rows) == Radius));

  always_ff @(posedge clk_i) begin
    begin_valid_o    <= begin_now;
    begin_last_col_o <= last_col_i;
    begin_last_row_o <= last_row_i;
    begin_narrow_o   <= narrow_i;
    if (slot_next_i.valid & slot_next_i.first_row) begun_q <= 1'b0;
    if (begin_now) begun_q <= 1'b1;
    if (!rst_ni) begin
      begun_q       <= 1'b0;
      begin_valid_o <= 1'b0;
    end
  end

`ifdef VISTA_ASSERT
  `include "vista_match_slots_properties.svh"
`endif

endmodule
