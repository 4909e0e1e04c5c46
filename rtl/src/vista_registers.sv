// SPDX-License-Identifier: Apache-2.0
// The registers behind AXI4-Lite (rtl/csr/registers.md), and what they make of them: the set of parameters in force, the
// resets of what is behind them, maps on their way in, counters, errors and the interrupt.
//
// A write has taken effect when its response comes, 3 clocks after its request. A soft reset is over by then. A frame
// whose first pixel is offered in the clock of the response is already subject to what was written: the enable bit, and
// the set of parameters that was committed.

module vista_registers #(
  parameter int unsigned NumDisparities = 32,
  parameter int unsigned BlockSize = 11,
  parameter int unsigned MaxWidth = 1024,
  parameter int unsigned NumRows = 0,  // of the rectification; 0: there is no front end
  parameter int unsigned MaxPoints = 0,
  parameter bit Parity = 1'b0,
  parameter bit Confidence = 1'b0,
  localparam int unsigned ColW = $clog2(MaxWidth),
  localparam int unsigned RowW = vista_stereo_pkg::HeightW
) (
  input  logic clk_i,
  input  logic rst_ni,

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

  output logic irq_o,  // level; see INTERRUPT

  // The reset of everything behind the registers, soft or not; and that of what a soft one leaves, words that are offered
  // and the map in force.
  output logic rst_no,
  output logic hard_rst_no,

  // The set in force, which changes in one clock, with the map.
  output logic                         enable_o,
  output logic [ColW:0]                width_o,
  output logic [RowW-1:0]              height_o,
  output vista_stereo_pkg::front_end_t front_end_o,
  output vista_stereo_pkg::params_t    params_o,

  output vista_stereo_pkg::map_load_t map_o,
  output logic [ColW:0]               map_width_o,   // with `begin_load`
  output logic [RowW-1:0]             map_height_o,
  input  logic                        map_ready_i,

  input  logic                      lost_i,       // what is behind cannot go on, and is reset
  input  vista_stereo_pkg::events_t events_i,
  input  logic                      busy_i,       // a pixel of a frame that is to be taken waits
  input  logic                      stall_in_i,   // a pixel is offered and not taken
  input  logic                      word_i,       // a word is offered
  input  logic                      word_ready_i
);

  import vista_stereo_pkg::*;

  localparam int unsigned MaxRatio = 100;

  vista_stereo_csr_pkg::vista_stereo_csr__in_t  to_csr;
  vista_stereo_csr_pkg::vista_stereo_csr__out_t from_csr;

  logic request, request_write, read_error, write_error;
  logic [4:0] request_address;
  logic [31:0] write_data, write_mask, read_data;

  vista_axil #(
    .AddrW(5)
  ) u_axil (
    .clk_i,
    .rst_ni,
    .awvalid_i    (s_axil_awvalid),
    .awready_o    (s_axil_awready),
    .awaddr_i     (s_axil_awaddr[6:2]),
    .wvalid_i     (s_axil_wvalid),
    .wready_o     (s_axil_wready),
    .wdata_i      (s_axil_wdata),
    .wstrb_i      (s_axil_wstrb),
    .bvalid_o     (s_axil_bvalid),
    .bresp_o      (s_axil_bresp),
    .bready_i     (s_axil_bready),
    .arvalid_i    (s_axil_arvalid),
    .arready_o    (s_axil_arready),
    .araddr_i     (s_axil_araddr[6:2]),
    .rvalid_o     (s_axil_rvalid),
    .rready_i     (s_axil_rready),
    .rdata_o      (s_axil_rdata),
    .rresp_o      (s_axil_rresp),
    .request_o    (request),
    .write_o      (request_write),
    .address_o    (request_address),
    .write_data_o (write_data),
    .write_mask_o (write_mask),
    .read_data_i  (read_data),
    .error_i      (request_write ? write_error : read_error)
  );

  // Registers are words; protection is not told apart.
  logic unused_axil;
  assign unused_axil = ^{s_axil_awprot, s_axil_arprot, s_axil_awaddr[1:0], s_axil_araddr[1:0]};

  vista_stereo_csr u_csr (
    .clk                  (clk_i),
    .rst_n                (rst_ni),
    .s_cpuif_req          (request),
    .s_cpuif_req_is_wr    (request_write),
    .s_cpuif_addr         ({request_address, 2'b00}),
    .s_cpuif_wr_data      (write_data),
    .s_cpuif_wr_biten     (write_mask),
    .s_cpuif_req_stall_wr (),
    .s_cpuif_req_stall_rd (),
    .s_cpuif_rd_ack       (),
    .s_cpuif_rd_err       (read_error),
    .s_cpuif_rd_data      (read_data),
    .s_cpuif_wr_ack       (),
    .s_cpuif_wr_err       (write_error),
    .hwif_in              (to_csr),
    .hwif_out             (from_csr)
  );

  // Resets reach what is behind from a register, a clock late: what it did in the meantime is not counted.
  logic rst_nq;

  assign hard_rst_no = rst_ni & rst_nq;

  always_ff @(posedge clk_i) begin
    rst_nq <= rst_ni;
    rst_no <= rst_ni & ~from_csr.CONTROL.soft_reset.value & ~(lost_i & rst_no);
  end

  // A size beyond the counters is kept out of range rather than wrapped into it.
  logic [ColW:0]   width;
  logic [RowW-1:0] height;

  assign width  = (from_csr.SIZE.width.value > 16'(MaxWidth)) ? '0 : (ColW + 1)'(from_csr.SIZE.width.value);
  assign height = (from_csr.SIZE.height.value[15:RowW] != '0) ? '0 : RowW'(from_csr.SIZE.height.value);

  // The set of parameters in force. A frame has all of it or nothing (vista_frame_input).
  logic commit;

  assign commit = from_csr.COMMIT.commit.value | ~rst_nq;

  always_ff @(posedge clk_i) begin
    if (commit) begin
      width_o                    <= width;
      height_o                   <= height;
      front_end_o.rectify        <= from_csr.FRONT_END.rectify.value;
      front_end_o.levels         <= from_csr.FRONT_END.levels.value;
      front_end_o.smooth         <= from_csr.FRONT_END.smooth.value;
      params_o.xsobel            <= from_csr.PREFILTER.xsobel.value;
      params_o.cap               <= from_csr.PREFILTER.cap.value;
      params_o.texture_threshold <= from_csr.TEXTURE.threshold.value;
      params_o.uniqueness_ratio  <= (from_csr.UNIQUENESS.ratio.value > 7'(MaxRatio)) ? 7'(MaxRatio)
                                                                                     : from_csr.UNIQUENESS.ratio.value;
      params_o.lr_enable         <= from_csr.LR_CHECK.enable.value;
      params_o.lr_max_diff       <= from_csr.LR_CHECK.max_diff.value;
      params_o.confidence        <= from_csr.OUTPUT.confidence.value;
      params_o.narrow            <= from_csr.OUTPUT.narrow.value;
    end
    enable_o <= from_csr.CONTROL.enable.value;
    if (!rst_ni) enable_o <= 1'b0;
  end

  // The set outlives frames, so a bit of it that is upset stays until it is committed anew.
  logic set_upset;

  if (Parity) begin : gen_parity
    logic parity_q, commit_q;

    always_ff @(posedge clk_i) begin
      commit_q <= commit;
      if (commit_q) parity_q <= ^{width_o, height_o, front_end_o, params_o};
      set_upset <= ~commit & ~commit_q & (parity_q != ^{width_o, height_o, front_end_o, params_o});
    end
  end else begin : gen_no_parity
    assign set_upset = 1'b0;
  end

  // A map on its way in. A point is in its register a clock after it is written.
  logic point_q;

  always_ff @(posedge clk_i) point_q <= from_csr.MAP_POINT.dy.swmod & rst_ni;

  assign map_o.begin_load = from_csr.MAP.begin_load.value;
  assign map_o.write      = point_q;
  assign map_o.point      = {from_csr.MAP_POINT.dy.value, from_csr.MAP_POINT.dx.value};
  assign map_o.commit     = from_csr.COMMIT.map.value;
  assign map_width_o      = width;
  assign map_height_o     = height;

  logic stall_in_q, stall_out_q;

  always_ff @(posedge clk_i) begin
    stall_in_q  <= stall_in_i & rst_ni;
    stall_out_q <= word_i & ~word_ready_i & rst_ni;
  end

  assign to_csr.BUILD.num_disparities.next        = 9'(NumDisparities);
  assign to_csr.BUILD.block_size.next             = 5'(BlockSize);
  assign to_csr.BUILD.parity.next                 = Parity;
  assign to_csr.BUILD.confidence.next                 = Confidence;
  assign to_csr.OUTPUT.confidence.hwclr = ~Confidence;
  assign to_csr.BUILD_SIZE.max_width.next         = 16'(MaxWidth);
  assign to_csr.BUILD_SIZE.max_height.next        = 16'(RowW'('1));
  assign to_csr.BUILD_FRONT_END.rectify_rows.next = 8'(NumRows);
  assign to_csr.BUILD_FRONT_END.map_points.next   = 24'(MaxPoints);
  assign to_csr.MAP.ready.next                    = map_ready_i;
  assign to_csr.STALLS_IN.count.incr              = stall_in_q;
  assign to_csr.STALLS_OUT.count.incr             = stall_out_q;

  events_t event_now;
  logic error, upset;

  assign event_now = rst_no ? events_i : '0;
  assign upset     = event_now.upset | (rst_no & (lost_i | set_upset));
  assign error     = event_now.early_eol | event_now.late_eol | event_now.early_sof | event_now.late_sof |
      event_now.size | event_now.no_map | event_now.map_rows | event_now.map_size | upset;

  assign to_csr.FRAMES_IN.count.incr       = event_now.frame_start;
  assign to_csr.FRAMES_OUT.count.incr      = event_now.frame_end;
  assign to_csr.ERRORS.early_eol.hwset     = event_now.early_eol;
  assign to_csr.ERRORS.late_eol.hwset      = event_now.late_eol;
  assign to_csr.ERRORS.early_sof.hwset     = event_now.early_sof;
  assign to_csr.ERRORS.late_sof.hwset      = event_now.late_sof;
  assign to_csr.ERRORS.size.hwset          = event_now.size;
  assign to_csr.ERRORS.no_map.hwset        = event_now.no_map;
  assign to_csr.ERRORS.map_rows.hwset      = event_now.map_rows;
  assign to_csr.ERRORS.map_size.hwset      = event_now.map_size;
  assign to_csr.ERRORS.upset.hwset         = upset;
  assign to_csr.INTERRUPT.frame_done.hwset = event_now.frame_end;
  assign to_csr.INTERRUPT.error.hwset      = error;

  // Busy: from the clock in which a frame's first pixel is offered until its last word has been taken.
  localparam int unsigned InsideW = 5;

  logic [InsideW-1:0] inside_q;  // frames, and levels of them, that have words to come
  logic busy, idle, idle_q;

  assign busy = busy_i | (inside_q != '0) | event_now.frame_start | word_i;
  assign idle = ~busy & ~enable_o;

  always_ff @(posedge clk_i) begin
    inside_q <= inside_q + InsideW'(event_now.frame_start) + InsideW'(event_now.level_follows) -
        InsideW'(event_now.frame_end);
    idle_q   <= idle;
    if (!rst_no) inside_q <= '0;
    if (!rst_ni) idle_q <= 1'b1;
  end

  assign to_csr.STATUS.busy.next        = busy;
  assign to_csr.INTERRUPT.stopped.hwset = idle & ~idle_q;

  always_ff @(posedge clk_i) begin
    irq_o <= (from_csr.INTERRUPT.frame_done.value & from_csr.INTERRUPT_MASK.frame_done.value) |
        (from_csr.INTERRUPT.error.value & from_csr.INTERRUPT_MASK.error.value) |
        (from_csr.INTERRUPT.stopped.value & from_csr.INTERRUPT_MASK.stopped.value);
    if (!rst_ni) irq_o <= 1'b0;
  end

endmodule
