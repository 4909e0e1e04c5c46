// SPDX-License-Identifier: Apache-2.0
// Walks over the rows of each frame: waits until the line buffer holds what a row needs, hands the row over, and reads
// its control points, which make one segment of up to 16 pixels after the other.
//
// Rows of the line buffer are numbered on and on, from frame to frame. Row y of a frame needs the rows up to Reach + 1
// below it, as far as the frame has them; once it is read, the rows more than Reach above the next one are free. A frame
// that was cut has filler in its last rows: a row that might need any is handed over as cut.
//
// A bit that is upset may make a frame need rows that it has not got. It then ends with the row that would need the first
// one of the next frame, as soon as that has begun to arrive.
//
// Latency: 3 clocks from the last row needed to `row_valid_o`; ValueLatency + 6 from there to `segment_valid_o`. A
// column of control points takes 2 clocks, a row 2 more.

module vista_rectify_rows #(
  parameter int unsigned MaxWidth = 1024,
  parameter int unsigned NumRows = 64,
  parameter int unsigned MaxPoints = 2048,
  parameter int unsigned SideWidth = 1,
  localparam int unsigned ColW = $clog2(MaxWidth),
  localparam int unsigned RowW = vista_stereo_pkg::HeightW,
  localparam int unsigned NumberW = $clog2(NumRows) + 2,
  localparam int unsigned PointW = $clog2(MaxPoints),
  localparam int unsigned StepW = vista_rectify_pkg::StepW,
  localparam int unsigned ValueW = vista_rectify_pkg::ValueW,
  localparam int unsigned SlopeW = vista_rectify_pkg::SlopeW
) (
  input  logic clk_i,
  input  logic rst_ni,

  // Frames that are arriving, oldest first.
  input  logic                 frame_valid_i,
  output logic                 frame_ready_o,  // the frame is taken over
  input  logic [ColW-1:0]      last_col_i,
  input  logic [RowW-1:0]      last_row_i,
  input  logic [NumberW-1:0]   base_i,    // the number of its first row
  input  logic                 on_i,      // 0: pixels stay where they are
  input  logic                 bank_i,    // of the map
  input  logic [SideWidth-1:0] side_i,
  output logic                 idle_o,       // no frame was taken over that has rows left
  output logic                 frame_end_o,  // one clock: all its control points were read

  input  logic [NumberW-1:0] number_i,  // of the row that is arriving: those before it are there
  output logic [NumberW-1:0] needed_o,  // the number of the last row that the next row needs
  input  logic               cut_i,     // that row has filler in it

  // Requests to the control points, and their values.
  output logic             on_o,
  output logic [StepW-1:0] j_o,
  output logic [PointW:0]  addr_o,
  input  logic signed [3:0][ValueW-1:0] value_i,  // left dx, dy, right dx, dy

  output logic                 row_valid_o,
  input  logic                 row_ready_i,
  output logic                 row_first_o,
  output logic                 row_last_o,
  output logic                 row_cut_o,
  output logic [RowW-1:0]      row_y_o,
  output logic [NumberW-1:0]   row_base_o,
  output logic [ColW-1:0]      row_last_col_o,
  output logic [RowW-1:0]      row_last_row_o,
  output logic [NumberW-1:0]   row_free_o,  // the first row that is still needed after this one
  output logic [SideWidth-1:0] row_side_o,

  output logic segment_valid_o,
  input  logic segment_ready_i,
  output logic       segment_first_o,  // of its row; and that is the first of its frame
  output logic       segment_top_o,
  output logic signed [3:0][ValueW-1:0] segment_value_o,  // at its first pixel, and 16 pixels on less that
  output logic signed [3:0][SlopeW-1:0] segment_slope_o
);

  import vista_rectify_pkg::*;

  localparam int unsigned Reach = reach(NumRows);
  localparam int unsigned Ahead = 2;  // segments that have room
  localparam int unsigned AheadW = 4;
  localparam int unsigned PointsW = RowW - 3;
  localparam int unsigned RecordW = 3 + 2 * RowW + ColW + 2 * NumberW + SideWidth;

  typedef enum logic [1:0] {
    StIdle,    // no frame
    StNeed,    // the rows that a row needs are being numbered
    StWait,    // until they are there
    StPoints   // the row's control points are read
  } state_e;

  state_e state_q;
  logic [ColW-1:0] last_col_q;
  logic [RowW-1:0] last_row_q, y_q;
  logic [NumberW-1:0] base_q, number_q;  // of the first row and of row y_q
  logic [RowW-1:0] far_rows_q;  // how many rows are followed by one behind which are more rows than it may need
  logic far_q, far_next_q;  // so it is behind row y_q, and behind the one after it
  logic on_q, bank_q;
  logic [SideWidth-1:0] side_q;
  logic [PointsW-1:0] last_point_q, point_q;  // the last control point of a row; the one to be read
  logic [PointW-1:0]  upper_addr_q;           // of the first point in the row of points above
  logic               lower_q;                // the lower one is read now
  logic [1:0]         ahead_q;
  logic [AheadW-1:0]  under_way;
  logic               ended_q;        // y_q is the last row
  logic [NumberW-1:0] free_q, end_q;  // the first row that is still needed after row y_q, and the one behind the frame

  logic last, last_taken_q, beyond, row_valid, row_ready, there, point, read, row_end, frame_end, segment_take;
  logic [NumberW-1:0] behind, over;

  // The row that is needed belongs to the frame that waits.
  assign over   = needed_o - base_i;
  assign beyond = frame_valid_i & ~over[NumberW-1];
  assign last   = ended_q | beyond;

  // The row that is arriving lies behind the last one needed.
  assign behind    = number_i - needed_o - 1'b1;
  assign there     = ~behind[NumberW-1];
  assign row_valid = (state_q == StWait) & (there | beyond);

  assign point     = (state_q == StPoints) & ((point_q == '0) | (32'(ahead_q) != Ahead) | lower_q);
  assign read      = point & lower_q;
  assign row_end   = read & (point_q >= last_point_q);
  assign frame_end = row_end & last_taken_q;
  assign idle_o        = (state_q == StIdle);
  assign frame_ready_o = frame_valid_i & idle_o;
  assign segment_take  = segment_valid_o & segment_ready_i;

  always_ff @(posedge clk_i) begin
    unique case (state_q)
      StIdle: if (frame_valid_i) state_q <= StNeed;
      StNeed: state_q <= StWait;
      StWait: if (row_valid & row_ready) state_q <= StPoints;
      default: if (row_end) state_q <= last_taken_q ? StIdle : StNeed;
    endcase

    if (frame_ready_o) begin
      last_col_q   <= last_col_i;
      last_row_q   <= last_row_i;
      base_q       <= base_i;
      number_q     <= base_i;
      far_q        <= (32'(last_row_i) > Reach + 1);
      on_q         <= on_i;
      bank_q       <= bank_i;
      side_q       <= side_i;
      y_q          <= '0;
      upper_addr_q <= '0;
      last_point_q <= PointsW'(last_point(32'(last_col_i) + 1));
    end
    if (state_q == StNeed) begin
      needed_o <= far_q ? number_q + NumberW'(Reach + 1) : base_q + NumberW'(last_row_q);
      ended_q  <= (y_q >= last_row_q);
      free_q   <= (32'(y_q) >= Reach) ? number_q - NumberW'(Reach - 1) : base_q;
      end_q    <= base_q + NumberW'(last_row_q) + 1'b1;
    end
    if (state_q == StWait) begin
      point_q      <= '0;
      lower_q      <= 1'b0;
      last_taken_q <= last;
    end
    if (point) lower_q <= ~lower_q;
    if (read) point_q <= point_q + 1'b1;
    if (row_end) begin
      y_q      <= y_q + 1'b1;
      number_q <= number_q + 1'b1;
      far_q    <= far_next_q;
      if (32'(y_q[StepW-1:0]) == StepPx - 1) upper_addr_q <= upper_addr_q + PointW'(last_point_q) + 1'b1;
    end
    far_rows_q  <= (32'(last_row_q) > Reach + 2) ? last_row_q - RowW'(Reach + 2) : '0;
    far_next_q  <= (y_q < far_rows_q);
    ahead_q     <= 2'(under_way + AheadW'(read & (point_q != '0)) - AheadW'(segment_take));
    frame_end_o <= frame_end;

    if (!rst_ni) begin
      state_q     <= StIdle;
      ahead_q     <= '0;
      frame_end_o <= 1'b0;
    end
  end

  vista_skid #(
    .Width(RecordW)
  ) u_rows (
    .clk_i,
    .rst_ni,
    .valid_i (row_valid),
    .ready_o (row_ready),
    .data_i  ({
      y_q == '0, last, cut_i, y_q, base_q, last_col_q, last_row_q,
      beyond ? base_i : ended_q ? end_q : free_q, side_q
    }),
    .valid_o (row_valid_o),
    .ready_i (row_ready_i),
    .data_o  ({
      row_first_o, row_last_o, row_cut_o, row_y_o, row_base_o, row_last_col_o, row_last_row_o, row_free_o, row_side_o
    })
  );

  // The points' addresses, and what their values will be.
  logic lower1_q, first1_q, second1_q, top1_q;

  always_ff @(posedge clk_i) begin
    addr_o   <= {bank_q, upper_addr_q + PointW'(point_q) + (lower_q ? PointW'(last_point_q) + 1'b1 : '0)};
    j_o      <= y_q[StepW-1:0];
    on_o     <= on_q;
    lower1_q <= read;
    first1_q <= (point_q == '0);
    second1_q <= (32'(point_q) == 1);
    top1_q   <= (y_q == '0);
    if (!rst_ni) lower1_q <= 1'b0;
  end

  logic [ValueLatency-2:0] value_valid_q;
  logic [ValueLatency-2:0] value_first_q;  // of a row: no segment ends there
  logic [ValueLatency-2:0] value_second_q, value_top_q;  // the first segment of a row does; of a frame's first row
  logic segment_valid_q, lead_q, top_q;
  logic signed [3:0][ValueW-1:0] before_q, first_q;
  logic signed [3:0][SlopeW-1:0] slope_q;

  always_ff @(posedge clk_i) begin
    value_valid_q <= {value_valid_q[ValueLatency-3:0], lower1_q};
    value_first_q <= {value_first_q[ValueLatency-3:0], first1_q};
    value_second_q <= {value_second_q[ValueLatency-3:0], second1_q};
    value_top_q   <= {value_top_q[ValueLatency-3:0], top1_q};
    if (value_valid_q[ValueLatency-2]) before_q <= value_i;
    segment_valid_q <= value_valid_q[ValueLatency-2] & ~value_first_q[ValueLatency-2];
    first_q         <= before_q;
    lead_q          <= value_second_q[ValueLatency-2];
    top_q           <= value_top_q[ValueLatency-2];
    for (int unsigned i = 0; i < 4; i++) slope_q[i] <= SlopeW'(signed'(value_i[i])) - SlopeW'(signed'(before_q[i]));
    if (!rst_ni) begin
      value_valid_q   <= '0;
      segment_valid_q <= 1'b0;
    end
  end

  logic segments_ready;

  // Segments that will come, and those in the buffer. Counted anew in each clock, so no error of theirs lasts.
  always_comb begin
    under_way = AheadW'(lower1_q && !first1_q) + AheadW'(segment_valid_q) + AheadW'(segment_valid_o) +
        AheadW'(!segments_ready);
    for (int unsigned i = 0; i < ValueLatency - 1; i++) under_way += AheadW'(value_valid_q[i] && !value_first_q[i]);
  end

  vista_skid #(
    .Width(2 + 4 * (ValueW + SlopeW))
  ) u_segments (
    .clk_i,
    .rst_ni,
    .valid_i (segment_valid_q),
    .ready_o (segments_ready),
    .data_i  ({lead_q, top_q, first_q, slope_q}),
    .valid_o (segment_valid_o),
    .ready_i (segment_ready_i),
    .data_o  ({segment_first_o, segment_top_o, segment_value_o, segment_slope_o})
  );

`ifdef VISTA_ASSERT
  `include "vista_rectify_rows_properties.svh"
`endif

endmodule
