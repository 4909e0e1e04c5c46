// SPDX-License-Identifier: Apache-2.0
// Gives the levels of each frame one after the other, part B of the contract, so that one engine matches them all.
//
//   s_axis ──> guard ──> levels ──────────────────> m_axis   level 0, 1 .. of a frame, each a frame of its own size
//                          ^  └──> reduce ──┐
//                          │                v
//                     fetch_axis        store_axis           level k+1, while level k passes
//                          ^                │
//                          └─ memory <──────┘
//
// The memory is outside and no more than a first-in first-out buffer of video beats (data, tuser, tlast). It has to hold
// level 1 of the largest frame, (W+1)/2 * (H+1)/2 beats: block memory for small images, otherwise any buffer that a
// controller lays into external memory. With `levels_i` 1 it is not used.
//
//   all streams  tdata {right[7:0], left[7:0]}, tuser start of frame, tlast end of line, one pixel pair a beat
//
// Levels below 4x2 pixels, the smallest frame of the engine, are not sent: nothing can be matched in them.
// Framing errors: a frame breaks off as vista_frame_guard has it, and so does each of its levels.
// Reset it together with the memory.

module vista_pyramid #(
  parameter int unsigned MaxWidth = 1024,
  parameter int unsigned SideWidth = 1,
  parameter bit Parity = 1'b0,
  localparam int unsigned ColW = $clog2(MaxWidth),
  localparam int unsigned RowW = vista_stereo_pkg::HeightW,
  localparam int unsigned DataW = 2 * vista_stereo_pkg::PixelW
) (
  input  logic clk_i,
  input  logic rst_ni,

  // A frame has what is set in the clock in which its first pixel is first offered.
  input  logic                 enable_i,
  input  logic [ColW:0]        width_i,   // 4 .. MaxWidth
  input  logic [RowW-1:0]      height_i,  // 2 ..
  input  logic [2:0]           levels_i,  // 1 .. 4
  input  logic [SideWidth-1:0] side_i,    // whatever else belongs to the frame, passed on with each level

  input  logic             s_axis_tvalid,
  output logic             s_axis_tready,
  input  logic [DataW-1:0] s_axis_tdata,
  input  logic             s_axis_tuser,
  input  logic             s_axis_tlast,

  output logic             store_axis_tvalid,
  input  logic             store_axis_tready,
  output logic [DataW-1:0] store_axis_tdata,
  output logic             store_axis_tuser,
  output logic             store_axis_tlast,

  input  logic             fetch_axis_tvalid,
  output logic             fetch_axis_tready,
  input  logic [DataW-1:0] fetch_axis_tdata,
  input  logic             fetch_axis_tuser,
  input  logic             fetch_axis_tlast,

  output logic             m_axis_tvalid,
  input  logic             m_axis_tready,
  output logic [DataW-1:0] m_axis_tdata,
  output logic             m_axis_tuser,
  output logic             m_axis_tlast,

  // Properties of the level that is leaving; they change when its first pixel is offered.
  output logic [1:0]           level_o,
  output logic [ColW:0]        width_o,
  output logic [RowW-1:0]      height_o,
  output logic [SideWidth-1:0] side_o,

  // Events, one clock each.
  output logic lost_o,           // a level does not start where it should: all has to be reset
  output logic level_follows_o,  // a level begins that a smaller one follows
  output logic frame_start_o,
  output logic error_early_eol_o,
  output logic error_late_eol_o,
  output logic error_early_sof_o,
  output logic error_late_sof_o,
  output logic error_size_o,
  output logic upset_o  // of a memory
);

  if (SideWidth < 1) begin : gen_bad_side
    $fatal(1, "SideWidth must be 1 or more");
  end

  logic source_valid, source_ready, source_sof, source_eol, fetch_valid, fetch_ready, fetch_sof, fetch_eol;
  logic reduce_valid, reduce_ready, reduce_sof, reduce_eol;
  logic [DataW-1:0] source_data, fetch_data, reduce_data;
  logic [ColW-1:0] source_last_col;
  logic [ColW:0] reduce_width;
  logic [RowW-1:0] source_last_row, reduce_height;
  logic [2:0] sent, source_sent;  // bit k: level k + 1 is sent
  logic [SideWidth-1:0] source_side;

  // Level k has W / 2^k columns, rounded up: N or more if W > (N - 1) 2^k. So do its rows.
  for (genvar k = 1; k < 4; k++) begin : gen_sent
    assign sent[k-1] = (levels_i > 3'(k)) & (32'(width_i) > (vista_stereo_pkg::MinWidth - 1) << k) &
        (32'(height_i) > (vista_stereo_pkg::MinHeight - 1) << k);
  end

  vista_frame_guard #(
    .MaxWidth  (MaxWidth),
    .SideWidth (3 + SideWidth)
  ) u_guard (
    .clk_i,
    .rst_ni,
    .enable_i,
    .width_i,
    .height_i,
    .side_i   ({sent, side_i}),
    .valid_i  (s_axis_tvalid),
    .ready_o  (s_axis_tready),
    .sof_i    (s_axis_tuser),
    .eol_i    (s_axis_tlast),
    .data_i   (s_axis_tdata),
    .valid_o  (source_valid),
    .ready_i  (source_ready),
    .sof_o    (source_sof),
    .eol_o    (source_eol),
    .data_o   (source_data),
    .last_col_o (source_last_col),
    .last_row_o (source_last_row),
    .side_o   ({source_sent, source_side}),
    .frame_start_o,
    .error_early_eol_o,
    .error_late_eol_o,
    .error_early_sof_o,
    .error_late_sof_o,
    .error_size_o
  );

  vista_skid #(
    .Width(DataW + 2)
  ) u_fetch_skid (
    .clk_i,
    .rst_ni,
    .valid_i (fetch_axis_tvalid),
    .ready_o (fetch_axis_tready),
    .data_i  ({fetch_axis_tuser, fetch_axis_tlast, fetch_axis_tdata}),
    .valid_o (fetch_valid),
    .ready_i (fetch_ready),
    .data_o  ({fetch_sof, fetch_eol, fetch_data})
  );

  vista_levels #(
    .MaxWidth  (MaxWidth),
    .SideWidth (SideWidth)
  ) u_levels (
    .clk_i,
    .rst_ni,
    .last_col_i      (source_last_col),
    .last_row_i      (source_last_row),
    .sent_i          (source_sent),
    .side_i          (source_side),
    .source_valid_i  (source_valid),
    .source_ready_o  (source_ready),
    .source_sof_i    (source_sof),
    .source_eol_i    (source_eol),
    .source_data_i   (source_data),
    .fetch_valid_i   (fetch_valid),
    .fetch_ready_o   (fetch_ready),
    .fetch_sof_i     (fetch_sof),
    .fetch_eol_i     (fetch_eol),
    .fetch_data_i    (fetch_data),
    .reduce_valid_o  (reduce_valid),
    .reduce_ready_i  (reduce_ready),
    .reduce_sof_o    (reduce_sof),
    .reduce_eol_o    (reduce_eol),
    .reduce_data_o   (reduce_data),
    .reduce_width_o  (reduce_width),
    .reduce_height_o (reduce_height),
    .valid_o         (m_axis_tvalid),
    .ready_i         (m_axis_tready),
    .sof_o           (m_axis_tuser),
    .eol_o           (m_axis_tlast),
    .data_o          (m_axis_tdata),
    .lost_o,
    .follows_o       (level_follows_o),
    .level_o,
    .width_o,
    .height_o,
    .side_o
  );

  // Errors of its input are those of the guard: it meets them in every level.
  vista_reduce #(
    .MaxWidth (MaxWidth),
    .Parity   (Parity)
  ) u_reduce (
    .clk_i,
    .rst_ni,
    .enable_i          (1'b1),
    .width_i           (reduce_width),
    .height_i          (reduce_height),
    .s_axis_tvalid     (reduce_valid),
    .s_axis_tready     (reduce_ready),
    .s_axis_tdata      (reduce_data),
    .s_axis_tuser      (reduce_sof),
    .s_axis_tlast      (reduce_eol),
    .m_axis_tvalid     (store_axis_tvalid),
    .m_axis_tready     (store_axis_tready),
    .m_axis_tdata      (store_axis_tdata),
    .m_axis_tuser      (store_axis_tuser),
    .m_axis_tlast      (store_axis_tlast),
    .frame_start_o     (),
    .error_early_eol_o (),
    .error_late_eol_o  (),
    .error_early_sof_o (),
    .error_late_sof_o  (),
    .error_size_o      (),
    .upset_o           (upset_o)
  );

endmodule
