// SPDX-License-Identifier: Apache-2.0
// A sensor with a parallel port (DVP): VSYNC, HREF and 8 bits a pixel clock become pixels with start of frame and end of
// line, in the pixel clock.
//
// The first pixel after a pulse of VSYNC starts a frame; a line ends when HREF falls, so each pixel waits for the next
// clock. Pixels before the first pulse start no frame and are dropped by whoever follows.
//
// Latency: 2 clocks.

module vista_dvp #(
  localparam int unsigned PixelW = vista_stereo_pkg::PixelW
) (
  input  logic pixel_clk_i,
  input  logic pixel_rst_ni,

  input  logic              vsync_i,  // 1 between frames
  input  logic              href_i,   // 1 while pixels come
  input  logic [PixelW-1:0] data_i,

  output logic              valid_o,
  output logic              sof_o,
  output logic              eol_o,
  output logic [PixelW-1:0] data_o
);

  logic begins_q, held_q, held_sof_q;
  logic [PixelW-1:0] held_data_q;

  always_ff @(posedge pixel_clk_i) begin
    begins_q <= vsync_i | (begins_q & ~href_i);
    held_q   <= href_i;
    if (href_i) begin
      held_sof_q  <= begins_q;
      held_data_q <= data_i;
    end
    valid_o <= held_q;
    sof_o   <= held_sof_q;
    eol_o   <= ~href_i;
    data_o  <= held_data_q;
    if (!pixel_rst_ni) begin
      begins_q <= 1'b0;
      held_q   <= 1'b0;
      valid_o  <= 1'b0;
    end
  end

endmodule
