// SPDX-License-Identifier: Apache-2.0
// The whole way of a frame, for the bench: pyramid, smoothing and the core one behind the other. What belongs to a frame
// goes along with it, so that each level is matched with its own size and the parameters of its frame.

module front_end #(
  parameter int unsigned NumDisparities = 16,
  parameter int unsigned BlockSize = 5,
  parameter int unsigned MaxWidth = 64,
  localparam int unsigned ColW = $clog2(MaxWidth),
  localparam int unsigned RowW = vista_stereo_pkg::HeightW,
  localparam int unsigned ParamsW = $bits(vista_stereo_pkg::params_t)
) (
  input  logic clk_i,
  input  logic rst_ni,

  input  logic               enable_i,
  input  logic [ColW:0]      width_i,
  input  logic [RowW-1:0]    height_i,
  input  logic [2:0]         levels_i,
  input  logic [ParamsW:0]   side_i,  // {smooth, parameters}

  input  logic        s_axis_tvalid,
  output logic        s_axis_tready,
  input  logic [15:0] s_axis_tdata,
  input  logic        s_axis_tuser,
  input  logic        s_axis_tlast,

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
  output logic [31:0] m_axis_tdata,
  output logic        m_axis_tuser,
  output logic        m_axis_tlast,

  output logic frame_start_o,
  output logic error_early_eol_o,
  output logic error_late_eol_o,
  output logic error_early_sof_o,
  output logic error_late_sof_o,
  output logic error_size_o
);

  logic level_valid, level_ready, level_sof, level_eol, smooth, pixel_valid, pixel_ready, pixel_sof, pixel_eol;
  logic [15:0] level_data, pixel;
  logic [ColW:0] level_width, pixel_width;
  logic [RowW-1:0] level_height, pixel_height;
  logic [ParamsW-1:0] level_params, pixel_params;

  vista_pyramid #(
    .MaxWidth  (MaxWidth),
    .SideWidth (ParamsW + 1)
  ) u_pyramid (
    .m_axis_tvalid (level_valid),
    .m_axis_tready (level_ready),
    .m_axis_tdata  (level_data),
    .m_axis_tuser  (level_sof),
    .m_axis_tlast  (level_eol),
    .level_o       (),
    .width_o       (level_width),
    .height_o      (level_height),
    .side_o        ({smooth, level_params}),
    .*
  );

  vista_smooth #(
    .MaxWidth  (MaxWidth),
    .SideWidth (ParamsW)
  ) u_smooth (
    .clk_i,
    .rst_ni,
    .enable_i          (1'b1),
    .width_i           (level_width),
    .height_i          (level_height),
    .smooth_i          (smooth),
    .side_i            (level_params),
    .s_axis_tvalid     (level_valid),
    .s_axis_tready     (level_ready),
    .s_axis_tdata      (level_data),
    .s_axis_tuser      (level_sof),
    .s_axis_tlast      (level_eol),
    .m_axis_tvalid     (pixel_valid),
    .m_axis_tready     (pixel_ready),
    .m_axis_tdata      (pixel),
    .m_axis_tuser      (pixel_sof),
    .m_axis_tlast      (pixel_eol),
    .width_o           (pixel_width),
    .height_o          (pixel_height),
    .side_o            (pixel_params),
    .frame_start_o     (),
    .error_early_eol_o (),
    .error_late_eol_o  (),
    .error_early_sof_o (),
    .error_late_sof_o  (),
    .error_size_o      ()
  );

  vista_stereo_core #(
    .NumDisparities (NumDisparities),
    .BlockSize (BlockSize),
    .MaxWidth (MaxWidth)
  ) u_core (
    .clk_i,
    .rst_ni,
    .enable_i          (1'b1),
    .width_i           (pixel_width),
    .height_i          (pixel_height),
    .params_i          (pixel_params),
    .pixel_valid_i     (pixel_valid),
    .pixel_ready_o     (pixel_ready),
    .pixel_sof_i       (pixel_sof),
    .pixel_eol_i       (pixel_eol),
    .pixel_i           (pixel),
    .word_valid_o      (m_axis_tvalid),
    .word_ready_i      (m_axis_tready),
    .word_sof_o        (m_axis_tuser),
    .word_eol_o        (m_axis_tlast),
    .word_o            (m_axis_tdata),
    .frame_start_o     (),
    .frame_end_o       (),
    .error_early_eol_o (),
    .error_late_eol_o  (),
    .error_early_sof_o (),
    .error_late_sof_o  (),
    .error_size_o      ()
  );

endmodule
