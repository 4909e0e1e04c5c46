// SPDX-License-Identifier: Apache-2.0
// The two formats of a word: disparity and cost in 32 bits, or disparities of 16 bits, two in a word.
//
//   wide    {Smin[15:0], disparity[15:0]} of one pixel
//   narrow  {disparity of pixel 2n + 1, disparity of pixel 2n}; in a row of odd width the last word holds one pixel, and
//           Invalid above it
//
// The format of a frame comes with its words and holds for all of them. So does what completes a word: any pixel of a wide
// one, the second of a narrow one, or the last of its row. Whether a pixel is taken depends on that and `ready_i` alone.
//
// Latency: none; the first pixel of a pair waits for the second one.

module vista_word_packer #(
  localparam int unsigned DisparityW = vista_stereo_pkg::DisparityW,
  localparam int unsigned SminW = vista_stereo_pkg::SminW
) (
  input  logic clk_i,
  input  logic rst_ni,

  input  logic                         valid_i,
  output logic                         ready_o,
  input  logic                         sof_i,
  input  logic                         eol_i,
  input  logic                         narrow_i,
  input  logic                         complete_i,
  input  logic signed [DisparityW-1:0] disparity_i,
  input  logic [SminW-1:0]             smin_i,

  output logic        valid_o,
  input  logic        ready_i,
  output logic        sof_o,
  output logic        eol_o,
  output logic [31:0] word_o
);

  import vista_stereo_pkg::*;

  logic held_q, held_sof_q;
  logic [15:0] disparity, held_disparity_q;

  assign disparity = 16'(disparity_i);
  assign ready_o   = ready_i | ~complete_i;

  assign valid_o = valid_i & complete_i;
  assign sof_o   = held_q ? held_sof_q : sof_i;
  assign eol_o   = eol_i;
  assign word_o  = ~narrow_i ? {smin_i, disparity}
                 : held_q    ? {disparity, held_disparity_q}
                             : {16'(Invalid), disparity};

  always_ff @(posedge clk_i) begin
    if (valid_i & ready_o) held_q <= ~complete_i;
    if (~held_q) begin
      held_sof_q       <= sof_i;
      held_disparity_q <= disparity;
    end
    if (!rst_ni) held_q <= 1'b0;
  end

`ifdef VISTA_ASSERT
  `include "vista_word_packer_properties.svh"
`endif

endmodule
