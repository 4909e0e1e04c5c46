// SPDX-License-Identifier: Apache-2.0
// The front end as one unit: rectification, pyramid and smoothing, one behind the other, in front of the core.
//
//   s_axis ──> vista_rectify ──> vista_pyramid ──> vista_smooth ──> m_axis
//                                  │       ^
//                                store   fetch   level 1 of the largest frame
//
//   all streams  tdata {right[7:0], left[7:0]}, tuser start of frame, tlast end of line, one pixel pair a beat
//
// What belongs to a frame goes along with it through all blocks, so that every frame has its own switches, and each of
// its levels its own size. Each step is switched off by itself; pixels then pass it unchanged. Errors are those that the
// rectification meets: behind it a broken frame is one that the following blocks cut at the same place.

module vista_front_end #(
  parameter int unsigned MaxWidth = 1024,   // 4 .. 4096
  parameter int unsigned NumRows = 64,      // of the line buffer of rectification: 16, 32, 64 or 128
  parameter int unsigned MaxPoints = 2048,  // control points of a camera; rounded up to a power of two
  parameter int unsigned SideWidth = 1,
  parameter bit Parity = 1'b0,
  localparam int unsigned ColW = $clog2(MaxWidth),
  localparam int unsigned RowW = vista_stereo_pkg::HeightW
) (
  input  logic clk_i,
  input  logic rst_ni,
  input  logic keep_map_i,  // 1: a reset leaves the map in force as it is

  // A frame has what is set in the clock in which its first pixel is first offered.
  input  logic                         enable_i,
  input  logic [ColW:0]                width_i,
  input  logic [RowW-1:0]              height_i,
  input  vista_stereo_pkg::front_end_t front_end_i,
  input  logic [SideWidth-1:0]         side_i,  // whatever else belongs to the frame, passed on with each level

  // A map, which takes effect from the next frame on; see vista_rectify_map.
  input  vista_stereo_pkg::map_load_t map_i,
  input  logic [ColW:0]               map_width_i,   // with `begin_load`
  input  logic [RowW-1:0]             map_height_i,
  output logic                        map_ready_o,
  output logic                        map_accepted_o,

  input  logic        s_axis_tvalid,
  output logic        s_axis_tready,
  input  logic [15:0] s_axis_tdata,
  input  logic        s_axis_tuser,
  input  logic        s_axis_tlast,

  // The buffer of the pyramid, to be reset together with this module.
  output logic        store_axis_tvalid,
  input  logic        store_axis_tready,
  output logic [15:0] store_axis_tdata,
  output logic        store_axis_tuser,
  output logic        store_axis_tlast,

  input  logic        fetch_axis_tvalid,
  output logic        fetch_axis_tready,
  input  logic [15:0] fetch_axis_tdata,
  input  logic        fetch_axis_tuser,
  input  logic        fetch_axis_tlast,

  output logic        m_axis_tvalid,
  input  logic        m_axis_tready,
  output logic [15:0] m_axis_tdata,
  output logic        m_axis_tuser,
  output logic        m_axis_tlast,

  // Properties of the level that is leaving; they change when its first pixel is offered.
  output logic [ColW:0]        width_o,
  output logic [RowW-1:0]      height_o,
  output logic [SideWidth-1:0] side_o,

  output logic busy_o,  // a pixel of a frame that is to be taken waits
  output logic lost_o,  // one clock: levels and frames do not fit any more, all has to be reset
  output vista_stereo_pkg::events_t events_o  // without `frame_end`
);

  import vista_stereo_pkg::*;

  localparam int unsigned DataW = 2 * PixelW;

  logic straight_valid, straight_ready, straight_sof, straight_eol, level_valid, level_ready, level_sof, level_eol;
  logic [DataW-1:0] straight_data, level_data;
  logic [ColW:0] straight_width, level_width;
  logic [RowW-1:0] straight_height, level_height;
  logic [2:0] straight_levels;
  logic straight_smooth, level_smooth;
  logic [SideWidth-1:0] straight_side, level_side;

  logic [2:0] upset;
  assign events_o.upset     = |upset;
  assign events_o.frame_end = 1'b0;

  vista_rectify #(
    .MaxWidth  (MaxWidth),
    .NumRows   (NumRows),
    .MaxPoints (MaxPoints),
    .SideWidth (4 + SideWidth),
    .Parity    (Parity)
  ) u_rectify (
    .clk_i,
    .rst_ni,
    .keep_map_i,
    .enable_i,
    .width_i,
    .height_i,
    .rectify_i          (front_end_i.rectify),
    .side_i             ({front_end_i.levels, front_end_i.smooth, side_i}),
    .s_axis_tvalid,
    .s_axis_tready,
    .s_axis_tdata,
    .s_axis_tuser,
    .s_axis_tlast,
    .m_axis_tvalid      (straight_valid),
    .m_axis_tready      (straight_ready),
    .m_axis_tdata       (straight_data),
    .m_axis_tuser       (straight_sof),
    .m_axis_tlast       (straight_eol),
    .width_o            (straight_width),
    .height_o           (straight_height),
    .side_o             ({straight_levels, straight_smooth, straight_side}),
    .map_begin_i        (map_i.begin_load),
    .map_width_i,
    .map_height_i,
    .map_write_i        (map_i.write),
    .map_data_i         (map_i.point),
    .map_commit_i       (map_i.commit),
    .map_ready_o,
    .map_accepted_o,
    .map_refused_rows_o (events_o.map_rows),
    .map_refused_size_o (events_o.map_size),
    .frame_start_o      (events_o.frame_start),
    .busy_o,
    .error_map_o        (events_o.no_map),
    .error_early_eol_o  (events_o.early_eol),
    .error_late_eol_o   (events_o.late_eol),
    .error_early_sof_o  (events_o.early_sof),
    .error_late_sof_o   (events_o.late_sof),
    .error_size_o       (events_o.size),
    .upset_o            (upset[0])
  );

  vista_pyramid #(
    .MaxWidth  (MaxWidth),
    .SideWidth (1 + SideWidth),
    .Parity    (Parity)
  ) u_pyramid (
    .clk_i,
    .rst_ni,
    .enable_i          (1'b1),
    .width_i           (straight_width),
    .height_i          (straight_height),
    .levels_i          (straight_levels),
    .side_i            ({straight_smooth, straight_side}),
    .s_axis_tvalid     (straight_valid),
    .s_axis_tready     (straight_ready),
    .s_axis_tdata      (straight_data),
    .s_axis_tuser      (straight_sof),
    .s_axis_tlast      (straight_eol),
    .store_axis_tvalid,
    .store_axis_tready,
    .store_axis_tdata,
    .store_axis_tuser,
    .store_axis_tlast,
    .fetch_axis_tvalid,
    .fetch_axis_tready,
    .fetch_axis_tdata,
    .fetch_axis_tuser,
    .fetch_axis_tlast,
    .m_axis_tvalid     (level_valid),
    .m_axis_tready     (level_ready),
    .m_axis_tdata      (level_data),
    .m_axis_tuser      (level_sof),
    .m_axis_tlast      (level_eol),
    .lost_o,
    .level_follows_o   (events_o.level_follows),
    .level_o           (),
    .width_o           (level_width),
    .height_o          (level_height),
    .side_o            ({level_smooth, level_side}),
    .frame_start_o     (),
    .error_early_eol_o (),
    .error_late_eol_o  (),
    .error_early_sof_o (),
    .error_late_sof_o  (),
    .error_size_o      (),
    .upset_o           (upset[1])
  );

  vista_smooth #(
    .MaxWidth  (MaxWidth),
    .SideWidth (SideWidth),
    .Parity    (Parity)
  ) u_smooth (
    .clk_i,
    .rst_ni,
    .enable_i          (1'b1),
    .width_i           (level_width),
    .height_i          (level_height),
    .smooth_i          (level_smooth),
    .side_i            (level_side),
    .s_axis_tvalid     (level_valid),
    .s_axis_tready     (level_ready),
    .s_axis_tdata      (level_data),
    .s_axis_tuser      (level_sof),
    .s_axis_tlast      (level_eol),
    .m_axis_tvalid,
    .m_axis_tready,
    .m_axis_tdata,
    .m_axis_tuser,
    .m_axis_tlast,
    .width_o,
    .height_o,
    .side_o,
    .frame_start_o     (),
    .error_early_eol_o (),
    .error_late_eol_o  (),
    .error_early_sof_o (),
    .error_late_sof_o  (),
    .error_size_o      (),
    .upset_o           (upset[2])
  );

endmodule
