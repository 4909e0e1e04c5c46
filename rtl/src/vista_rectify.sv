// SPDX-License-Identifier: Apache-2.0
// Rectification of both images by a grid of control points, part C of the contract, before everything else.
//
//   s_axis, m_axis  tdata {right[7:0], left[7:0]}, tuser start of frame, tlast end of line, one pixel pair a beat
//   map_*           a new map, see vista_rectify_map; it takes effect from the next frame on
//
// Rows go round in a line buffer of NumRows for each camera. Row y leaves when the rows up to NumRows/2 - 1 below it are
// there, the last rows of a frame when the frame is: so frames follow each other without a gap, and the last one needs
// no follower. With `rectify_i` off pixels pass unchanged, with the same latency.
//
// A frame that is to be rectified while there is no map for its size is dropped, with `error_map_o`. Framing errors:
// those of vista_framer. A frame that is cut ends with its last row that could be computed from what came
// (vista_pixel_writer); everything else is dropped up to the next start of frame.
//
// Latency: pixel (0, y) leaves 33 clocks after the last pixel of row y + NumRows/2 - 1 came. One pixel per clock, frames
// back to back, if they are 21 pixels wide or more; narrower ones wait for some clocks in each row.

module vista_rectify #(
  parameter int unsigned MaxWidth = 1024,
  parameter int unsigned NumRows = 64,  // 16, 32, 64 or 128
  parameter int unsigned MaxPoints = 2048,  // control points of a camera; rounded up to a power of two
  parameter int unsigned SideWidth = 1,
  parameter bit Parity = 1'b0,
  localparam int unsigned ColW = $clog2(MaxWidth),
  localparam int unsigned RowW = vista_stereo_pkg::HeightW,
  localparam int unsigned PixelW = vista_stereo_pkg::PixelW,
  localparam int unsigned OffsetW = vista_rectify_pkg::OffsetW
) (
  input  logic clk_i,
  input  logic rst_ni,
  input  logic keep_map_i,  // 1: a reset leaves the map in force as it is

  // A frame has what is set in the clock in which its first pixel is first offered.
  input  logic                 enable_i,
  input  logic [ColW:0]        width_i,   // 4 .. MaxWidth
  input  logic [RowW-1:0]      height_i,  // 2 ..
  input  logic                 rectify_i,
  input  logic [SideWidth-1:0] side_i,    // whatever else belongs to the frame, passed on

  input  logic                s_axis_tvalid,
  output logic                s_axis_tready,
  input  logic [2*PixelW-1:0] s_axis_tdata,
  input  logic                s_axis_tuser,
  input  logic                s_axis_tlast,

  output logic                m_axis_tvalid,
  input  logic                m_axis_tready,
  output logic [2*PixelW-1:0] m_axis_tdata,
  output logic                m_axis_tuser,
  output logic                m_axis_tlast,

  // Properties of the frame that is leaving; they change when its first pixel is offered.
  output logic [ColW:0]        width_o,
  output logic [RowW-1:0]      height_o,
  output logic [SideWidth-1:0] side_o,

  input  logic                 map_begin_i,
  input  logic [ColW:0]        map_width_i,
  input  logic [RowW-1:0]      map_height_i,
  input  logic                 map_write_i,
  input  logic [2*OffsetW-1:0] map_data_i,  // {dy, dx}
  input  logic                 map_commit_i,
  output logic                 map_ready_o,

  output logic busy_o,  // a pixel of a frame that is to be taken waits

  // Events, one clock each.
  output logic map_accepted_o,
  output logic map_refused_rows_o,  // it needs more rows than NumRows - 2
  output logic map_refused_size_o,
  output logic frame_start_o,
  output logic error_map_o,
  output logic error_early_eol_o,
  output logic error_late_eol_o,
  output logic error_early_sof_o,
  output logic error_late_sof_o,
  output logic error_size_o,
  output logic upset_o  // of a memory
);

  import vista_stereo_pkg::*;
  import vista_rectify_pkg::*;

  localparam int unsigned DataW = 2 * PixelW;
  localparam int unsigned RingW = $clog2(NumRows);
  localparam int unsigned NumberW = RingW + 2;
  localparam int unsigned PointW = $clog2(MaxPoints);
  localparam int unsigned FrameW = ColW + RowW + NumberW + 2 + SideWidth;
  localparam int unsigned AllSideW = SideWidth + RowW + ColW + 1;

  if (MaxWidth < MinWidth || MaxWidth > 4096) begin : gen_bad_width
    $fatal(1, "MaxWidth must be 4 .. 4096");
  end
  if (NumRows != 16 && NumRows != 32 && NumRows != 64 && NumRows != 128) begin : gen_bad_rows
    $fatal(1, "NumRows must be 16, 32, 64 or 128");
  end
  if (MaxPoints < SmallestMap || MaxPoints > LargestMap) begin : gen_bad_points
    $fatal(1, "MaxPoints must be 4 .. 8388608");
  end
  if (SideWidth < 1) begin : gen_bad_side
    $fatal(1, "SideWidth must be 1 or more");
  end

  // The newest map, and whether it is one for a frame that begins now.
  logic map_valid, bank, map_ok;
  logic [ColW:0] map_width;
  logic [RowW-1:0] map_height;

  assign map_ok = ~rectify_i | (map_valid & (map_width == width_i) & (map_height == height_i));

  logic head_valid, head_ready, head_sof, head_eol, head_enable, head_admit, head_no_map, head_rectify, head_bank;
  logic [DataW-1:0] head;
  logic [ColW-1:0] head_last_col;
  logic [RowW-1:0] head_last_row;
  logic [SideWidth-1:0] head_side;

  vista_frame_input #(
    .MaxWidth  (MaxWidth),
    .SideWidth (3 + SideWidth)
  ) u_input (
    .clk_i,
    .rst_ni,
    .enable_i   (enable_i & map_ok),
    .width_i,
    .height_i,
    .side_i     ({enable_i & ~map_ok, rectify_i, bank, side_i}),
    .valid_i    (s_axis_tvalid),
    .ready_o    (s_axis_tready),
    .sof_i      (s_axis_tuser),
    .eol_i      (s_axis_tlast),
    .data_i     (s_axis_tdata),
    .valid_o    (head_valid),
    .ready_i    (head_ready),
    .sof_o      (head_sof),
    .eol_o      (head_eol),
    .data_o     (head),
    .enable_o   (head_enable),
    .admit_o    (head_admit),
    .last_col_o (head_last_col),
    .last_row_o (head_last_row),
    .side_o     ({head_no_map, head_rectify, head_bank, head_side}),
    .busy_o
  );

  logic take_go, store_valid, store_last;
  logic [ColW-1:0] store_col;
  logic [DataW-1:0] store_data;

  logic begun_rectify, begun_bank;
  logic [ColW-1:0] begun_last_col;
  logic [RowW-1:0] begun_last_row;
  logic [SideWidth-1:0] begun_side;

  // Only the pixels that it lets pass are wanted, not its slots.
  vista_framer #(
    .MaxWidth  (MaxWidth),
    .SideWidth (2 + SideWidth)
  ) u_framer (
    .clk_i,
    .rst_ni,
    .valid_i         (head_valid),
    .ready_o         (head_ready),
    .sof_i           (head_sof),
    .eol_i           (head_eol),
    .data_i          (head),
    .enable_i        (head_enable),
    .admit_i         (head_admit),
    .last_col_i      (head_last_col),
    .last_row_i      (head_last_row),
    .side_i          ({head_rectify, head_bank, head_side}),
    .go_i            (take_go),
    .slot_next_o     (),
    .slot_next_col_o (),
    .store_valid_o   (store_valid),
    .store_col_o     (store_col),
    .store_last_o    (store_last),
    .store_data_o    (store_data),
    .last_col_o      (begun_last_col),
    .last_row_o      (begun_last_row),
    .side_o          ({begun_rectify, begun_bank, begun_side}),
    .frame_start_o,
    .error_early_eol_o,
    .error_late_eol_o,
    .error_early_sof_o,
    .error_late_sof_o,
    .error_size_o
  );

  // A first pixel was taken, with the map of its frame. The framer tells in the same clock whether the frame began.
  logic head_q, bank_q;

  always_ff @(posedge clk_i) begin
    head_q      <= head_valid & head_ready & head_sof & rst_ni;
    error_map_o <= head_valid & head_ready & head_sof & head_no_map & rst_ni;
    bank_q      <= head_bank;
  end

  // A first pixel is offered. Its frame has the map in force, and so keeps its bank.
  logic waiting_q, offered;

  assign offered = s_axis_tvalid & s_axis_tuser & ~waiting_q;

  always_ff @(posedge clk_i) waiting_q <= s_axis_tvalid & ~s_axis_tready & rst_ni;

  logic [NumberW-1:0] number, needed;
  logic [ReadLatency-1:0][NumberW-1:0] free_delay_q;
  logic frame_room, row_needed_cut;

  vista_rectify_ring #(
    .NumRows(NumRows)
  ) u_ring (
    .clk_i,
    .rst_ni,
    .frame_start_i (frame_start_o),
    .broken_i      (error_early_eol_o | error_late_eol_o | error_early_sof_o),
    .store_valid_i (store_valid),
    .store_last_i  (store_last),
    .frame_room_i  (frame_room),
    .go_o          (take_go),
    .number_o      (number),
    .free_i        (free_delay_q[ReadLatency-1]),
    .row_i         (needed[RingW-1:0]),
    .cut_o         (row_needed_cut)
  );

  // Frames, from the writing of the line buffer to its reading.
  logic frame_valid, frame_ready, frame_on, frame_bank, frame_end, rows_idle;
  logic [ColW-1:0] frame_last_col;
  logic [RowW-1:0] frame_last_row;
  logic [NumberW-1:0] frame_base;
  logic [SideWidth-1:0] frame_side;

  vista_skid #(
    .Width(FrameW)
  ) u_frames (
    .clk_i,
    .rst_ni,
    .valid_i (frame_start_o),
    .ready_o (frame_room),
    .data_i  ({begun_last_col, begun_last_row, number, begun_rectify, begun_bank, begun_side}),
    .valid_o (frame_valid),
    .ready_i (frame_ready),
    .data_o  ({frame_last_col, frame_last_row, frame_base, frame_on, frame_bank, frame_side})
  );

  logic points_on;
  logic [StepW-1:0] points_j;
  logic [PointW:0]  points_addr;
  logic signed [1:0][1:0][ValueW-1:0] values;

  logic row_valid, row_ready, row_first, row_last, row_cut;
  logic [RowW-1:0] row_y, row_last_row;
  logic [NumberW-1:0] row_base, row_free;
  logic [ColW-1:0] row_last_col;
  logic [SideWidth-1:0] row_side;

  logic segment_valid, segment_ready, segment_first, segment_top;
  logic signed [1:0][1:0][ValueW-1:0] segment_value;
  logic signed [1:0][1:0][SlopeW-1:0] segment_slope;

  vista_rectify_rows #(
    .MaxWidth  (MaxWidth),
    .NumRows   (NumRows),
    .MaxPoints (MaxPoints),
    .SideWidth (SideWidth)
  ) u_rows (
    .clk_i,
    .rst_ni,
    .frame_valid_i   (frame_valid),
    .frame_ready_o   (frame_ready),
    .last_col_i      (frame_last_col),
    .last_row_i      (frame_last_row),
    .base_i          (frame_base),
    .on_i            (frame_on),
    .bank_i          (frame_bank),
    .side_i          (frame_side),
    .idle_o          (rows_idle),
    .frame_end_o     (frame_end),
    .number_i        (number),
    .needed_o        (needed),
    .cut_i           (row_needed_cut),
    .on_o            (points_on),
    .j_o             (points_j),
    .addr_o          (points_addr),
    .value_i         (values),
    .row_valid_o     (row_valid),
    .row_ready_i     (row_ready),
    .row_first_o     (row_first),
    .row_last_o      (row_last),
    .row_cut_o       (row_cut),
    .row_y_o         (row_y),
    .row_base_o      (row_base),
    .row_last_col_o  (row_last_col),
    .row_last_row_o  (row_last_row),
    .row_free_o      (row_free),
    .row_side_o      (row_side),
    .segment_valid_o (segment_valid),
    .segment_ready_i (segment_ready),
    .segment_first_o (segment_first),
    .segment_top_o   (segment_top),
    .segment_value_o (segment_value),
    .segment_slope_o (segment_slope)
  );

  // Pixel by pixel along a row. A bit that is upset may make the segments of a row too few or too many. So those that are
  // left over are dropped when the next row starts, and where one is missing that of a later row waits.
  logic go, loaded_q, lead_q, top_q, fresh_q, start_q, stale, early, step, advance, load, segment_end, row_end;
  logic [StepW-1:0] i_q;
  logic [ColW-1:0]  x_q;
  logic last_x_q;  // x_q is the last column

  assign stale         = start_q & (~lead_q | (row_first & ~top_q));
  assign early         = lead_q & fresh_q & (~start_q | (top_q & ~row_first));
  assign step          = loaded_q & row_valid & go & ~stale;
  assign advance       = step & ~early;
  assign row_end       = step & last_x_q;
  assign segment_end   = (advance & ((32'(i_q) == StepPx - 1) | row_end)) | (loaded_q & row_valid & stale);
  assign load          = segment_valid & (~loaded_q | segment_end);
  assign segment_ready = load;
  assign row_ready     = row_end;

  always_ff @(posedge clk_i) begin
    if (load | segment_end) loaded_q <= load;
    if (load) begin
      i_q     <= '0;
      lead_q  <= segment_first;
      top_q   <= segment_top;
      fresh_q <= 1'b1;
    end else if (advance) begin
      i_q     <= i_q + 1'b1;
      fresh_q <= 1'b0;
    end
    if (step) begin
      x_q      <= row_end ? '0 : x_q + 1'b1;
      last_x_q <= ~row_end & (x_q + 1'b1 >= row_last_col);
      start_q  <= row_end;
    end
    if (!rst_ni) begin
      loaded_q <= 1'b0;
      start_q  <= 1'b1;
      x_q      <= '0;
      last_x_q <= 1'b0;
    end
  end

  // Rows are free for writing when the last of their pixels were read; all are if no frame is there.
  always_ff @(posedge clk_i) begin
    if (row_end) free_delay_q[0] <= row_free;
    else if (rows_idle & ~frame_valid & ~row_valid) free_delay_q[0] <= number;
    for (int unsigned i = 1; i < ReadLatency; i++) free_delay_q[i] <= free_delay_q[i-1];
    if (!rst_ni) free_delay_q <= '0;
  end

  logic map_upset;
  logic [1:0] map_write;
  logic [PointW:0] map_write_addr;
  logic [2*OffsetW-1:0] map_write_data;

  vista_rectify_map #(
    .MaxWidth  (MaxWidth),
    .NumRows   (NumRows),
    .MaxPoints (MaxPoints),
    .Parity    (Parity)
  ) u_map (
    .clk_i,
    .rst_ni,
    .keep_i         (keep_map_i),
    .begin_i        (map_begin_i),
    .width_i        (map_width_i),
    .height_i       (map_height_i),
    .write_i        (map_write_i),
    .data_i         (map_data_i),
    .commit_i       (map_commit_i),
    .ready_o        (map_ready_o),
    .accepted_o     (map_accepted_o),
    .refused_rows_o (map_refused_rows_o),
    .refused_size_o (map_refused_size_o),
    .valid_o        (map_valid),
    .bank_o         (bank),
    .width_o        (map_width),
    .height_o       (map_height),
    .frame_begin_i  (offered),
    .frame_end_i    (frame_end),
    .frame_drop_i   (head_q & ~frame_start_o),
    .frame_bank_i   (bank_q),
    .write_o        (map_write),
    .write_addr_o   (map_write_addr),
    .write_data_o   (map_write_data),
    .upset_o        (map_upset)
  );

  logic [1:0][PixelW-1:0] pixels;

  logic [1:0] points_upset, sample_upset;
  logic writer_upset;
  assign upset_o = |{points_upset, sample_upset, writer_upset, map_upset};

  for (genvar i = 0; i < 2; i++) begin : gen_camera
    vista_rectify_points #(
      .MaxPoints (MaxPoints),
      .Parity    (Parity)
    ) u_points (
      .clk_i,
      .write_i      (map_write[i]),
      .write_addr_i (map_write_addr),
      .write_data_i (map_write_data),
      .on_i         (points_on),
      .j_i          (points_j),
      .addr_i       (points_addr),
      .value_o      (values[i]),
      .upset_o      (points_upset[i])
    );

    vista_rectify_sample #(
      .MaxWidth (MaxWidth),
      .NumRows  (NumRows),
      .Parity   (Parity)
    ) u_sample (
      .clk_i,
      .write_i      (store_valid),
      .write_row_i  (number[RingW-1:0]),
      .write_col_i  (store_col),
      .write_data_i (store_data[i*PixelW+:PixelW]),
      .load_i       (load),
      .value_i      (segment_value[i]),
      .slope_i      (segment_slope[i]),
      .step_i       (advance),
      .x_i          (x_q),
      .y_i          (row_y),
      .last_x_i     (row_last_col),
      .last_y_i     (row_last_row),
      .base_i       (row_base[RingW-1:0]),
      .pixel_o      (pixels[i]),
      .upset_o      (sample_upset[i])
    );
  end

  // What goes along with a pixel; what goes along with a frame is handed over halfway, since frames are longer than that.
  localparam int unsigned Halfway = SampleLatency / 2;

  logic [SampleLatency:1] valid_q, sof_q, eol_q, end_q, cut_q;
  logic [AllSideW-1:0] side_early_q, side_late_q;

  always_ff @(posedge clk_i) begin
    valid_q <= {valid_q[SampleLatency-1:1], step};
    sof_q   <= {sof_q[SampleLatency-1:1], row_first & (x_q == '0)};
    eol_q   <= {eol_q[SampleLatency-1:1], row_end};
    end_q   <= {end_q[SampleLatency-1:1], row_end & row_last};
    cut_q  <= {cut_q[SampleLatency-1:1], row_cut};
    if (step & row_first & (x_q == '0)) begin
      side_early_q <= {row_side, row_last_row + 1'b1, (ColW + 1)'(row_last_col) + 1'b1};
    end
    if (valid_q[Halfway] & sof_q[Halfway]) side_late_q <= side_early_q;
    if (!rst_ni) valid_q <= '0;
  end

  vista_pixel_writer #(
    .SideWidth (AllSideW),
    .InFlight  (SampleLatency + 3),
    .Parity    (Parity)
  ) u_writer (
    .clk_i,
    .rst_ni,
    .result_valid_i (valid_q[SampleLatency]),
    .result_sof_i   (sof_q[SampleLatency]),
    .result_eol_i   (eol_q[SampleLatency]),
    .result_end_i   (end_q[SampleLatency]),
    .result_cut_i   (cut_q[SampleLatency]),
    .result_data_i  (pixels),
    .result_side_i  (side_late_q),
    .go_o           (go),
    .valid_o        (m_axis_tvalid),
    .ready_i        (m_axis_tready),
    .sof_o          (m_axis_tuser),
    .eol_o          (m_axis_tlast),
    .data_o         (m_axis_tdata),
    .side_o         ({side_o, height_o, width_o}),
    .upset_o        (writer_upset)
  );

endmodule
