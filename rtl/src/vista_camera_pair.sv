// SPDX-License-Identifier: Apache-2.0
// Two sensors with parallel ports, each with a pixel clock of its own, become the raw pairs that the engine takes:
// vista_dvp and vista_camera_fifo for each, then vista_pair_sync. A FIFO has to hold what a camera sends while the other
// is late (`max_skew_i`), and while the engine waits.
//
// A sensor cannot wait: a pixel that finds no room is lost, and the next one carries a mark, which breaks its pair off.
// Resets: as of vista_camera_fifo.

module vista_camera_pair #(
  parameter int unsigned Depth = 512,  // of each FIFO, a power of two, 8 or more
  parameter int unsigned SkewW = 16,
  parameter bit Parity = 1'b0,
  localparam int unsigned PixelW = vista_stereo_pkg::PixelW
) (
  input  logic [1:0]             pixel_clk_i,  // left, right
  input  logic [1:0]             pixel_rst_ni,
  input  logic [1:0]             vsync_i,
  input  logic [1:0]             href_i,
  input  logic [1:0][PixelW-1:0] data_i,

  input  logic clk_i,
  input  logic rst_ni,
  input  logic [SkewW-1:0] max_skew_i,  // clocks that a pixel waits for its partner, at most

  output logic                m_axis_tvalid,
  input  logic                m_axis_tready,
  output logic [2*PixelW-1:0] m_axis_tdata,  // {right, left}
  output logic                m_axis_tuser,
  output logic                m_axis_tlast,

  // Events, one clock each; see vista_pair_sync.
  output logic       pair_o,
  output logic       broken_o,
  output logic [1:0] refused_o,
  output logic       upset_o  // of a FIFO's memory
);

  logic [1:0] valid, ready, sof, eol, gap, upset;
  logic [1:0][PixelW-1:0] data;

  for (genvar i = 0; i < 2; i++) begin : gen_camera
    logic pixel_valid, pixel_sof, pixel_eol, lost, gap_q;
    logic [PixelW-1:0] pixel;

    vista_dvp u_dvp (
      .pixel_clk_i  (pixel_clk_i[i]),
      .pixel_rst_ni (pixel_rst_ni[i]),
      .vsync_i      (vsync_i[i]),
      .href_i       (href_i[i]),
      .data_i       (data_i[i]),
      .valid_o      (pixel_valid),
      .sof_o        (pixel_sof),
      .eol_o        (pixel_eol),
      .data_o       (pixel)
    );

    vista_camera_fifo #(
      .Width  (PixelW + 3),
      .Depth  (Depth),
      .Parity (Parity)
    ) u_fifo (
      .pixel_clk_i  (pixel_clk_i[i]),
      .pixel_rst_ni (pixel_rst_ni[i]),
      .valid_i      (pixel_valid),
      .data_i       ({lost | gap_q, pixel_sof, pixel_eol, pixel}),
      .lost_o       (lost),
      .clk_i,
      .rst_ni,
      .valid_o      (valid[i]),
      .ready_i      (ready[i]),
      .data_o       ({gap[i], sof[i], eol[i], data[i]}),
      .upset_o      (upset[i])
    );

    // The FIFO tells of a lost pixel a clock later; the mark waits for the next pixel.
    always_ff @(posedge pixel_clk_i[i]) begin
      gap_q <= ~pixel_valid & (lost | gap_q);
      if (!pixel_rst_ni[i]) gap_q <= 1'b0;
    end
  end

  vista_pair_sync #(
    .SkewW(SkewW)
  ) u_sync (
    .clk_i,
    .rst_ni,
    .max_skew_i,
    .valid_i (valid),
    .ready_o (ready),
    .sof_i   (sof),
    .eol_i   (eol),
    .gap_i   (gap),
    .data_i  (data),
    .valid_o (m_axis_tvalid),
    .ready_i (m_axis_tready),
    .sof_o   (m_axis_tuser),
    .eol_o   (m_axis_tlast),
    .data_o  (m_axis_tdata),
    .pair_o,
    .broken_o,
    .refused_o
  );

  assign upset_o = |upset;

endmodule
