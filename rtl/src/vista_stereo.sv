// SPDX-License-Identifier: Apache-2.0
// The stereo engine with its buses: AXI4-Stream video in and out, AXI4-Lite registers (rtl/csr/registers.md).
//
//   s_axis  tdata {right[7:0], left[7:0]}, tuser start of frame, tlast end of line, one pixel pair a beat
//   m_axis  tdata {Smin[15:0], disparity[15:0]}, framed likewise; disparity signed, 1/16 px, -16 invalid;
//           Smin saturated, 0xFFFF for a pixel that is not matched; in the narrow format {disparity of the pixel to the
//           right, disparity}, with -16 for the one that a row of odd width lacks
//
// All of one clock; `rst_ni` is synchronous and, as AXI asks, to be held low for some clocks at power-up.

module vista_stereo #(
  parameter int unsigned NumDisparities = 32,  // 16, 32 .. 256
  parameter int unsigned BlockSize = 11,       // odd, 5 .. 21
  parameter int unsigned MaxWidth = 1024       // px, NumDisparities + BlockSize .. 65535
) (
  input  logic clk_i,
  input  logic rst_ni,

  input  logic        s_axis_tvalid,
  output logic        s_axis_tready,
  input  logic [15:0] s_axis_tdata,
  input  logic        s_axis_tuser,
  input  logic        s_axis_tlast,

  output logic        m_axis_tvalid,
  input  logic        m_axis_tready,
  output logic [31:0] m_axis_tdata,
  output logic        m_axis_tuser,
  output logic        m_axis_tlast,

  input  logic        s_axil_awvalid,
  output logic        s_axil_awready,
  input  logic [6:0]  s_axil_awaddr,
  input  logic [2:0]  s_axil_awprot,
  input  logic        s_axil_wvalid,
  output logic        s_axil_wready,
  input  logic [31:0] s_axil_wdata,
  input  logic [3:0]  s_axil_wstrb,
  output logic        s_axil_bvalid,
  input  logic        s_axil_bready,
  output logic [1:0]  s_axil_bresp,
  input  logic        s_axil_arvalid,
  output logic        s_axil_arready,
  input  logic [6:0]  s_axil_araddr,
  input  logic [2:0]  s_axil_arprot,
  output logic        s_axil_rvalid,
  input  logic        s_axil_rready,
  output logic [31:0] s_axil_rdata,
  output logic [1:0]  s_axil_rresp,

  output logic irq_o  // level; see INTERRUPT
);

  import vista_stereo_pkg::*;

  localparam int unsigned ColW = $clog2(MaxWidth);

  logic rst_nq, hard_rst_n, enable, busy;
  logic [ColW:0]      width;
  logic [HeightW-1:0] height;
  params_t            params;
  events_t            events;

  vista_registers #(
    .NumDisparities (NumDisparities),
    .BlockSize (BlockSize),
    .MaxWidth (MaxWidth)
  ) u_registers (
    .clk_i,
    .rst_ni,
    .s_axil_awvalid,
    .s_axil_awready,
    .s_axil_awaddr,
    .s_axil_awprot,
    .s_axil_wvalid,
    .s_axil_wready,
    .s_axil_wdata,
    .s_axil_wstrb,
    .s_axil_bvalid,
    .s_axil_bready,
    .s_axil_bresp,
    .s_axil_arvalid,
    .s_axil_arready,
    .s_axil_araddr,
    .s_axil_arprot,
    .s_axil_rvalid,
    .s_axil_rready,
    .s_axil_rdata,
    .s_axil_rresp,
    .irq_o,
    .rst_no       (rst_nq),
    .hard_rst_no  (hard_rst_n),
    .enable_o     (enable),
    .width_o      (width),
    .height_o     (height),
    .front_end_o  (),
    .params_o     (params),
    .map_o        (),
    .map_width_o  (),
    .map_height_o (),
    .map_ready_i  (1'b0),
    .busy_i       (busy),
    .events_i     (events),
    .stall_in_i   (s_axis_tvalid & ~s_axis_tready),
    .word_i       (m_axis_tvalid),
    .word_ready_i (m_axis_tready)
  );

  assign events.level_follows = 1'b0;
  assign events.no_map        = 1'b0;
  assign events.map_rows      = 1'b0;
  assign events.map_size      = 1'b0;

  vista_stereo_core #(
    .NumDisparities (NumDisparities),
    .BlockSize (BlockSize),
    .MaxWidth (MaxWidth)
  ) u_core (
    .clk_i,
    .rst_ni            (rst_nq),
    .bus_rst_ni        (hard_rst_n),
    .enable_i          (enable),
    .width_i           (width),
    .height_i          (height),
    .params_i          (params),
    .pixel_valid_i     (s_axis_tvalid),
    .pixel_ready_o     (s_axis_tready),
    .pixel_sof_i       (s_axis_tuser),
    .pixel_eol_i       (s_axis_tlast),
    .pixel_i           (s_axis_tdata),
    .word_valid_o      (m_axis_tvalid),
    .word_ready_i      (m_axis_tready),
    .word_sof_o        (m_axis_tuser),
    .word_eol_o        (m_axis_tlast),
    .word_o            (m_axis_tdata),
    .busy_o            (busy),
    .frame_start_o     (events.frame_start),
    .frame_end_o       (events.frame_end),
    .error_early_eol_o (events.early_eol),
    .error_late_eol_o  (events.late_eol),
    .error_early_sof_o (events.early_sof),
    .error_late_sof_o  (events.late_sof),
    .error_size_o      (events.size)
  );

`ifdef VISTA_ASSERT
  `include "vista_bus_properties.svh"
`endif

endmodule
