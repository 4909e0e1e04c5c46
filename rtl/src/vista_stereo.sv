// SPDX-License-Identifier: Apache-2.0
// The stereo engine with its buses: AXI4-Stream video in and out, AXI4-Lite registers (rtl/csr/registers.md).
//
//   s_axis  tdata {right[7:0], left[7:0]}, tuser start of frame, tlast end of line, one pixel pair a beat
//   m_axis  tdata {Smin[15:0], disparity[15:0]}, framed likewise; disparity signed, 1/16 px, -16 invalid;
//           Smin saturated, 0xFFFF for a pixel that is not matched; in the narrow format {disparity of the pixel to the
//           right, disparity}, with -16 for the one that a row of odd width lacks; in that of the confidence, if it is
//           built, {distance[7:0], margin[3:0], length of the texture[3:0], disparity[15:0]}
//
// With FrontEnd raw pairs come in, and each level of a frame leaves as a frame of its own, level 0 first; without it
// nothing is built of the rectification, the pyramid and the smoothing, and the streams of their buffer rest.
//
// All of one clock; `rst_ni` is synchronous and, as AXI asks, to be held low for some clocks at power-up.

module vista_stereo #(
  parameter int unsigned NumDisparities = 32,  // 16, 32 .. 256
  parameter int unsigned BlockSize = 11,       // odd, 5 .. 21
  parameter int unsigned MaxWidth = 1024,      // px, NumDisparities + BlockSize .. 65535, with FrontEnd .. 4096
  parameter bit          FrontEnd = 1'b0,
  parameter int unsigned NumRows = 64,         // of the line buffer of rectification: 16, 32, 64 or 128
  parameter int unsigned MaxPoints = 2048,     // control points of a camera; rounded up to a power of two
  parameter bit          Parity = 1'b0,        // of memories and of the set in force; see ERRORS.upset
  parameter bit          Confidence = 1'b0     // can be had in place of Smin; see OUTPUT.confidence
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

  // The buffer of the pyramid, with FrontEnd: level 1 of the largest frame, first in first out (vista_pyramid).
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

  logic rst_nq, hard_rst_n, enable, map_ready, busy, lost, stuck;
  logic [ColW:0] width, map_width;
  logic [HeightW-1:0] height, map_height;
  front_end_t         front_end;
  params_t            params;
  map_load_t          map_load;
  events_t            events;

  vista_registers #(
    .NumDisparities (NumDisparities),
    .BlockSize (BlockSize),
    .MaxWidth  (MaxWidth),
    .NumRows   (FrontEnd ? NumRows : 0),
    .MaxPoints (FrontEnd ? 2 ** $clog2(MaxPoints) : 0),
    .Parity    (Parity),
    .Confidence(Confidence)
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
    .lost_i       (lost | stuck),
    .events_i     (events),
    .stall_in_i   (s_axis_tvalid & ~s_axis_tready),
    .word_i       (m_axis_tvalid),
    .word_ready_i (m_axis_tready)
  );

  assign store_rst_no = rst_nq;

  // A pixel waits, nothing moves, and neither the reader nor the buffer of the levels has anything to take: a bit was upset
  // somewhere, and one part waits for what another will never send. The rows of the largest frame that may be filled or
  // waited for without a word are fewer than the clocks that this takes.
  localparam int unsigned StuckRows = BlockSize + 8 + (FrontEnd ? NumRows : 0);
  localparam int unsigned StuckW = $clog2(StuckRows * MaxWidth) + 1;

  logic [StuckW-1:0] still_q;
  logic still;

  assign still = s_axis_tvalid & ~s_axis_tready & ~m_axis_tvalid & ~store_axis_tvalid &
      ~(fetch_axis_tvalid & fetch_axis_tready);
  assign stuck = still_q[StuckW-1];

  always_ff @(posedge clk_i) begin
    still_q <= still ? still_q + 1'b1 : '0;
    if (!rst_nq) still_q <= '0;
  end

  // What comes to the core, and what it tells.
  logic pixel_valid, pixel_ready, pixel_sof, pixel_eol, pixel_enable, core_busy;
  logic [2*PixelW-1:0] pixel;
  logic [ColW:0]       pixel_width;
  logic [HeightW-1:0]  pixel_height;
  params_t             pixel_params;
  events_t             core_events;

  if (FrontEnd) begin : gen_front_end
    localparam int unsigned SideW = $bits(params_t) - (Confidence ? 0 : 1);

    events_t front_events;
    logic    map_accepted;
    logic [SideW-1:0] pixel_side;

    assign pixel_params = params_t'($bits(params_t)'(pixel_side));

    vista_front_end #(
      .MaxWidth  (MaxWidth),
      .NumRows   (NumRows),
      .MaxPoints (MaxPoints),
      .SideWidth (SideW),
      .Parity    (Parity)
    ) u_front_end (
      .clk_i,
      .rst_ni            (rst_nq),
      .keep_map_i        (hard_rst_n),
      .enable_i          (enable),
      .width_i           (width),
      .height_i          (height),
      .front_end_i       (front_end),
      .side_i            (SideW'(params)),
      .map_i             (map_load),
      .map_width_i       (map_width),
      .map_height_i      (map_height),
      .map_ready_o       (map_ready),
      .map_accepted_o    (map_accepted),
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
      .side_o            (pixel_side),
      .busy_o            (busy),
      .lost_o            (lost),
      .events_o          (front_events)
    );

    // Errors are told of by the front end, which meets them first; a map that is refused is, one that is not needs no telling.
    logic unused_events;
    assign unused_events = ^{core_busy, core_events, map_accepted, params.confidence};

    always_comb begin
      events           = front_events;
      events.frame_end = core_events.frame_end;
      events.upset     = front_events.upset | core_events.upset;
    end

    assign pixel_enable = 1'b1;
  end else begin : gen_no_front_end
    logic unused_front_end;
    assign unused_front_end = ^{store_axis_tready, fetch_axis_tvalid, fetch_axis_tdata, fetch_axis_tuser,
                                fetch_axis_tlast, front_end, map_load, map_width, map_height};

    assign s_axis_tready     = pixel_ready;
    assign pixel_valid       = s_axis_tvalid;
    assign pixel_sof         = s_axis_tuser;
    assign pixel_eol         = s_axis_tlast;
    assign pixel             = s_axis_tdata;
    assign pixel_enable      = enable;
    assign pixel_width       = width;
    assign pixel_height      = height;
    assign pixel_params      = params;
    assign busy              = core_busy;
    assign lost              = 1'b0;
    assign map_ready         = 1'b0;
    assign events            = core_events;
    assign store_axis_tvalid = 1'b0;
    assign store_axis_tdata  = '0;
    assign store_axis_tuser  = 1'b0;
    assign store_axis_tlast  = 1'b0;
    assign fetch_axis_tready = 1'b0;
  end

  vista_stereo_core #(
    .NumDisparities (NumDisparities),
    .BlockSize (BlockSize),
    .MaxWidth (MaxWidth),
    .Parity   (Parity),
    .Confidence (Confidence)
  ) u_core (
    .clk_i,
    .rst_ni            (rst_nq),
    .bus_rst_ni        (hard_rst_n),
    .enable_i          (pixel_enable),
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
    .busy_o            (core_busy),
    .frame_start_o     (core_events.frame_start),
    .frame_end_o       (core_events.frame_end),
    .error_early_eol_o (core_events.early_eol),
    .error_late_eol_o  (core_events.late_eol),
    .error_early_sof_o (core_events.early_sof),
    .error_late_sof_o  (core_events.late_sof),
    .error_size_o      (core_events.size),
    .upset_o           (core_events.upset)
  );

  // Only a front end has them.
  assign core_events.level_follows = 1'b0;
  assign core_events.no_map        = 1'b0;
  assign core_events.map_rows      = 1'b0;
  assign core_events.map_size      = 1'b0;

`ifdef VISTA_ASSERT
  `include "vista_bus_properties.svh"
`endif

endmodule
