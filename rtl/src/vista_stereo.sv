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
  localparam int unsigned MaxRatio = 100;

  vista_stereo_csr_pkg::vista_stereo_csr__in_t  to_csr;
  vista_stereo_csr_pkg::vista_stereo_csr__out_t from_csr;

  logic request, request_write;
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
    .bready_i     (s_axil_bready),
    .arvalid_i    (s_axil_arvalid),
    .arready_o    (s_axil_arready),
    .araddr_i     (s_axil_araddr[6:2]),
    .rvalid_o     (s_axil_rvalid),
    .rready_i     (s_axil_rready),
    .rdata_o      (s_axil_rdata),
    .request_o    (request),
    .write_o      (request_write),
    .address_o    (request_address),
    .write_data_o (write_data),
    .write_mask_o (write_mask),
    .read_data_i  (read_data)
  );

  assign s_axil_bresp = '0;
  assign s_axil_rresp = '0;

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
    .s_cpuif_rd_err       (),
    .s_cpuif_rd_data      (read_data),
    .s_cpuif_wr_ack       (),
    .s_cpuif_wr_err       (),
    .hwif_in              (to_csr),
    .hwif_out             (from_csr)
  );

  // Resets reach the core from a register, a clock late: what it did in the meantime is not counted.
  logic rst_nq, core_rst_nq;

  always_ff @(posedge clk_i) begin
    rst_nq      <= rst_ni;
    core_rst_nq <= rst_ni & ~from_csr.CONTROL.soft_reset.value;
  end

  // The set of parameters in force. The size goes first, for the framer looks at it a clock before the frame; a frame that
  // begins then sees all of the set or nothing. A size beyond the counters is kept out of range rather than wrapped into
  // it.
  logic commit, commit_q, enable1_q, enable_q;
  logic [ColW:0]      width_q;
  logic [HeightW-1:0] height_q;
  params_t            params_q;

  assign commit = from_csr.COMMIT.commit.value | ~rst_nq;

  always_ff @(posedge clk_i) begin
    commit_q <= commit;
    if (commit) begin
      width_q  <= (from_csr.SIZE.width.value > 16'(MaxWidth)) ? '0 : (ColW + 1)'(from_csr.SIZE.width.value);
      height_q <= (from_csr.SIZE.height.value[15:HeightW] != '0) ? '0 : HeightW'(from_csr.SIZE.height.value);
    end
    if (commit_q) begin
      params_q.xsobel            <= from_csr.PREFILTER.xsobel.value;
      params_q.cap               <= from_csr.PREFILTER.cap.value;
      params_q.texture_threshold <= from_csr.TEXTURE.threshold.value;
      params_q.uniqueness_ratio  <= (from_csr.UNIQUENESS.ratio.value > 7'(MaxRatio)) ? 7'(MaxRatio)
                                                                                     : from_csr.UNIQUENESS.ratio.value;
      params_q.lr_enable         <= from_csr.LR_CHECK.enable.value;
      params_q.lr_max_diff       <= from_csr.LR_CHECK.max_diff.value;
      params_q.narrow            <= from_csr.OUTPUT.narrow.value;
    end
    enable1_q <= from_csr.CONTROL.enable.value;
    enable_q  <= enable1_q;
    if (!rst_ni) begin
      enable1_q <= 1'b0;
      enable_q  <= 1'b0;
    end
  end

  logic stall_in_q, stall_out_q;

  always_ff @(posedge clk_i) begin
    stall_in_q  <= s_axis_tvalid & ~s_axis_tready & rst_ni;
    stall_out_q <= m_axis_tvalid & ~m_axis_tready & rst_ni;
  end

  assign to_csr.BUILD.num_disparities.next = 9'(NumDisparities);
  assign to_csr.BUILD.block_size.next      = 5'(BlockSize);
  assign to_csr.BUILD_SIZE.max_width.next  = 16'(MaxWidth);
  assign to_csr.BUILD_SIZE.max_height.next = 16'(HeightW'('1));
  assign to_csr.STALLS_IN.count.incr       = stall_in_q;
  assign to_csr.STALLS_OUT.count.incr      = stall_out_q;

  logic frame_start, frame_end, error_early_eol, error_late_eol, error_early_sof, error_late_sof, error_size;

  assign to_csr.FRAMES_IN.count.incr          = frame_start & core_rst_nq;
  assign to_csr.FRAMES_OUT.count.incr         = frame_end & core_rst_nq;
  assign to_csr.ERRORS.early_eol.hwset        = error_early_eol & core_rst_nq;
  assign to_csr.ERRORS.late_eol.hwset         = error_late_eol & core_rst_nq;
  assign to_csr.ERRORS.early_sof.hwset        = error_early_sof & core_rst_nq;
  assign to_csr.ERRORS.late_sof.hwset         = error_late_sof & core_rst_nq;
  assign to_csr.ERRORS.size.hwset             = error_size & core_rst_nq;
  assign to_csr.INTERRUPT.frame_done.hwset    = frame_end & core_rst_nq;
  assign to_csr.INTERRUPT.error.hwset         = core_rst_nq &
      (error_early_eol | error_late_eol | error_early_sof | error_late_sof | error_size);

  always_ff @(posedge clk_i) begin
    irq_o <= (from_csr.INTERRUPT.frame_done.value & from_csr.INTERRUPT_MASK.frame_done.value) |
        (from_csr.INTERRUPT.error.value & from_csr.INTERRUPT_MASK.error.value);
    if (!rst_ni) irq_o <= 1'b0;
  end

  vista_stereo_core #(
    .NumDisparities (NumDisparities),
    .BlockSize (BlockSize),
    .MaxWidth (MaxWidth)
  ) u_core (
    .clk_i,
    .rst_ni            (core_rst_nq),
    .enable_i          (enable_q),
    .width_i           (width_q),
    .height_i          (height_q),
    .params_i          (params_q),
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
    .frame_start_o     (frame_start),
    .frame_end_o       (frame_end),
    .error_early_eol_o (error_early_eol),
    .error_late_eol_o  (error_late_eol),
    .error_early_sof_o (error_early_sof),
    .error_late_sof_o  (error_late_sof),
    .error_size_o      (error_size)
  );

endmodule
