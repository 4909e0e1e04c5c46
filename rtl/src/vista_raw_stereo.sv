// SPDX-License-Identifier: Apache-2.0
// Disparities from raw pairs: the front end and the core, with their buses. Streams and registers are those of
// vista_stereo (doc/rtl.md); each level of a frame leaves as a frame of its own, level 0 first.
//
// All of one clock; `rst_ni` is synchronous and, as AXI asks, to be held low for some clocks at power-up.

module vista_raw_stereo #(
  parameter int unsigned NumDisparities = 32,  // 16, 32 .. 256
  parameter int unsigned BlockSize = 11,       // odd, 5 .. 21
  parameter int unsigned MaxWidth = 1024,      // px, NumDisparities + BlockSize .. 4096
  parameter int unsigned NumRows = 64,         // of the line buffer of rectification: 16, 32, 64 or 128
  parameter int unsigned MaxPoints = 2048      // control points of a camera; rounded up to a power of two
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

  // The buffer of the pyramid: level 1 of the largest frame, first in first out (vista_pyramid).
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
  output logic        store_rst_no,  // 0: the buffer is to be emptied

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

  logic rst_nq, hard_rst_n, enable, map_ready, busy;
  logic [ColW:0] width, map_width, pixel_width;
  logic [HeightW-1:0] height, map_height, pixel_height;
  front_end_t front_end;
  params_t params, pixel_params;
  map_load_t map_load;
  events_t events, front_events;

  vista_registers #(
    .NumDisparities (NumDisparities),
    .BlockSize (BlockSize),
    .MaxWidth  (MaxWidth),
    .NumRows   (NumRows),
    .MaxPoints (2 ** $clog2(MaxPoints))
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
    .front_end_o  (front_end),
    .params_o     (params),
    .map_o        (map_load),
    .map_width_o  (map_width),
    .map_height_o (map_height),
    .map_ready_i  (map_ready),
    .busy_i       (busy),
    .events_i     (events),
    .stall_in_i   (s_axis_tvalid & ~s_axis_tready),
    .word_i       (m_axis_tvalid),
    .word_ready_i (m_axis_tready)
  );

  assign store_rst_no = rst_nq;

  logic pixel_valid, pixel_ready, pixel_sof, pixel_eol, frame_end;
  logic [2*PixelW-1:0] pixel;

  vista_front_end #(
    .MaxWidth  (MaxWidth),
    .NumRows   (NumRows),
    .MaxPoints (MaxPoints),
    .SideWidth ($bits(params_t))
  ) u_front_end (
    .clk_i,
    .rst_ni            (rst_nq),
    .keep_map_i        (hard_rst_n),
    .enable_i          (enable),
    .width_i           (width),
    .height_i          (height),
    .front_end_i       (front_end),
    .side_i            (params),
    .map_i             (map_load),
    .map_width_i       (map_width),
    .map_height_i      (map_height),
    .map_ready_o       (map_ready),
    .map_accepted_o    (),
    .s_axis_tvalid,
    .s_axis_tready,
    .s_axis_tdata,
    .s_axis_tuser,
    .s_axis_tlast,
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
    .m_axis_tvalid     (pixel_valid),
    .m_axis_tready     (pixel_ready),
    .m_axis_tdata      (pixel),
    .m_axis_tuser      (pixel_sof),
    .m_axis_tlast      (pixel_eol),
    .width_o           (pixel_width),
    .height_o          (pixel_height),
    .side_o            (pixel_params),
    .busy_o            (busy),
    .events_o          (front_events)
  );

  always_comb begin
    events           = front_events;
    events.frame_end = frame_end;
  end

  // Errors are told of by the front end, which meets them first.
  vista_stereo_core #(
    .NumDisparities (NumDisparities),
    .BlockSize (BlockSize),
    .MaxWidth (MaxWidth)
  ) u_core (
    .clk_i,
    .rst_ni            (rst_nq),
    .bus_rst_ni        (hard_rst_n),
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
    .busy_o            (),
    .frame_start_o     (),
    .frame_end_o       (frame_end),
    .error_early_eol_o (),
    .error_late_eol_o  (),
    .error_early_sof_o (),
    .error_late_sof_o  (),
    .error_size_o      ()
  );

`ifdef VISTA_ASSERT
  `include "vista_bus_properties.svh"
`endif

endmodule
